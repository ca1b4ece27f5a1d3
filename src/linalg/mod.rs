//! Vectors, matrices, ordering and factorisation. The only layer that uses faer.
//!
//! | module | holds |
//! |---|---|
//! | `vector`, `twofold`, `array` | loops over vectors, sums in twice the digits, numbers stored by the library or the host |
//! | `random`, `hash` | fixed random numbers, keys of lists |
//! | `dense` | columns; packed symmetric matrices; pivoted Cholesky, eigenvalues, singular values |
//! | `sparse` | by rows; symmetric; graphs; Gram matrices |
//! | `cholesky` | the sparse factorisation and operations with the factor |
//! | `semidefinite` | systems that may be singular, dense and sparse |

pub mod array;
pub mod cholesky;
pub mod dense;
pub mod hash;
pub mod random;
pub mod semidefinite;
pub mod sparse;
pub mod twofold;
pub mod vector;

pub use array::{Array, Borrowed};
pub use cholesky::{Analysis, Breakdown, Cholesky};
pub use dense::matrix::Matrix;
pub use dense::packed::Packed;
pub use dense::pivoted::PivotedCholesky;
pub use semidefinite::dense::SpdSolver;
pub use sparse::csr::Csr;
pub use sparse::graph;
pub use sparse::runs::Runs;
pub use sparse::symmetric::{Multiple, Symmetric};

use crate::error::Result;

/// A symmetric linear map `R^m -> R^m` known by its products only.
pub trait Operator: Sync {
    /// Number of unknowns m.
    fn order(&self) -> usize;
    /// `y = A x`, both of length m.
    fn apply(&self, x: &[f64], y: &mut [f64]);
    /// The same for operators that may be told to stop working: an error leaves y as it was.
    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.apply(x, y);
        Ok(())
    }
    /// A cheaper product with an operator near to A, symmetric and as definite: that with A itself where there is none.
    fn approximate(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.try_apply(x, y)
    }
    /// There is one.
    fn has_approximation(&self) -> bool {
        false
    }
    /// Bytes of its entries; 0 for an operator that keeps none.
    fn bytes_kept(&self) -> usize {
        0
    }
}

/// A symmetric matrix that can hand out a block of its entries.
pub trait Entries {
    /// Adds the lower triangle of `A_FF` to `block`, n x n; F = `rows`, n of them, ascending.
    fn add_block(&self, rows: &[usize], block: &mut Matrix) -> Result<()>;
}
