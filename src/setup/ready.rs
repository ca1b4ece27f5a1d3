//! The dual problem of an island, ready for any load and gap.

use std::sync::Arc;

use crate::dual::{Dual, Preconditioner};
use crate::error::Result;
use crate::linalg::vector::weighted_norm;
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
    /// `D~ / 2^p` over the unknowns.
    pub metric: Arc<ByBody>,
    /// The island in terms of the host's bodies, if its own bodies are pieces of them.
    pub whole: Option<Box<Whole>>,
    /// The preconditioner and its option.
    pub preconditioner: Option<Box<(Preconditioning, Preconditioner)>>,
    /// Data that a solve leaves for the next one.
    pub kept: BetweenSolves,
    /// Data that a solve with friction leaves for the next one; none without friction.
    pub pairs: Option<Box<PairsBetween>>,
}

impl Ready {
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

    /// `B_p K_p+ f_p` of every body.
    pub fn moved(&self, threads: usize, f: &ByBody) -> Result<Vec<Vec<f64>>> {
        self.dual.moved(f, &self.solving(threads))
    }

    /// Runs solves with K+ of every body.
    fn solving(
        &self,
        threads: usize,
    ) -> impl Fn(usize, &(dyn Fn(usize) -> Result<Vec<f64>> + Sync)) -> Result<Vec<Vec<f64>>> + '_ {
        let on_caller = |p: usize| self.dual.solves_on_caller(p);
        move |count, task| threads::run_apart(threads, count, on_caller, task)
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

    /// `K+ f`
    pub fn displacement(&self, threads: usize, f: &ByBody) -> Result<ByBody> {
        let bodies = self.dual.displacements(f, &self.solving(threads))?;
        ByBody::from_each(&self.island.ranges, bodies, "a displacement")
    }

    /// `|f|_{D^-1}` of every body, in units of 2^p.
    pub fn forces(&self, f: &ByBody) -> Vec<f64> {
        f.each().zip(self.metric.each()).map(|(f, metric)| weighted_norm(f, |j| 1.0 / metric[j])).collect()
    }

    /// `|u|_D` of body p.
    pub fn length(&self, p: usize, u: &[f64]) -> f64 {
        let metric = self.metric.on(p);
        weighted_norm(u, |j| metric[j])
    }

    /// `|u|_D`
    pub fn length_of_all(&self, u: &ByBody) -> f64 {
        let own: Vec<f64> = u.each().enumerate().map(|(p, u)| self.length(p, u)).collect();
        weighted_norm(&own, |_| 1.0)
    }

    /// `|f|_{D^-1}`
    pub fn force_of_all(&self, f: &ByBody) -> f64 {
        weighted_norm(&self.forces(f), |_| 1.0)
    }

    /// `R a`
    pub fn rigid_motion(&self, a: &[f64]) -> ByBody {
        let mut v = ByBody::of(&self.island.ranges, vec![0.0; self.island.unknowns()]);
        (0..self.dual.bodies()).for_each(|p| self.dual.add_rigid_motion(p, a, v.on_mut(p)));
        v
    }

    /// Subtracts `B'x` from a load, through the rows and forces of the host: if these cancel, the result is exactly 0.
    pub fn take_forces(&self, x: &[f64], load: &mut ByBody) {
        let DualRows { scaled, scaling, .. } = &*self.rows;
        let forces = scaling.decoupling.solve_transposed(x.to_vec());
        self.island.touched.change(load, |load| scaled.mul_transposed_add(-1.0, &forces, load));
    }
}
