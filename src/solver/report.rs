//! What a solve tells the host.

use crate::certificate::Certificate;
use crate::solver::phases::PhaseReport;

/// How a solve ended with an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The certificate holds.
    Solved,
    /// The limit of steps was reached first.
    Iterations,
    /// The time limit was reached first.
    Time,
    Cancelled,
    /// The method found no way to improve an answer whose certificate does not hold.
    Stalled,
    /// The dual is solved as well as rounding allows, and the certificate does not hold.
    Inaccurate,
    /// The load is held only up to a part below 1e-7 of itself.
    Marginal,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowState {
    /// The bodies are apart here, no force.
    Open,
    /// In contact, with a force.
    Closed,
    /// Touching without a force, to rounding.
    Weak,
}

/// Sizes of a problem.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    pub bodies: usize,
    /// Unknowns of all bodies.
    pub dofs: usize,
    pub rows: usize,
    pub equalities: usize,
}

/// Work of all setups since the problem was created: what a change of the data costs shows in the difference.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Work {
    /// Symbolic analyses: ordering and pattern of a factor.
    pub analyses: usize,
    /// Numeric factorisations for K+.
    pub factorisations: usize,
    /// Columns of the dual operators F_p, one for each body that a row of the dual touches: computed, and kept from the
    /// rows before.
    pub columns_computed: usize,
    pub columns_kept: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    pub outcome: Outcome,
    pub certificate: Certificate,
    pub counts: Counts,
    /// Dimension of the null spaces of all bodies.
    pub floating_modes: usize,
    /// Contact rows that are closed.
    pub active: usize,
    /// Rigid motions that no closed row resists: u is one of many.
    pub undetermined: usize,
    pub steps: usize,
    pub cg_steps: usize,
    pub expansions: usize,
    pub releases: usize,
    /// Outer iterations of an augmented Lagrangian; 0 for a method without one.
    pub outer: usize,
    /// Products with F.
    pub dual_applications: usize,
    pub coarse_solves: usize,
    pub coarse_factorisations: usize,
    /// Products with the preconditioner.
    pub preconditioner_applications: usize,
    /// Faces on which the dual was solved directly.
    pub direct_solves: usize,
    /// The direct finish was asked for, and its answer is kept.
    pub finished: bool,
    /// `|S|B||u|| + |S c|` at the first feasible forces: what the tolerance of the dual is relative to,
    /// `(force x length)^1/2`.
    pub gap_scale: f64,
    /// As in `Work`.
    pub factorisations: usize,
    pub analyses: usize,
    pub columns_computed: usize,
    pub columns_kept: usize,
    /// `1/2 u'K u - f'u + 1/2 lambda'C lambda + 1/2 mu'C mu`, force x length.
    pub energy: f64,
    pub seconds_setup: f64,
    pub seconds_solve: f64,
    /// Bodies whose dual operator has its entries, and those whose operator is known by its products alone.
    pub explicit_operators: usize,
    pub implicit_operators: usize,
    /// Bytes of the factors and, at most, of the work arrays of their computation; of the explicit operators.
    pub factor_bytes: usize,
    pub operator_bytes: usize,
    /// Time and memory of every phase, in their order.
    pub phases: Vec<PhaseReport>,
}
