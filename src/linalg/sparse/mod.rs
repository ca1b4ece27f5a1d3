//! Sparse matrices and their graphs.

pub mod csr;
pub mod gram;
pub mod graph;
pub mod runs;
mod sent;
pub mod symmetric;
