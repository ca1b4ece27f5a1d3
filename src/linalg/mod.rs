//! Vectors, matrices, ordering and factorisation. The only layer that uses faer.
//!
//! | module | holds |
//! |---|---|
//! | `vector`, `twofold`, `array` | loops over vectors, double-double sums, numbers stored by the library or the host |
//! | `by_body` | vectors over the unknowns of several bodies |
//! | `random`, `hash` | fixed random numbers, keys of lists |
//! | `dense` | columns; packed symmetric matrices; pivoted Cholesky, eigenvalues, singular values |
//! | `sparse` | by rows; symmetric; graphs; Gram matrices |
//! | `partition` | halves of graphs with few edges between them |
//! | `cholesky` | the sparse factorisation and operations with the factor |
//! | `semidefinite` | systems that may be singular, dense and sparse |

pub mod array;
pub mod by_body;
pub mod cholesky;
pub mod dense;
pub mod hash;
pub mod partition;
pub mod random;
pub mod semidefinite;
pub mod sparse;
pub mod twofold;
pub mod vector;

pub use array::{Array, Borrowed};
pub use by_body::ByBody;
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

/// A symmetric linear map `R^m -> R^m`, given by its products.
pub trait Operator: Sync {
    /// Number of unknowns m.
    fn order(&self) -> usize;
    /// `y = A x`, both of length m.
    fn apply(&self, x: &[f64], y: &mut [f64]);
    /// As `apply`, for operators that can be interrupted: after an error y is unchanged.
    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.apply(x, y);
        Ok(())
    }
    /// As `try_apply`, where x is this share of a whole, relative to whose product rounding counts.
    fn apply_to_share(&self, _share: f64, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.try_apply(x, y)
    }
    /// A cheaper product with an approximation of A, symmetric and definite like A; without an approximation, with A
    /// itself.
    fn approximate(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.try_apply(x, y)
    }
    /// Whether there is an approximation.
    fn has_approximation(&self) -> bool {
        false
    }
    /// Bytes of its entries; 0 for an operator applied matrix-free.
    fn bytes_kept(&self) -> usize {
        0
    }
}

/// A symmetric matrix with access to blocks of its entries.
pub trait Entries: Sync {
    /// Adds the lower triangle of `A_FF` to `block`, n x n; F = `rows`, n rows, ascending.
    fn add_block(&self, rows: &[usize], block: &mut Matrix) -> Result<()>;
}
