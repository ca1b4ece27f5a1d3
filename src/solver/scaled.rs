//! Loads and gaps of an island as its dual takes them.

use crate::dual::Preconditioner;
use crate::error::Result;
use crate::linalg::vector::{norm_max, ratio, weighted_norm};
use crate::linalg::Operator;
use crate::qp::{self, Qp};
use crate::solver::presolve::{presolve, Gaps};
use crate::solver::problem::Problem;
use crate::solver::setup::Ready;
use crate::solver::watch::Stops;

/// Loads and gaps as the dual takes them.
pub(super) struct Scaled {
    /// f / 2^p
    pub load: Vec<f64>,
    pub gaps: Gaps,
    /// `B_p K_p+ f_p` of every body.
    pub moved: Vec<Vec<f64>>,
    d: Vec<f64>,
    e: Vec<f64>,
    /// `|e|` over the size of the loads that it is the resultant of, at most 1.
    pub share: f64,
}

impl Scaled {
    pub fn new(problem: &Problem, ready: &Ready, stops: &Stops) -> Result<Self> {
        let mut load = ready.island.loads(problem)?;
        load.iter_mut().for_each(|f| *f /= ready.island.unit);
        let moved = ready.moved(problem.threads(), &load)?;
        let farthest = moved.iter().map(|own| norm_max(own)).fold(0.0, f64::max);
        let gaps = presolve(problem, ready, farthest, stops)?;
        let d = ready.dual.rhs(&moved, &gaps.dual);
        let e = ready.dual.resultants(&load);
        let whole =
            ready.dual.size_of_loads(&ready.island.without_grounded(problem, &load), &ready.rows.metric);
        let share = ratio(weighted_norm(&e, |_| 1.0), whole).min(1.0);
        Ok(Self { load, gaps, moved, d, e, share })
    }

    pub fn qp<'a>(&'a self, ready: &'a Ready, a: &'a dyn Operator) -> Qp<'a> {
        let g_transposed = &ready.dual.coarse;
        let preconditioner = ready.preconditioner.as_ref().map(|(_, m)| m as &dyn qp::Preconditioner);
        let (b, e, bounded, rounding) = (&self.d, &self.e, &self.gaps.bounded, ready.dual.rounding());
        Qp { a, b, g_transposed, rounding, e, bounded, preconditioner }
    }
}

impl qp::Preconditioner for Preconditioner {
    fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        Preconditioner::apply(self, held, r, z)
    }
}
