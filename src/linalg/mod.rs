//! Vectors, matrices, ordering and factorisation. The only layer that knows faer.

pub mod array;
mod blocks;
pub mod cholesky;
pub mod columns;
pub mod csr;
pub mod dense;
pub mod elimination;
mod front;
pub mod gram;
pub mod graph;
#[cfg(feature = "metis")]
mod metis;
mod multifrontal;
pub mod ordering;
pub mod packed;
pub mod pivoted;
pub mod pseudo;
pub mod reach;
pub mod resisted;
pub mod spd;
mod subtrees;
mod supernodes;
pub mod symmetric;
pub mod trailing;
mod triangular;
pub mod twofold;
mod updates;
pub mod vector;

pub use array::{Array, Borrowed};
pub use cholesky::{Analysis, Breakdown, Cholesky};
pub use csr::Csr;
pub use dense::Matrix;
pub use packed::Packed;
pub use pivoted::PivotedCholesky;
pub use spd::SpdSolver;
pub use symmetric::{Multiple, Symmetric};

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
