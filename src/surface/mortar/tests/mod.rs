//! Rows by mortar between surfaces that do not match.

mod motions;
mod nearest;
mod rigid;
mod slips;
mod sums;

use crate::linalg::random::scattered;
use crate::surface::mortar::Mortar;
use crate::surface::tests::{mesh, rule, Mesh};
use crate::surface::vector::{plus, times, Vector, ZERO};
use crate::surface::{Depth, Master, Meeting, Opposite, Placed, Rows, Shape, Slave, Tree};

pub const PLANE: [Shape; 2] = [Shape::Line2, Shape::Line3];
pub const SPACE: [Shape; 5] = [Shape::Tri3, Shape::Tri6, Shape::Quad4, Shape::Quad8, Shape::Quad9];
pub const DEPTH: Depth = Depth { thickness: 1.0, axisymmetric: false };

/// All pairs of shapes of slave and master.
pub fn pairs() -> impl Iterator<Item = (Shape, Shape)> {
    let of = |shapes: &'static [Shape]| shapes.iter().flat_map(move |a| shapes.iter().map(move |b| (*a, *b)));
    of(&PLANE).chain(of(&SPACE))
}

/// A grid of n cells in each direction over [low, high]^2 (or [low, high]) at height 0, outward upwards or downwards.
pub fn grid(shape: Shape, n: usize, [low, high]: [f64; 2], up: bool) -> Mesh {
    let at = |u: f64| low + (high - low) * u;
    let map = |u: f64, v: f64| match (shape.dim(), up) {
        (2, true) => [at(1.0 - u), 0.0, 0.0],
        (2, false) => [at(u), 0.0, 0.0],
        (_, true) => [at(u), at(v), 0.0],
        (_, false) => [at(v), at(u), 0.0],
    };
    mesh(shape, &[(n, n, &map)])
}

/// Its inner corners moved in the plane at random by the part `by` of a cell of this size; edges stay straight.
pub fn distorted(mut of: Mesh, by: f64, cell: f64) -> Mesh {
    let random = scattered(2 * of.x.len());
    let flat = of.faces.dim == 2;
    let mut is_corner = vec![false; of.x.len()];
    for face in 0..of.faces.len() {
        let corners = of.faces.shape(face).corners().len();
        of.faces.nodes_of(face)[..corners].iter().for_each(|node| is_corner[*node as usize] = true);
    }
    for (k, w) in random.chunks(2).enumerate() {
        if is_corner[k] && !of.faces.is_on_rim(k as u32) {
            // numbers are 1/2 to 3/2 in size
            of.x[k] = plus(of.x[k], by * cell / 1.5, [w[0], if flat { 0.0 } else { w[1] }, 0.0]);
        }
    }
    straighten(&mut of);
    of
}

/// Mid nodes in the middle of their edges.
pub fn straighten(of: &mut Mesh) {
    for face in 0..of.faces.len() {
        let (shape, nodes) = (of.faces.shape(face), of.faces.nodes_of(face).to_vec());
        let corners = shape.corners().len();
        let mean = |of: &[u32], x: &[Vector]| {
            of.iter().fold(ZERO, |sum, node| plus(sum, 1.0 / of.len() as f64, x[*node as usize]))
        };
        for (k, node) in nodes.iter().enumerate().skip(corners) {
            let ends = [nodes[k - corners], nodes[(k + 1 - corners) % corners]];
            let of_corners = shape == Shape::Line3 || k == 2 * corners;
            of.x[*node as usize] = mean(if of_corners { &nodes[..corners] } else { &ends }, &of.x);
        }
    }
}

pub fn raised(mut of: Mesh, by: f64) -> Mesh {
    let up = of.faces.dim - 1;
    of.x.iter_mut().for_each(|x| x[up] += by);
    of
}

/// Two surfaces, where they were at the beginning of the step, and what the slave has met.
pub struct Case {
    pub slave: Mesh,
    pub master: Mesh,
    pub begin: [Vec<Vector>; 2],
    normals: Vec<Vector>,
    pub meeting: Meeting,
}

impl Case {
    pub fn new(slave: Mesh, master: Mesh, distance: f64) -> Self {
        Self::by(1, slave, master, distance)
    }

    pub fn by(threads: usize, slave: Mesh, master: Mesh, distance: f64) -> Self {
        let normals = master.faces.normals(&master.x).unwrap();
        let placed = Placed { faces: &master.faces, x: &master.x, normals: &normals };
        let of = Slave { faces: &slave.faces, x: &slave.x, begin: &slave.x };
        let tree = Tree::new(&master.faces, &master.x).unwrap();
        let found = Mortar::find(threads, &of, &Master::Faces(placed, tree), &rule(distance), DEPTH).unwrap();
        let begin = [slave.x.clone(), master.x.clone()];
        Self { slave, master, begin, normals, meeting: Meeting::Mortar(found) }
    }

    pub fn mortar(&self) -> &Mortar {
        match &self.meeting {
            Meeting::Mortar(mortar) => mortar,
            Meeting::Feet(_) => panic!("node-to-face"),
        }
    }

    /// Of all nodes that have met the master, with their points as they were found and both surfaces where they are.
    pub fn rows(&self) -> Vec<(u32, Rows)> {
        let placed = Placed { faces: &self.master.faces, x: &self.master.x, normals: &self.normals };
        let (slave, opposite) = (
            Slave { faces: &self.slave.faces, x: &self.slave.x, begin: &self.begin[0] },
            Opposite::Faces(placed, &self.begin[1]),
        );
        let of = |node| Some((node, self.meeting.rows(&slave, &opposite, 0, node)?));
        self.slave.faces.used().filter_map(of).collect()
    }

    /// `sum_j A_j row_j` of the gap at the nodes of both sides.
    pub fn column_sums(&self) -> [Vec<Vector>; 2] {
        let mut sums = [vec![ZERO; self.slave.x.len()], vec![ZERO; self.master.x.len()]];
        for (node, rows) in self.rows() {
            let area = self.mortar().area(node);
            for (sum, entries) in sums.iter_mut().zip([&rows.slave, &rows.master]) {
                entries.iter().for_each(|(k, of)| sum[*k as usize] = plus(sum[*k as usize], area, of[2]));
            }
        }
        sums
    }
}

/// Both surfaces moved by `by` times random motions of their nodes.
pub fn wiggled(case: &Case, by: f64) -> [Vec<Vector>; 2] {
    let flat = case.slave.faces.dim == 2;
    let random = scattered(3 * (case.slave.x.len() + case.master.x.len()));
    let way: Vec<Vector> = random.chunks(3).map(|w| [w[0], w[1], if flat { 0.0 } else { w[2] }]).collect();
    let (of_slave, of_master) = way.split_at(case.slave.x.len());
    [of_slave, of_master].map(|way| way.iter().map(|w| times(by, *w)).collect())
}
