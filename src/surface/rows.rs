//! Rows between a slave node and its partner, over nodes of surfaces and directions.
//!
//! With w = x - y, y the foot, and directions n, t that turn with the master's face, the rows are the gradients of
//!
//! ```text
//! g = n.w      b = -dg/du      s = t.w      T = ds/du
//! ```
//!
//! at fixed material points. Both are 0 for each motion that slave and master share, whatever the gap: dw turns with the motion, and so do
//! n and t.

use crate::numbers::surface::ALONG;
use crate::surface::faces::Faces;
use crate::surface::find::Partner;
use crate::surface::foot::Placed;
use crate::surface::frame::Frame;
use crate::surface::rigid::Rigid;
use crate::surface::shape::{Shape, MOST};
use crate::surface::vector::{
    across, any_across, cross, dot, length, minus, plus, times, unit, Vector, E_Z, ZERO,
};

/// A row: its vector at the slave node and at nodes of the master; no unit.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    pub slave: Vector,
    nodes: [u32; MOST],
    values: [Vector; MOST],
    count: usize,
}

/// All rows of a slave node.
#[derive(Debug, Clone, Copy)]
pub struct Rows {
    /// From slave to master: the outward normal of the slave.
    pub normal: Vector,
    pub tangents: [Vector; 2],
    /// g, length
    pub gap: f64,
    /// `b u <= g`
    pub contact: Row,
    /// T: one row in the plane, two in space.
    pub tangential: [Row; 2],
    /// `s(x_begin) - s(x)`, length: the slip of the step is `T u - s_old`.
    pub s_old: [f64; 2],
}

/// The positions of both surfaces at two times.
#[derive(Clone, Copy)]
pub struct Slave<'a> {
    pub faces: &'a Faces,
    /// Positions now, and at the beginning of the step.
    pub x: &'a [Vector],
    pub begin: &'a [Vector],
}

/// The master of the rows, now and at the beginning of the step.
#[derive(Clone, Copy)]
pub enum Opposite<'a> {
    Faces(Placed<'a>, &'a [Vector]),
    Rigid(&'a Rigid, &'a Rigid),
}

impl Row {
    fn of(slave: Vector, nodes: &[u32], value: impl Fn(usize) -> Vector) -> Self {
        let mut row = Self { slave, nodes: [0; MOST], values: [ZERO; MOST], count: nodes.len() };
        for (k, node) in nodes.iter().enumerate() {
            (row.nodes[k], row.values[k]) = (*node, value(k));
        }
        row
    }

    /// Nodes of the master and their vectors.
    pub fn master(&self) -> impl Iterator<Item = (u32, Vector)> + '_ {
        self.nodes.iter().copied().zip(self.values).take(self.count)
    }
}

/// A material point of the master: where it is, and a frame that turns with it.
enum Point<'a> {
    Face(Box<Frame>, &'a [u32]),
    Rigid(Vector, [Vector; 3]),
}

impl Point<'_> {
    fn y(&self) -> Vector {
        match self {
            Self::Face(frame, _) => frame.y,
            Self::Rigid(y, _) => *y,
        }
    }

    fn vectors(&self) -> [Vector; 3] {
        match self {
            Self::Face(frame, _) => frame.vectors(),
            Self::Rigid(_, e) => *e,
        }
    }

    /// A direction here, carried to where the other point is.
    fn carried(&self, d: Vector, there: &Self) -> Vector {
        let (here, there) = (self.vectors(), there.vectors());
        (0..3).fold(ZERO, |sum, i| plus(sum, dot(here[i], d), there[i]))
    }

    /// The gradient of `d.w`, d carried by the master; `turns`: w has a part across d.
    fn row(&self, d: Vector, w: Vector, turns: bool) -> Row {
        match self {
            Self::Rigid(..) => Row::of(d, &[], |_| ZERO),
            Self::Face(frame, nodes) => {
                let turning = frame.turning(d, w);
                Row::of(d, nodes, |k| {
                    plus(times(-frame.functions.n[k], d), if turns { 1.0 } else { 0.0 }, turning(k))
                })
            }
        }
    }
}

impl Opposite<'_> {
    /// The material point of a partner now and at the beginning of the step.
    fn points(&self, partner: &Partner) -> Option<[Point<'_>; 2]> {
        match (self, partner) {
            (Self::Faces(placed, begin), Partner::Face(foot)) => {
                let nodes = placed.faces.nodes_of(foot.face);
                let at = |x: &[Vector]| {
                    Point::Face(Box::new(Frame::at(&placed.faces.patch(foot.face, x), foot.r)), nodes)
                };
                Some([at(placed.x), at(begin)])
            }
            (Self::Rigid(now, begin), Partner::Rigid(foot)) => {
                let e_1 = any_across(foot.normal);
                let e = [e_1, cross(foot.normal, e_1), foot.normal];
                let before = e.map(|e| now.direction_at(begin, e));
                Some([Point::Rigid(foot.y, e), Point::Rigid(now.point_at(begin, foot.y), before)])
            }
            _ => None,
        }
    }
}

/// The rows of a slave node and its partner; none if the master is of another kind.
pub fn rows(slave: &Slave, master: &Opposite, node: u32, partner: &Partner) -> Option<Rows> {
    let [now, begin] = master.points(partner)?;
    let (normal, gap) = (partner.normal(), partner.gap());
    let from = minus(slave.x[node as usize], now.y());
    let before = minus(slave.begin[node as usize], begin.y());
    let w = if partner.is_askew() { from } else { times(gap, normal) };
    let normal_before = now.carried(normal, &begin);
    let tangents = match slave.edge_across(node, normal) {
        _ if slave.faces.dim == 2 => [normal, normal_before].map(|n| [cross(n, E_Z), ZERO]),
        Some(to) => {
            let along = |x: &[Vector]| minus(x[to as usize], x[node as usize]);
            [(slave.x, normal), (slave.begin, normal_before)].map(|(x, n)| across_from(along(x), n))
        }
        None => {
            let [e_1, e_2, _] = now.vectors();
            let e = if length(across(e_1, normal)) > ALONG { e_1 } else { e_2 };
            let here = across_from(e, normal);
            [here, here.map(|t| now.carried(t, &begin))]
        }
    };
    let contact = negative(now.row(normal, w, partner.is_askew()));
    let tangential = tangents[0].map(|t| now.row(t, w, true));
    let s_old = [0, 1].map(|a| dot(tangents[1][a], before) - dot(tangents[0][a], from));
    Some(Rows { normal: times(-1.0, normal), tangents: tangents[0], gap, contact, tangential, s_old })
}

fn negative(row: Row) -> Row {
    Row { slave: times(-1.0, row.slave), values: row.values.map(|v| times(-1.0, v)), ..row }
}

/// t_1 along e across the master's normal n, and t_2 = (-n) x t_1.
fn across_from(e: Vector, n: Vector) -> [Vector; 2] {
    let t = unit(across(e, n)).unwrap_or_else(|| any_across(n));
    [t, cross(t, n)]
}

impl Slave<'_> {
    /// The node to which an edge of the first face leads that is not along n; none for nodes in no face.
    fn edge_across(&self, node: u32, n: Vector) -> Option<u32> {
        let (face, k) = self.faces.first_face(node)?;
        let nodes = self.faces.nodes_of(face);
        let [to, other] = neighbours(self.faces.shape(face), k).map(|k| nodes[k]);
        let along = minus(self.x[to as usize], self.x[node as usize]);
        Some(if length(across(along, n)) > ALONG * length(along) { to } else { other })
    }
}

/// The corner after node k of a face, and another corner that is not in line with both.
fn neighbours(shape: Shape, k: usize) -> [usize; 2] {
    let corners = shape.corners().len();
    match k.checked_sub(corners) {
        None => [(k + 1) % corners, (k + corners - 1) % corners],
        Some(edge) => [(edge + 1) % corners, (edge + 2) % corners],
    }
}

/// The rows of a tie, along the vectors of the master's frame at the foot, and the components of w there. A rigid master is given as it was
/// when the foot was found, and as it is now.
pub fn tie(slave: &Slave, master: &Opposite, node: u32, partner: &Partner) -> Option<([Row; 3], [f64; 3])> {
    let [now, moved] = master.points(partner)?;
    let point = if matches!(master, Opposite::Rigid(..)) { moved } else { now };
    let w = minus(slave.x[node as usize], point.y());
    let e = point.vectors();
    Some((e.map(|e| point.row(e, w, true)), e.map(|e| dot(e, w))))
}
