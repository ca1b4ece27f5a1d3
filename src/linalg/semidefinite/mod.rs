//! Systems `W x = b` that may be singular, such as those of the coarse space: W positive semidefinite, x of minimum norm.

pub mod clusters;
pub mod dense;
pub mod faces;
mod resisted;

use crate::error::Result;
use crate::linalg::random::scattered;
use crate::linalg::vector::norm;
use crate::linalg::Cholesky;
use crate::numbers::linalg::{DOUBTFUL, SINGULAR};
use crate::numbers::rounding;

/// Whether no motion is free. The computed factor L L' equals W up to about 1e-16 per entry, so it has no larger value
/// along a free motion. If the pivots are doubtful, inverse iteration finds its smallest eigenvalue.
pub fn is_regular(factor: &Cholesky) -> Result<bool> {
    const ITERATIONS: usize = 3;
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
    Ok(eigenvalue > rounding::SOLVE)
}
