//! Shape functions as sums of monomials, for many points of one face: `N_k(r) = sum_m c_mk phi_m(r)`.

use std::sync::OnceLock;

use crate::surface::shape::{Functions, Parent, Shape, MOST};

/// Coefficients of the functions of each node by monomials, which are 1, r, s, rs, r^2, s^2, r^2 s, r s^2, r^2 s^2.
pub type Coefficients = [[f64; MOST]; MOST];

/// Monomials that a shape has.
pub fn count(shape: Shape) -> usize {
    match shape {
        Shape::Line2 => 2,
        Shape::Tri3 => 3,
        Shape::Quad4 => 4,
        Shape::Line3 => 5,
        Shape::Tri6 => 6,
        Shape::Quad8 => 8,
        Shape::Quad9 => 9,
    }
}

/// Their values.
#[inline]
pub fn values([r, s]: Parent) -> [f64; MOST] {
    [1.0, r, s, r * s, r * r, s * s, r * r * s, r * s * s, r * r * s * s]
}

/// Their derivatives by r and by s.
#[inline]
pub fn derivatives([r, s]: Parent) -> [[f64; MOST]; 2] {
    [
        [0.0, 1.0, 0.0, s, 2.0 * r, 0.0, 2.0 * r * s, s * s, 2.0 * r * s * s],
        [0.0, 0.0, 1.0, r, 0.0, 2.0 * s, r * r, 2.0 * r * s, 2.0 * r * r * s],
    ]
}

/// From the Taylor series at 0; the terms of third and fourth order are differences of second derivatives along the axes.
pub fn coefficients(shape: Shape) -> &'static Coefficients {
    static ALL: [OnceLock<Coefficients>; 7] = [const { OnceLock::new() }; 7];
    ALL[shape as usize].get_or_init(|| {
        let at = |r: f64, s: f64| shape.at([r, s]);
        let here = at(0.0, 0.0);
        let half = |a: usize| here.second[a].map(|v| 0.5 * v);
        let [up, down, right, left] = [at(0.0, 1.0), at(0.0, -1.0), at(1.0, 0.0), at(-1.0, 0.0)];
        let slope = |high: &Functions, low: &Functions, a: usize| {
            std::array::from_fn(|k| (high.second[a][k] - low.second[a][k]) / 4.0)
        };
        let curvature = |k: usize| (up.second[0][k] + down.second[0][k]) / 4.0 - 0.5 * here.second[0][k];
        [
            here.n,
            here.first[0],
            here.first[1],
            here.second[2],
            half(0),
            half(1),
            slope(&up, &down, 0),
            slope(&right, &left, 1),
            std::array::from_fn(curvature),
        ]
    })
}

/// The shape functions at r.
pub fn functions(shape: Shape, r: Parent) -> [f64; MOST] {
    let mut n = [0.0; MOST];
    for (of, phi) in coefficients(shape).iter().zip(values(r)).take(count(shape)) {
        n.iter_mut().zip(of).for_each(|(n, c)| *n += c * phi);
    }
    n
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn monomials_give_the_functions_of_every_shape() {
        for shape in Shape::ALL {
            for w in crate::linalg::random::scattered(100).chunks(2) {
                let r = [w[0], if shape.dim() == 2 { 0.0 } else { w[1] }];
                let (n, expected) = (functions(shape, r), shape.at(r));
                assert!(n.iter().zip(expected.n).all(|(a, b)| (a - b).abs() < 1e-14), "{shape:?} {r:?}");
                for (a, phi) in derivatives(r).iter().enumerate().take(shape.dim() - 1) {
                    for k in 0..shape.nodes() {
                        let sum: f64 = (0..count(shape)).map(|m| coefficients(shape)[m][k] * phi[m]).sum();
                        assert!((sum - expected.first[a][k]).abs() < 1e-14, "{shape:?} {a} {k}");
                    }
                }
            }
        }
    }
}
