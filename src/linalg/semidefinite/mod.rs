//! Systems `W x = b` that may be singular, such as those of the coarse space: W positive semidefinite, x of minimum norm.

pub mod clusters;
pub mod dense;
pub mod faces;
mod resisted;
pub mod sparse;

use crate::error::Result;
use crate::linalg::random::scattered;
use crate::linalg::vector::norm;
use crate::linalg::{Cholesky, Matrix};

/// A pivot of a matrix with its largest diagonal entry about 1 up to this means that it is singular.
pub const SINGULAR: f64 = 1e-11;
/// One up to this leaves the doubt that `is_regular` resolves: a free motion may move the last unknowns by the part t of the others only. The
/// pivot before these is about t^2, and the last one, which ought to be 0, is rounding of 1e-16 / t^2 of either sign, or of 1e-16 / t^4
/// where the very last moves by t^2. That is below t^2 while t^2 is above the cube root of 1e-16.
pub const DOUBTFUL: f64 = 1e-5;

/// No motion is free: L L', the factor computed of W, is W but for some 1e-16 of each, so along a free motion it has no more. Its
/// smallest eigenvalue is found by inverse iteration, where pivots leave a doubt.
fn is_regular(
    order: usize,
    smallest_pivot: f64,
    mut solve: impl FnMut(&mut [f64]) -> Result<()>,
) -> Result<bool> {
    const ITERATIONS: usize = 3;
    const FREE: f64 = 1e-13;
    if smallest_pivot <= SINGULAR || smallest_pivot > DOUBTFUL {
        return Ok(smallest_pivot > DOUBTFUL);
    }
    let (mut x, mut eigenvalue) = (scattered(order), 0.0);
    for _ in 0..ITERATIONS {
        let length = norm(&x);
        x.iter_mut().for_each(|v| *v /= length);
        solve(&mut x)?;
        eigenvalue = 1.0 / norm(&x);
    }
    Ok(eigenvalue > FREE)
}

/// The same of a sparse factor.
pub fn is_regular_factor(factor: &Cholesky) -> Result<bool> {
    is_regular(factor.analysis.position.len(), factor.smallest_pivot(), |x| factor.solve(x))
}

/// `W+` of a matrix that is singular or all but so.
pub trait GeneralInverse {
    /// The solution of minimum norm.
    fn solve(&self, b: &[f64]) -> Result<Vec<f64>>;

    /// `x += a N N'b`, N an orthonormal basis of the kernel.
    fn add_kernel_part(&self, a: f64, b: &[f64], x: &mut [f64]);

    /// Dimension of the kernel.
    fn deficiency(&self) -> usize;

    /// Basis of all but the kernel, n x rank.
    fn basis(&self) -> Matrix;

    /// Basis of the kernel, n x deficiency.
    fn kernel(&self) -> Matrix;

    /// Some motions are held so weakly that rounding of `G_F v` matters in `W+ G_F v`.
    fn is_weak(&self) -> bool;
}
