//! Shapes of faces: their nodes in the order of VTK (corners, mid nodes of edges, centre), and shape functions N_k(r).

use crate::surface::vector::Vector;

/// Largest number of nodes of a face.
pub const MOST: usize = 9;
/// A point of the parent interval [-1, 1], triangle r, s >= 0, r + s <= 1, or square [-1, 1]^2; s = 0 for lines.
pub type Parent = [f64; 2];

/// Shape of a face: lines in the plane, the others in space.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Line2,
    Line3,
    Tri3,
    Tri6,
    Quad4,
    Quad8,
    Quad9,
}

use Shape::{Line2, Line3, Quad4, Quad8, Quad9, Tri3, Tri6};

/// What a parent is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Line,
    Triangle,
    Square,
}

/// Values and derivatives of the shape functions at a point; entries beyond the nodes are 0.
#[derive(Debug, Clone, Copy)]
pub struct Functions {
    /// N_k
    pub n: [f64; MOST],
    /// N_k,r and N_k,s
    pub first: [[f64; MOST]; 2],
    /// N_k,rr, N_k,ss and N_k,rs
    pub second: [[f64; MOST]; 3],
}

/// Corners of the parents, in the order of the nodes.
const LINE: [Parent; 2] = [[-1.0, 0.0], [1.0, 0.0]];
const TRIANGLE: [Parent; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
const SQUARE: [Parent; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Sub-faces between the nodes, by local numbers; triangles repeat their last corner.
type SubFaces = &'static [[usize; 4]];

impl Shape {
    pub const ALL: [Self; 7] = [Line2, Line3, Tri3, Tri6, Quad4, Quad8, Quad9];

    pub fn kind(self) -> Kind {
        match self {
            Line2 | Line3 => Kind::Line,
            Tri3 | Tri6 => Kind::Triangle,
            Quad4 | Quad8 | Quad9 => Kind::Square,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Line2 => "LINE2",
            Line3 => "LINE3",
            Tri3 => "TRI3",
            Tri6 => "TRI6",
            Quad4 => "QUAD4",
            Quad8 => "QUAD8",
            Quad9 => "QUAD9",
        }
    }

    /// Dimension of the space in which it is a face.
    pub fn dim(self) -> usize {
        if self.kind() == Kind::Line {
            2
        } else {
            3
        }
    }

    pub fn nodes(self) -> usize {
        match self {
            Line2 => 2,
            Line3 | Tri3 => 3,
            Quad4 => 4,
            Tri6 => 6,
            Quad8 => 8,
            Quad9 => 9,
        }
    }

    /// Corners of the parent. Edge k of a triangle or square begins at corner k; edge k of a line is its end k.
    pub fn corners(self) -> &'static [Parent] {
        match self.kind() {
            Kind::Line => &LINE,
            Kind::Triangle => &TRIANGLE,
            Kind::Square => &SQUARE,
        }
    }

    /// First and last corner of an edge.
    pub fn edge(self, k: usize) -> [usize; 2] {
        match self.kind() {
            Kind::Line => [k, k],
            _ => [k, (k + 1) % self.corners().len()],
        }
    }

    pub fn is_quadratic(self) -> bool {
        matches!(self, Line3 | Tri6 | Quad8 | Quad9)
    }

    /// Length of the parent in each direction.
    pub fn extent(self) -> f64 {
        if self.kind() == Kind::Triangle {
            1.0
        } else {
            2.0
        }
    }

    /// Centre of the parent.
    pub fn centre(self) -> Parent {
        match self.kind() {
            Kind::Triangle => [1.0 / 3.0; 2],
            _ => [0.0; 2],
        }
    }

    /// The parent's point of node k.
    pub fn place(self, k: usize) -> Parent {
        let corners = self.corners();
        match k.checked_sub(corners.len()) {
            None => corners[k],
            Some(_) if self.kind() == Kind::Line => [0.0; 2],
            Some(edge) if edge < corners.len() => {
                let [a, b] = self.edge(edge).map(|corner| corners[corner]);
                [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
            }
            Some(_) => self.centre(),
        }
    }

    /// Straight sub-faces between the nodes.
    pub fn sub_faces(self) -> SubFaces {
        match self {
            Line2 => &[[0, 1, 1, 1]],
            Line3 => &[[0, 2, 2, 2], [2, 1, 1, 1]],
            Tri3 => &[[0, 1, 2, 2]],
            Tri6 => &[[0, 3, 5, 5], [3, 1, 4, 4], [5, 4, 2, 2], [3, 4, 5, 5]],
            Quad4 => &[[0, 1, 2, 3]],
            Quad8 => &[[0, 4, 7, 7], [4, 1, 5, 5], [5, 2, 6, 6], [6, 3, 7, 7], [4, 5, 6, 7]],
            Quad9 => &[[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]],
        }
    }

    /// The shape functions at r.
    pub fn at(self, r: Parent) -> Functions {
        match self {
            Line2 => products(&linear(r[0]), &ONE, &[[0, 0], [1, 0]]),
            Line3 => products(&quadratic(r[0]), &ONE, &[[0, 0], [1, 0], [2, 0]]),
            Tri3 | Tri6 => triangle(self, r),
            Quad4 => products(&linear(r[0]), &linear(r[1]), &TENSOR[..4]),
            Quad8 => serendipity(r),
            Quad9 => products(&quadratic(r[0]), &quadratic(r[1]), &TENSOR),
        }
    }
}

/// Functions of one variable: value, first and second derivative.
type Along = [[f64; 3]; 3];

const ONE: Along = [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
/// Which functions of r and of s each node of a square has.
const TENSOR: [[usize; 2]; 9] = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [1, 2], [2, 1], [0, 2], [2, 2]];

fn linear(r: f64) -> Along {
    [[0.5 * (1.0 - r), -0.5, 0.0], [0.5 * (1.0 + r), 0.5, 0.0], [0.0; 3]]
}

fn quadratic(r: f64) -> Along {
    [[0.5 * r * (r - 1.0), r - 0.5, 1.0], [0.5 * r * (r + 1.0), r + 0.5, 1.0], [1.0 - r * r, -2.0 * r, -2.0]]
}

impl Functions {
    const ZERO: Self = Self { n: [0.0; MOST], first: [[0.0; MOST]; 2], second: [[0.0; MOST]; 3] };

    /// Adds the function with value `v`, gradient `d` and second derivatives `dd` (rr, ss, rs) to N_k.
    fn add(&mut self, k: usize, v: f64, d: [f64; 2], dd: [f64; 3]) {
        self.n[k] += v;
        (0..2).for_each(|a| self.first[a][k] += d[a]);
        (0..3).for_each(|a| self.second[a][k] += dd[a]);
    }

    /// `sum_k w_k x_k`, w being one of the sets of numbers.
    #[inline]
    pub fn sum(w: &[f64; MOST], x: &[Vector]) -> Vector {
        let mut sum = [0.0; 3];
        for (w, x) in w.iter().zip(x) {
            (0..3).for_each(|i| sum[i] += w * x[i]);
        }
        sum
    }
}

/// N_k = f_i(r) g_j(s), (i, j) = of[k].
fn products(f: &Along, g: &Along, of: &[[usize; 2]]) -> Functions {
    let mut all = Functions::ZERO;
    for (k, [i, j]) in of.iter().enumerate() {
        let (f, g) = (f[*i], g[*j]);
        all.add(k, f[0] * g[0], [f[1] * g[0], f[0] * g[1]], [f[2] * g[0], f[0] * g[2], f[1] * g[1]]);
    }
    all
}

/// TRI3: N_i = L_i; TRI6: N_i = L_i (2 L_i - 1), 4 L_i L_j on the edges; L barycentric.
fn triangle(shape: Shape, r: Parent) -> Functions {
    const D: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let l = [1.0 - r[0] - r[1], r[0], r[1]];
    let mut all = Functions::ZERO;
    for i in 0..3 {
        if shape == Tri3 {
            all.add(i, l[i], D[i], [0.0; 3]);
            continue;
        }
        let j = (i + 1) % 3;
        let slope = 4.0 * l[i] - 1.0;
        let square = |a: usize, b: usize| 4.0 * D[i][a] * D[i][b];
        let corner = [slope * D[i][0], slope * D[i][1]];
        all.add(i, l[i] * (2.0 * l[i] - 1.0), corner, [square(0, 0), square(1, 1), square(0, 1)]);
        let first = |a: usize| 4.0 * (l[i] * D[j][a] + D[i][a] * l[j]);
        let mixed = |a: usize, b: usize| 4.0 * (D[i][a] * D[j][b] + D[i][b] * D[j][a]);
        all.add(3 + i, 4.0 * l[i] * l[j], [first(0), first(1)], [mixed(0, 0), mixed(1, 1), mixed(0, 1)]);
    }
    all
}

/// QUAD8: the mid nodes have (1 - r^2) (1 +- s) / 2 and (1 +- r) (1 - s^2) / 2, corners the bilinear function less half of those of their
/// two edges.
fn serendipity(r: Parent) -> Functions {
    let (f, g) = ([quadratic(r[0])[2], quadratic(r[1])[2]], [linear(r[0]), linear(r[1])]);
    let mut all = products(&g[0], &g[1], &TENSOR[..4]);
    for (edge, [i, j]) in [[2, 0], [1, 2], [2, 1], [0, 2]].into_iter().enumerate() {
        let (a, b) = if i == 2 { (f[0], g[1][j]) } else { (g[0][i], f[1]) };
        let (v, d) = (a[0] * b[0], [a[1] * b[0], a[0] * b[1]]);
        let dd = [a[2] * b[0], a[0] * b[2], a[1] * b[1]];
        all.add(4 + edge, v, d, dd);
        for corner in [edge, (edge + 1) % 4] {
            all.add(corner, -0.5 * v, d.map(|d| -0.5 * d), dd.map(|d| -0.5 * d));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [Parent; 4] = [[0.2, 0.3], [-0.7, 0.45], [0.9, -0.2], [0.05, 1.05]];

    fn differences(shape: Shape, r: Parent, a: usize, of: impl Fn(&Functions) -> [f64; MOST]) -> [f64; MOST] {
        let h = 1e-5;
        let moved = |by: f64| {
            let mut r = r;
            r[a] += by;
            of(&shape.at(r))
        };
        let (plus, minus) = (moved(h), moved(-h));
        std::array::from_fn(|k| (plus[k] - minus[k]) / (2.0 * h))
    }

    fn close(a: [f64; MOST], b: [f64; MOST], tolerance: f64) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
    }

    #[test]
    fn a_shape_function_is_1_at_its_node_and_0_at_the_others() {
        for shape in Shape::ALL {
            for k in 0..shape.nodes() {
                let n = shape.at(shape.place(k)).n;
                let expected = std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 });
                assert!(close(n, expected, 1e-15), "{shape:?} {k}: {n:?}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_functions_and_sum_to_zero() {
        for (shape, r) in Shape::ALL.into_iter().flat_map(|s| POINTS.map(|r| (s, r))) {
            let f = shape.at(r);
            for a in 0..if shape.dim() == 2 { 1 } else { 2 } {
                assert!(close(differences(shape, r, a, |f| f.n), f.first[a], 1e-9), "{shape:?}");
                assert!(close(differences(shape, r, a, |f| f.first[a]), f.second[a], 1e-9), "{shape:?}");
                assert!(f.first[a].iter().sum::<f64>().abs() < 1e-14);
            }
            assert!(shape.dim() == 2 || close(differences(shape, r, 1, |f| f.first[0]), f.second[2], 1e-9));
            assert!((f.n.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn sub_faces_cover_the_parent_once_and_turn_as_the_face() {
        for shape in Shape::ALL {
            let area = |of: &[usize; 4]| {
                let p = of.map(|k| shape.place(k));
                let doubled = |a: Parent, b: Parent, c: Parent| {
                    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
                };
                match shape.kind() {
                    Kind::Line => p[1][0] - p[0][0],
                    _ => 0.5 * (doubled(p[0], p[1], p[2]) + doubled(p[0], p[2], p[3])),
                }
            };
            let areas: Vec<f64> = shape.sub_faces().iter().map(area).collect();
            let whole = match shape.kind() {
                Kind::Line => 2.0,
                Kind::Triangle => 0.5,
                Kind::Square => 4.0,
            };
            assert!(areas.iter().all(|a| *a > 0.0) && (areas.iter().sum::<f64>() - whole).abs() < 1e-15);
        }
    }
}
