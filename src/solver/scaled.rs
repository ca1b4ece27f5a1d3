//! Loads and gaps of an island as its dual takes them.

use crate::dual::Preconditioner;
use crate::error::Result;
use crate::linalg::vector::{axpy, norm_max};
use crate::linalg::Operator;
use crate::qp::{self, Qp};
use crate::solver::diagnosis::{Unheld, ROUNDING};
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
    /// `e = R'f`
    pub resultants: Vec<f64>,
    /// What has been taken from the loads because nothing holds it.
    pub unheld: Option<Taken>,
}

/// Loads without what nothing holds of them.
pub(super) struct Taken {
    /// The loads without it, force; none where it is so little of each body that only their resultants are without it.
    pub load: Option<Vec<f64>>,
    /// The largest |resultant| / |load| of bodies that move together.
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
        let resultants = ready.dual.resultants(&load);
        Ok(Self { load, gaps, moved, d, resultants, unheld: None })
    }

    /// Takes from the loads what the forces of the dual leave of them, of which nothing holds a `share`.
    pub fn take(&mut self, problem: &Problem, ready: &Ready, left: &Unheld, share: f64) -> Result<()> {
        self.resultants.fill(0.0);
        ready.dual.coarse.mul_transposed_add(1.0, &left.x, &mut self.resultants);
        let mut taken = Taken { load: None, share };
        if share.max(left.of_body) > ROUNDING {
            axpy(-1.0, &left.load, &mut self.load);
            self.moved = ready.moved(problem.threads(), &self.load)?;
            self.d = ready.dual.rhs(&self.moved, &self.gaps.dual);
            taken.load = Some(self.load.iter().map(|f| f * ready.island.unit).collect());
        }
        self.unheld = Some(taken);
        Ok(())
    }

    pub fn qp<'a>(&'a self, ready: &'a Ready, a: &'a dyn Operator) -> Qp<'a> {
        let g_transposed = &ready.dual.coarse;
        let preconditioner = ready.preconditioner.as_ref().map(|(_, m)| m as &dyn qp::Preconditioner);
        let (b, e, bounded, rounding) =
            (&self.d, &self.resultants, &self.gaps.bounded, ready.dual.rounding());
        Qp { a, b, g_transposed, rounding, e, bounded, preconditioner }
    }
}

impl qp::Preconditioner for Preconditioner {
    fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        Preconditioner::apply(self, held, r, z)
    }
}
