//! The frame of a face at a point, which turns with the nodes of the face, and the derivative of what it carries.

use crate::surface::patch::Patch;
use crate::surface::shape::{Functions, Parent};
use crate::surface::vector::{cross, dot, length, plus, times, unit, Vector, E_Z};

/// e_1 along X_1, e_3 the normal, e_2 = e_3 x e_1: unit vectors at X(r).
pub struct Frame {
    pub y: Vector,
    pub functions: Functions,
    e: [Vector; 3],
    /// |X_1|
    stretch: f64,
    /// e_2.X^1 and e_2.X^2, X^a the dual tangents: `X^a.X_b = 1` for a = b, else 0.
    dual: [f64; 2],
}

impl Frame {
    pub fn at(patch: &Patch, r: Parent) -> Self {
        let functions = patch.shape.at(r);
        let ([a, b], n) = (patch.tangents(&functions), patch.normal(&functions));
        let e_1 = unit(a).unwrap_or_else(|| unit(cross(b, n)).unwrap_or(E_Z));
        let e_2 = cross(n, e_1);
        let area = dot(n, cross(a, b));
        let dual = [cross(b, n), cross(n, a)].map(|d| if area > 0.0 { dot(e_2, d) / area } else { 0.0 });
        let y = Functions::sum(&functions.n, patch.nodes());
        Self { y, functions, e: [e_1, e_2, n], stretch: length(a), dual }
    }

    /// Its vectors: along the face, and the normal last.
    pub fn vectors(&self) -> [Vector; 3] {
        self.e
    }

    fn components(&self, d: Vector) -> [f64; 3] {
        self.e.map(|e| dot(e, d))
    }

    /// Of each node k the vector p_k with `w.dd = sum_k p_k.u_k`: how a vector d that the frame carries turns as the nodes move by u_k. With
    /// dd = sum_ij d_i (e_j.de_i) e_j this is
    ///
    /// ```text
    /// (d_1 w_2 - d_2 w_1) e_2.dX_1/|X_1| + (d_1 w_3 - d_3 w_1) e_3.dX_1/|X_1| + (d_2 w_3 - d_3 w_2) sum_a (e_2.X^a) e_3.dX_a
    /// ```
    ///
    /// For d in the face and w = g e_3 it is g sum_a (d.X^a) e_3.dX_a.
    pub fn turning(&self, d: Vector, w: Vector) -> impl Fn(usize) -> Vector + '_ {
        let (d, w) = (self.components(d), self.components(w));
        let pair = |i: usize, j: usize| d[i] * w[j] - d[j] * w[i];
        let [_, e_2, e_3] = self.e;
        let per_stretch = if self.stretch > 0.0 { self.stretch.recip() } else { 0.0 };
        let of_first = plus(
            times(per_stretch * pair(0, 1), e_2),
            per_stretch * pair(0, 2) + pair(1, 2) * self.dual[0],
            e_3,
        );
        let of_second = times(pair(1, 2) * self.dual[1], e_3);
        move |k| {
            let [a, b] = self.functions.first.map(|of| of[k]);
            plus(times(a, of_first), b, of_second)
        }
    }
}
