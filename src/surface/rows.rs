//! Rows between a slave node and what it has met, over nodes of surfaces and directions.
//!
//! With w = x - y between the slave and its master, and directions d that turn with one of their faces, the rows are the gradients of the
//! openings `d.w` at fixed material points:
//!
//! ```text
//! g = n.w      b = -dg/du      s = t.w      T = ds/du
//! ```
//!
//! They are 0 for each motion that slave and master share, whatever the gap: dw turns with the motion, and so do n and t.

use crate::numbers::surface::ALONG;
use crate::surface::faces::Faces;
use crate::surface::find::Partner;
use crate::surface::foot::Placed;
use crate::surface::frame::Frame;
use crate::surface::rigid::Rigid;
use crate::surface::shape::Shape;
use crate::surface::vector::{
    across, any_across, cross, dot, length, minus, plus, times, unit, Vector, E_Z, ZERO,
};

/// A node of a surface with the gradients of the three openings there, no unit.
pub type Entry = (u32, [Vector; 3]);

/// The openings of a slave node along two tangents and the master's outward normal, and their gradients.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rows {
    /// Two tangents and the normal; by mortar their means over the faces of the node. In the plane the second tangent does not count.
    pub directions: [Vector; 3],
    /// `d.w`, length: now, and at the beginning of the step. Of the normal it is the gap.
    pub opening: [f64; 3],
    pub before: [f64; 3],
    pub slave: Vec<Entry>,
    pub master: Vec<Entry>,
    /// Between the direction of the contact and the master's normal, radian.
    pub angle: f64,
}

/// The positions of both surfaces at two times.
#[derive(Clone, Copy)]
pub struct Slave<'a> {
    pub faces: &'a Faces,
    /// Positions now, and at the beginning of the step.
    pub x: &'a [Vector],
    pub begin: &'a [Vector],
}

/// The master of the rows, now and at the beginning of the step; a rigid one also as it was when its points were found.
#[derive(Clone, Copy)]
pub enum Opposite<'a> {
    Faces(Placed<'a>, &'a [Vector]),
    Rigid { found: &'a Rigid, now: &'a Rigid, begin: &'a Rigid },
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

    /// The gradients of `d.w` at the nodes of the master, d carried by it; `turns`: w has a part across d.
    fn gradients(&self, d: [Vector; 3], w: Vector, turns: [bool; 3]) -> Vec<Entry> {
        let Self::Face(frame, nodes) = self else { return Vec::new() };
        let turning = d.map(|d| frame.turning(d, w));
        let at = |k: usize| {
            let of = |i: usize| {
                plus(times(-frame.functions.n[k], d[i]), if turns[i] { 1.0 } else { 0.0 }, turning[i](k))
            };
            std::array::from_fn(of)
        };
        nodes.iter().enumerate().map(|(k, node)| (*node, at(k))).collect()
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
            (Self::Rigid { found, now, begin }, Partner::Rigid(foot)) => {
                let e_1 = any_across(foot.normal);
                let e = [e_1, cross(foot.normal, e_1), foot.normal];
                Some(
                    [now, begin].map(|at| {
                        Point::Rigid(found.point_at(at, foot.y), e.map(|e| found.direction_at(at, e)))
                    }),
                )
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
    let directions = [tangents[0][0], tangents[0][1], normal];
    Some(Rows {
        directions,
        opening: [dot(directions[0], from), dot(directions[1], from), gap],
        before: [dot(tangents[1][0], before), dot(tangents[1][1], before), dot(normal_before, before)],
        slave: vec![(node, directions)],
        master: now.gradients(directions, w, [true, true, partner.is_askew()]),
        angle: 0.0,
    })
}

/// The rows of a tie, along the vectors of the master's frame at the foot.
pub fn tie(slave: &Slave, master: &Opposite, node: u32, partner: &Partner) -> Option<Rows> {
    let [now, begin] = master.points(partner)?;
    let w = minus(slave.x[node as usize], now.y());
    let before = minus(slave.begin[node as usize], begin.y());
    let (directions, of_begin) = (now.vectors(), begin.vectors());
    Some(Rows {
        directions,
        opening: directions.map(|e| dot(e, w)),
        before: of_begin.map(|e| dot(e, before)),
        slave: vec![(node, directions)],
        master: now.gradients(directions, w, [true; 3]),
        angle: 0.0,
    })
}

/// t_1 along e across the master's normal n, and t_2 = (-n) x t_1.
pub fn across_from(e: Vector, n: Vector) -> [Vector; 2] {
    let t = unit(across(e, n)).unwrap_or_else(|| any_across(n));
    [t, cross(t, n)]
}

impl Slave<'_> {
    /// The node to which an edge of the first face leads that is not along n; none for nodes in no face.
    pub fn edge_across(&self, node: u32, n: Vector) -> Option<u32> {
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
