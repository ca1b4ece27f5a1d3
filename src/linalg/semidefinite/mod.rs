//! Systems `W x = b` that may be singular, as those of the coarse space: W positive semidefinite, x of minimum norm.

pub mod clusters;
pub mod dense;
pub mod faces;
mod resisted;
pub mod sparse;

use crate::error::Result;
use crate::linalg::Matrix;

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
