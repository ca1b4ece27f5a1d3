//! The dual problem of an island, ready for any load and gap.

use std::sync::Arc;

use crate::body::Away;
use crate::dual::{Dual, Preconditioner};
use crate::error::Result;
use crate::linalg::ByBody;
use crate::model::Preconditioning;
use crate::platform::threads;
use crate::qp::friction::PairsBetween;
use crate::qp::BetweenSolves;
use crate::setup::islands::Island;
use crate::setup::rows::DualRows;
use crate::setup::whole::Whole;

/// Multiplications of a product with F, a tenth of a millisecond, above which several threads save time.
const PARALLEL_PAYS: usize = 1 << 18;

/// The dual problem of an island. There may be very many, of one small body each: what few of them have is apart, and equal ones share
/// what does not depend on loads and gaps.
pub struct Ready {
    pub island: Box<Island>,
    pub dual: Arc<Dual>,
    pub rows: Arc<DualRows>,
    /// `D~ / 2^p` over the unknowns of the bodies that are here.
    pub metric: Arc<ByBody>,
    /// What few islands have.
    pub(super) apart: Option<Box<Apart>>,
    /// The preconditioner and its option.
    pub preconditioner: Option<Box<(Preconditioning, Preconditioner)>>,
    /// Data that a solve leaves for the next one.
    pub kept: BetweenSolves,
    /// Data that a solve with friction leaves for the next one; none without friction.
    pub pairs: Option<Box<PairsBetween>>,
}

pub(super) struct Apart {
    /// The island in terms of the host's bodies, if its own bodies are pieces of them.
    pub whole: Option<Whole>,
    /// Its bodies on other ranks; empty if there are none.
    pub away: Box<[Option<Away>]>,
}

impl Ready {
    /// The island in terms of the host's bodies, if its own bodies are pieces of them.
    pub fn whole(&self) -> Option<&Whole> {
        self.apart.as_ref()?.whole.as_ref()
    }

    /// Body k, if another rank has it.
    pub fn away(&self, k: usize) -> Option<&Away> {
        self.apart.as_ref()?.away.get(k)?.as_ref()
    }

    /// The option of the present preconditioner.
    pub fn preconditioning(&self) -> Preconditioning {
        self.preconditioner.as_ref().map_or(Preconditioning::None, |made| made.0)
    }

    /// Threads for products with F, at most `threads`: one if a product costs less than waking others.
    pub fn product_threads(&self, threads: usize) -> usize {
        if self.dual.product_work() < PARALLEL_PAYS {
            1
        } else {
            threads
        }
    }

    /// `sum_p |B_p u_p|`, row by row.
    pub fn distances(
        &self,
        threads: usize,
        moved: &[Vec<f64>],
        x: &[f64],
        alpha: &[f64],
    ) -> Result<Vec<f64>> {
        let on_caller = |p: usize| self.dual.multiplies_on_caller(p);
        let in_parallel =
            |count, task: &(dyn Fn(usize) -> _ + Sync)| threads::run_apart(threads, count, on_caller, task);
        self.dual.distances(moved, x, alpha, &in_parallel)
    }

    /// A load where rows touch without `B'x`, through the rows and forces of the host: if these cancel, the result is exactly 0.
    pub fn without_forces(&self, x: &[f64], mut at_rows: Vec<f64>) -> Vec<f64> {
        let DualRows { scaled, scaling, .. } = &*self.rows;
        let forces = scaling.decoupling.solve_transposed(x.to_vec());
        scaled.mul_transposed_add(-1.0, &forces, &mut at_rows);
        at_rows
    }
}
