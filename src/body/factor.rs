//! What K+ is made of: a factor of the library, or the host's own.

use std::sync::Arc;

use crate::body::host::HostMultiple;
use crate::error::Result;
use crate::linalg::cholesky::{inverse_columns, inverse_form};
use crate::linalg::{Cholesky, Csr, Matrix, Packed};

#[derive(Clone)]
pub(super) enum Factor {
    /// Of K without the dofs held; bodies with the same matrix and the same dofs held share it.
    Own(Arc<Cholesky>),
    /// Known by its products.
    Host(HostMultiple),
}

impl Factor {
    /// `x <- K+ x`
    pub fn solve(&self, x: &mut [f64]) -> Result<()> {
        match self {
            Self::Own(factor) => factor.solve(x),
            Self::Host(host) => host.solve_in_place(x),
        }
    }

    /// Entries of the factor; 0 where the host has it.
    pub fn entries(&self) -> usize {
        match self {
            Self::Own(factor) => factor.analysis.entries(),
            Self::Host(_) => 0,
        }
    }

    /// Where it lies: the same for all that share it.
    pub fn address(&self) -> usize {
        match self {
            Self::Own(factor) => Arc::as_ptr(factor) as usize,
            Self::Host(host) => Arc::as_ptr(&host.operator) as usize,
        }
    }

    /// Solves on the thread alone that calls the library.
    pub fn on_caller(&self) -> bool {
        matches!(self, Self::Host(host) if host.operator.on_caller())
    }

    /// The columns `which` of `B K+ B'`, m x `which.len()`.
    pub fn inverse_columns(&self, rows: &Csr, which: &[usize]) -> Result<Matrix> {
        match self {
            Self::Own(factor) => inverse_columns(factor, rows, which),
            Self::Host(host) => host.inverse_columns(rows, which),
        }
    }

    /// `B K+ B'` for the rows B (m x n) of this body.
    pub fn inverse_form(&self, rows: &Csr) -> Result<Packed> {
        match self {
            Self::Own(factor) => inverse_form(factor, rows),
            Self::Host(host) => host.inverse_form(rows),
        }
    }
}
