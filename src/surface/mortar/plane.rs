//! The plane of a slave's sub-face, and faces seen along its normal.

use crate::numbers::surface::{NO_AREA, SQUARED};
use crate::surface::mortar::monomials::{coefficients, count, derivatives, functions, values};
use crate::surface::mortar::polygon::Flat;
use crate::surface::patch::Patch;
use crate::surface::shape::{Parent, Shape, MOST};
use crate::surface::vector::{across, cross, dot, minus, plus, unit, Vector, E_Z};

/// Along the diagonals of the corners; of a line the line itself.
#[derive(Debug, Clone, Copy)]
pub struct Plane {
    origin: Vector,
    /// n0, outward from the slave.
    pub normal: Vector,
    e: [Vector; 2],
}

/// Vectors whose product has the direction of the normal: the diagonals, with the last corner of triangles repeated; of a line its chord
/// and the normal of the plane.
pub fn diagonals(x: [Vector; 4], dim: usize) -> [Vector; 2] {
    if dim == 2 {
        return [minus(x[1], x[0]), E_Z];
    }
    [minus(x[2], x[0]), minus(x[3], x[1])]
}

impl Plane {
    /// None for corners that span no plane.
    pub fn of(x: [Vector; 4], dim: usize) -> Option<Self> {
        let [p, q] = diagonals(x, dim);
        let normal = unit(cross(p, q))?;
        let along = unit(across(minus(x[1], x[0]), normal))?;
        let origin = (0..3).fold([0.0; 3], |sum, k| plus(sum, 1.0 / 3.0, x[k]));
        Some(Self { origin, normal, e: [along, cross(normal, along)] })
    }

    pub fn down(&self, x: Vector) -> Flat {
        let from = minus(x, self.origin);
        self.e.map(|e| dot(e, from))
    }

    pub fn height(&self, x: Vector) -> f64 {
        dot(self.normal, minus(x, self.origin))
    }

    pub fn up(&self, z: Flat) -> Vector {
        plus(plus(self.origin, z[0], self.e[0]), z[1], self.e[1])
    }
}

/// A face whose points are found along the normal of a plane: `B'(X(r) - z) = 0`, B the directions of the plane.
pub struct Seen {
    pub shape: Shape,
    /// X in the plane by monomials, and how many there are.
    terms: [Flat; MOST],
    count: usize,
    height: [f64; MOST],
    /// X(start) in the plane, and the inverse of dX/dr there.
    start: Parent,
    at: Flat,
    inverse: [Flat; 2],
}

/// Steps of Newton's method; the start is exact for affine faces.
const STEPS: usize = 20;

impl Seen {
    /// From the point `start` of the face; none if it is seen edge-on there.
    pub fn new(patch: &Patch, plane: &Plane, start: Parent) -> Option<Self> {
        let (shape, count) = (patch.shape, count(patch.shape));
        let (mut terms, mut height) = ([[0.0; 2]; MOST], [0.0; MOST]);
        for (k, x) in patch.nodes().iter().enumerate() {
            let z = plane.down(*x);
            height[k] = plane.height(*x);
            for (term, c) in terms.iter_mut().zip(coefficients(shape)).take(count) {
                (0..2).for_each(|i| term[i] += c[k] * z[i]);
            }
        }
        let inverse = [[0.0; 2]; 2];
        let mut seen = Self { shape, terms, count, height, start, at: [0.0; 2], inverse };
        (seen.at, seen.inverse) = seen.linear(start)?;
        Some(seen)
    }

    /// X in the plane, and the inverse of dX/dr.
    fn linear(&self, r: Parent) -> Option<(Flat, [Flat; 2])> {
        let (phi, [by_r, by_s]) = (values(r), derivatives(r));
        let (mut at, mut a, mut b) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        for (m, term) in self.terms[..self.count].iter().enumerate() {
            for i in 0..2 {
                at[i] += phi[m] * term[i];
                a[i] += by_r[m] * term[i];
                b[i] += by_s[m] * term[i];
            }
        }
        if self.shape.dim() == 2 {
            b = [0.0, a[0].abs()];
        }
        let det = a[0] * b[1] - a[1] * b[0];
        let squares = (a[0] * a[0] + a[1] * a[1]) * (b[0] * b[0] + b[1] * b[1]);
        let inverse = [[b[1] / det, -b[0] / det], [-a[1] / det, a[0] / det]];
        (det * det > NO_AREA * NO_AREA * squares).then_some((at, inverse))
    }

    /// The place of the point r in the plane, and the area there per area of the parent.
    pub fn below(&self, r: Parent) -> Option<(Flat, f64)> {
        let (at, [[a, b], [c, d]]) = self.linear(r)?;
        Some((at, (a * d - b * c).recip()))
    }

    /// The point above z and the shape functions there; none if there is none near the face.
    pub fn above(&self, z: Flat) -> Option<(Parent, [f64; MOST])> {
        let step = |inverse: &[Flat; 2], at: Flat| {
            inverse.map(|row| row[0] * (z[0] - at[0]) + row[1] * (z[1] - at[1]))
        };
        let first = step(&self.inverse, self.at);
        let mut r = [self.start[0] + first[0], self.start[1] + first[1]];
        for _ in 0..STEPS {
            let (at, inverse) = self.linear(r)?;
            let d = step(&inverse, at);
            r = [r[0] + d[0], r[1] + d[1]];
            if d[0].abs().max(d[1].abs()) <= SQUARED {
                return Some((r, functions(self.shape, r)));
            }
        }
        None
    }

    /// Height above the plane, length.
    pub fn height(&self, n: &[f64; MOST]) -> f64 {
        n.iter().zip(&self.height).map(|(n, height)| n * height).sum()
    }
}
