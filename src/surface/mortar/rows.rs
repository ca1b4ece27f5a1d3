//! The openings of a slave node by mortar and their gradients, from the pieces of its sub-faces.
//!
//! Of a piece the directions are t_1 (along an edge E of the node, put into the plane of the sub-face), t_2 = n0 x t_1 and -n0. With n0 along
//! p x q, p and q the diagonals of the sub-face,
//!
//! ```text
//! d(e.w) = e.dw + de.w     dw_j = sum_k D_jk u_k - sum_l M_jl u_l
//! dt_1.w = a t_2.w - (t_1.dn0) n0.w     dt_2.w = -a t_1.w - (t_2.dn0) n0.w     dn0.w = (t_1.dn0) t_1.w + (t_2.dn0) t_2.w
//! a = (t_2.dE - (n0.E) t_2.dn0) / |t_1.E|     v.dn0 = ((q x v).dp + (v x p).dq) / |p x q|
//! ```
//!
//! At the find w_j is parallel to n0, and only the term of n0.w remains.

use crate::linalg::vector::NOISE;
use crate::surface::mortar::find::Mortar;
use crate::surface::mortar::piece::Piece;
use crate::surface::mortar::plane::diagonals;
use crate::surface::rows::{across_from, Entry, Opposite, Rows, Slave};
use crate::surface::vector::{cross, dot, length, minus, plus, times, unit, Vector, E_Z, ZERO};

/// The directions of a corner of a piece at some positions.
struct Directions {
    /// t_1, t_2, -n0; the master's normal of a rigid one in place of -n0.
    e: [Vector; 3],
    edge: Vector,
    /// p and q over |p x q|; none where the normal is that of a rigid master.
    diagonals: Option<[Vector; 2]>,
}

impl Directions {
    fn new(normal: Vector, edge: Vector, diagonals: Option<[Vector; 2]>, dim: usize) -> Self {
        let edge = if dim == 2 { cross(normal, E_Z) } else { edge };
        let [t, second] = across_from(edge, normal);
        Self { e: [t, second, normal], edge, diagonals }
    }

    /// Of each direction what `de.w` has at the corners of the sub-face and at the end of the edge, and less at the node.
    fn turning(&self, w: Vector) -> [([Vector; 4], Vector); 3] {
        let [t, second, n] = self.e;
        // at the find w is parallel to n, but for rounding
        let rounding = NOISE * length(w);
        let [along, across, up] = self.e.map(|e| dot(e, w)).map(|v| if v.abs() > rounding { v } else { 0.0 });
        let stretch = dot(t, self.edge);
        let per_stretch = if stretch > 0.0 { stretch.recip() } else { 0.0 };
        // -n is n0
        let spin = dot(n, self.edge) * per_stretch;
        let of = |v: Vector, edge: f64| (self.of_normal(v), times(edge * per_stretch, second));
        [
            of(plus(times(up, t), spin * across, second), across),
            of(plus(times(up, second), -spin * along, second), -along),
            of(plus(times(-along, t), -across, second), 0.0),
        ]
    }

    /// `v.dn0` by the corners of the sub-face.
    fn of_normal(&self, v: Vector) -> [Vector; 4] {
        let Some([p, q]) = self.diagonals else { return [ZERO; 4] };
        let (of_p, of_q) = (cross(q, v), cross(v, p));
        [times(-1.0, of_p), times(-1.0, of_q), of_p, of_q]
    }
}

impl Piece {
    /// Directions of corner c at positions x of the slave.
    fn directions(&self, c: usize, slave: &Slave, x: &[Vector], normal: Option<Vector>) -> Directions {
        let (nodes, dim) = (slave.faces.nodes_of(self.face as usize), slave.faces.dim);
        let node = nodes[self.corners[c] as usize];
        let edge = minus(x[self.along[c] as usize], x[node as usize]);
        if let Some(normal) = normal {
            return Directions::new(normal, edge, None, dim);
        }
        let [p, q] = diagonals(self.corners.map(|k| x[nodes[k as usize] as usize]), dim);
        let normal = cross(p, q);
        let per_area = length(normal).recip();
        let of_plane = [p, q].map(|d| times(per_area, d));
        let n0 = unit(normal).unwrap_or(E_Z);
        Directions::new(times(-1.0, n0), edge, Some(of_plane), dim)
    }

    /// w_j of corner c for positions x and y of slave and master, y of a rigid one in one point; from the node of the corner, where numbers
    /// are small.
    fn between(&self, c: usize, slave: &Slave, x: &[Vector], y: &[Vector]) -> Vector {
        let nodes = slave.faces.nodes_of(self.face as usize);
        let o = x[nodes[self.corners[c] as usize] as usize];
        let own = nodes.iter().zip(self.slave[c]);
        let sum = own.fold(ZERO, |sum, (node, d)| plus(sum, d, minus(x[*node as usize], o)));
        if self.rigid.is_some() {
            return plus(sum, -self.area[c], minus(y[0], o));
        }
        self.master.iter().fold(sum, |sum, (node, m)| plus(sum, -m[c], minus(y[*node as usize], o)))
    }
}

impl Mortar {
    /// The rows of a slave node; none where nothing covers it.
    pub fn rows(&self, slave: &Slave, master: &Opposite, node: u32) -> Option<Rows> {
        let area = self.area(node);
        if !(area > 0.0) {
            return None;
        }
        let mut rows = Rows::default();
        for (piece, c) in self.of(node) {
            piece.add_to(&mut rows, c, (slave, master), node, area.recip())?;
        }
        rows.slave = merged(rows.slave);
        rows.master = merged(rows.master);
        Some(rows)
    }
}

impl Piece {
    fn add_to(
        &self,
        rows: &mut Rows,
        c: usize,
        (slave, master): (&Slave, &Opposite),
        node: u32,
        per_area: f64,
    ) -> Option<()> {
        let nodes = slave.faces.nodes_of(self.face as usize);
        let (here, w, before, w_before) = match (master, self.rigid) {
            (Opposite::Faces(placed, begin), None) => (
                self.directions(c, slave, slave.x, None),
                self.between(c, slave, slave.x, placed.x),
                self.directions(c, slave, slave.begin, None),
                self.between(c, slave, slave.begin, begin),
            ),
            (Opposite::Rigid { found, now, begin }, Some(foot)) => (
                self.directions(c, slave, slave.x, Some(found.direction_at(now, foot.normal))),
                self.between(c, slave, slave.x, &[found.point_at(now, foot.y)]),
                self.directions(c, slave, slave.begin, Some(found.direction_at(begin, foot.normal))),
                self.between(c, slave, slave.begin, &[found.point_at(begin, foot.y)]),
            ),
            _ => return None,
        };
        for i in 0..3 {
            rows.directions[i] = plus(rows.directions[i], per_area * self.area[c], here.e[i]);
            rows.opening[i] += per_area * dot(here.e[i], w);
            rows.before[i] += per_area * dot(before.e[i], w_before);
        }
        rows.angle = rows.angle.max(self.angle);
        let entry = |node: u32, weight: f64| (node, here.e.map(|e| times(weight * per_area, e)));
        rows.slave.extend(nodes.iter().zip(self.slave[c]).map(|(node, d)| entry(*node, d)));
        rows.master.extend(self.master.iter().map(|(node, m)| entry(*node, -m[c])));
        // a gap of 0 is rounding: it would leave entries at all corners
        let edge = length(minus(slave.x[self.along[c] as usize], slave.x[node as usize]));
        let is_open = length(w) > NOISE * edge * self.area[c].abs();
        let turning = here.turning(if is_open { times(per_area, w) } else { ZERO });
        for (k, corner) in self.corners.iter().enumerate() {
            rows.slave.push((nodes[*corner as usize], turning.map(|(of, _)| of[k])));
        }
        rows.slave.push((self.along[c], turning.map(|(_, of)| of)));
        rows.slave.push((node, turning.map(|(_, of)| times(-1.0, of))));
        Some(())
    }
}

/// One entry of each node, ascending.
fn merged(mut entries: Vec<Entry>) -> Vec<Entry> {
    entries.sort_by_key(|(node, _)| *node);
    let sum = |same: &[Entry]| {
        let add = |sum: [Vector; 3], of: &Entry| std::array::from_fn(|i| plus(sum[i], 1.0, of.1[i]));
        let sum = same.iter().fold([ZERO; 3], add);
        (sum != [ZERO; 3]).then_some((same[0].0, sum))
    };
    entries.chunk_by(|a, b| a.0 == b.0).filter_map(sum).collect()
}
