//! Systems `W x = b` that may be singular, such as those of the coarse space: W positive semidefinite, x of minimum norm.

pub mod clusters;
pub mod dense;
pub mod faces;
mod resisted;

use crate::error::Result;
use crate::linalg::random::scattered;
use crate::linalg::vector::norm;
use crate::linalg::Cholesky;

/// A matrix with its largest diagonal entry about 1 is singular if a pivot does not exceed this.
pub const SINGULAR: f64 = 1e-11;
/// Up to this value a pivot is doubtful, and `is_regular` decides: a free motion may move the last unknowns by only the
/// part t of the others. Then the pivot before them is about t^2, and the last pivot, which should be 0, is rounding of
/// 1e-16 / t^2 of either sign, or 1e-16 / t^4 if the very last unknown moves by t^2. This is below t^2 while t^2 is above
/// the cube root of 1e-16.
pub const DOUBTFUL: f64 = 1e-5;

/// A matrix with its largest diagonal entry about 1 has weakly resisted motions if a pivot is below this.
pub const WEAK: f64 = 1e-4;

/// Whether no motion is free. The computed factor L L' equals W up to about 1e-16 per entry, so it has no larger value
/// along a free motion. If the pivots are doubtful, inverse iteration finds its smallest eigenvalue.
pub fn is_regular(factor: &Cholesky) -> Result<bool> {
    const ITERATIONS: usize = 3;
    const FREE: f64 = 1e-13;
    let smallest_pivot = factor.smallest_pivot();
    if smallest_pivot <= SINGULAR || smallest_pivot > DOUBTFUL {
        return Ok(smallest_pivot > DOUBTFUL);
    }
    let (mut x, mut eigenvalue) = (scattered(factor.analysis.position.len()), 0.0);
    for _ in 0..ITERATIONS {
        let length = norm(&x);
        x.iter_mut().for_each(|v| *v /= length);
        factor.solve(&mut x)?;
        eigenvalue = 1.0 / norm(&x);
    }
    Ok(eigenvalue > FREE)
}
