//! What loads and forces of rows move, by K+: for what rounding of the loads explains in an answer.

use std::cell::Cell;

use crate::certificate::{metric, Data, Response};
use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::vector::dot;
use crate::platform::memory::zeros;
use crate::solver::setup::Ready;

/// K+ of all bodies.
pub(super) struct ByInverse<'a> {
    pub data: &'a Data<'a>,
    pub ready: &'a Ready,
    pub threads: usize,
    /// V of these loads, force x length, once it has been asked for.
    pub work: &'a Cell<Option<f64>>,
}

impl Response for ByInverse<'_> {
    fn work_of_loads(&mut self) -> Result<f64> {
        if let Some(work) = self.work.get() {
            return Ok(work);
        }
        let mut load = zeros(self.unknowns(), "the work of the loads")?;
        for body in &self.data.bodies {
            let free = &mut load[body.range()];
            free.copy_from_slice(body.load.unwrap_or(&vec![0.0; free.len()]));
            body.grounded.iter().for_each(|j| free[*j as usize] = 0.0);
        }
        let work = self.work_of(load)?;
        self.work.set(Some(work));
        Ok(work)
    }

    fn compliance_of(&mut self, kind: RowKind, row: usize) -> Result<f64> {
        let rows = match kind {
            RowKind::Inequality => self.data.contact,
            RowKind::Equality => self.data.equalities,
        };
        let mut force = zeros(self.unknowns(), "the force of a row")?;
        rows.matrix.row(row).for_each(|(j, b)| force[j] = b);
        self.work_of(force)
    }
}

impl ByInverse<'_> {
    fn unknowns(&self) -> usize {
        self.data.bodies.last().map_or(0, |body| body.start + body.stiffness.order())
    }

    /// `sum_p (g'v)^2 / v'K v` of the part `g = f - D R R'f / unit` of a load f, n, that balances itself. For any motion v that is
    /// no more than `g'K+ g`, the work of the load on the body alone: v = K+ g makes it large, but cannot make it wrong.
    fn work_of(&self, mut load: Vec<f64>) -> Result<f64> {
        let metric = metric(self.data, load.len());
        for body in &self.data.bodies {
            let range = body.range();
            let resultants = body.null_space.mul_transposed(&load[range.clone()]);
            let mut rigid = zeros(range.len(), "the work of a load")?;
            body.null_space.mul_add(1.0 / body.unit, &resultants, &mut rigid);
            range.for_each(|j| load[j] -= metric[j] * rigid[j - body.start]);
        }
        let motion = self.ready.displacement(self.threads, &load)?;
        let mut work = 0.0;
        for body in &self.data.bodies {
            let range = body.range();
            let (g, v) = (&load[range.clone()], &motion[range.clone()]);
            let mut strain = zeros(range.len(), "the work of a load")?;
            body.stiffness.mul(v, &mut strain)?;
            let (done, stored) = (dot(g, v), dot(v, &strain));
            work += if stored > 0.0 { done * (done / stored) } else { 0.0 };
        }
        Ok(work)
    }
}

#[cfg(test)]
mod tests {
    use crate::solver::{Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

    /// A chain of n springs 1, its first end held, pushed by 1 at the other against an obstacle `1e-12` away: the load alone
    /// would move it by n, so that rounding of load and contact force moves it by n eps, far more than what the last
    /// unknown alone gives way, eps / 2.
    #[test]
    fn a_soft_body_between_load_and_obstacle_is_certified_to_the_rounding_of_their_forces() {
        let n = 4000;
        let mut problem = Problem::new();
        let body = problem.add_body(n).unwrap();
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n {
            if i > 0 {
                col.push(i as i64 - 1);
                val.push(-1.0);
            }
            col.push(i as i64);
            val.push(if i + 1 < n { 2.0 } else { 1.0 });
            ptr.push(col.len());
        }
        let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
        let mut load = vec![0.0; n];
        load[n - 1] = 1.0;
        problem.set_load(body, &load).unwrap();
        let (dof, gap) = ([n as i64 - 1], [1e-12]);
        let row = RowsInput { ptr: &[0, 1], body: None, dof: &dof, val: &[1.0], rhs: Some(&gap) };
        problem.add_rows(RowKind::Inequality, row).unwrap();
        let report = problem.solve().unwrap();
        assert!(matches!(report.outcome, Outcome::Solved), "{:?}", report.certificate);
        let mut u = problem.displacement(body).unwrap().to_vec();
        let lambda = problem.multipliers(RowKind::Inequality).unwrap().to_vec();
        assert!((lambda[0] - 1.0).abs() <= 1e-13 && (u[n - 1] - 1e-12).abs() <= 1e-10);
        u[n - 1] += 1e-7;
        assert!(!problem.check(&u, &lambda, &[]).unwrap().passed());
    }

    /// Two free chains of n springs, the second glued to the end of the first.
    fn chains(n: usize) -> Problem {
        let mut problem = Problem::new();
        let ptr: Vec<usize> = (0..=n).map(|i| if i == 0 { 0 } else { 2 * i - 1 }).collect();
        let stiffness = |i: usize| 3.1 + 0.37 * i as f64;
        let (mut col, mut val) = (Vec::new(), Vec::new());
        for i in 0..n {
            let left = if i > 0 { stiffness(i - 1) } else { 0.0 };
            if i > 0 {
                col.push(i as i64 - 1);
                val.push(-left);
            }
            col.push(i as i64);
            val.push(left + if i + 1 < n { stiffness(i) } else { 0.0 });
        }
        for body in 0..2 {
            problem.add_body(n).unwrap();
            let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
            problem.set_stiffness(body, k).unwrap();
            problem.set_null_space(body, n, 1, &vec![1.0; n], n, Modes::Exact).unwrap();
        }
        let dof = [n as i64 - 1, n as i64];
        let glued = RowsInput { ptr: &[0, 2], body: None, dof: &dof, val: &[0.7, -0.7], rhs: None };
        problem.add_rows(RowKind::Equality, glued).unwrap();
        problem
    }

    /// The answer and whether it passes; nothing passes that is moved by `1e-6` of the motion.
    fn forces_of_a_certified_answer(problem: &mut Problem, motion: f64) -> (Vec<f64>, Vec<f64>) {
        let report = problem.solve().unwrap();
        assert!(matches!(report.outcome, Outcome::Solved), "{:?}", report.certificate);
        let mut u = problem.displacements().unwrap().to_vec();
        let [lambda, mu] =
            [RowKind::Inequality, RowKind::Equality].map(|kind| problem.multipliers(kind).unwrap().to_vec());
        assert!(problem.check(&u, &lambda, &mu).unwrap().passed());
        u[0] -= 1e-6 * motion;
        assert!(!problem.check(&u, &lambda, &mu).unwrap().passed());
        (lambda, mu)
    }

    /// The load acts on the first dof of the first chain, which a row holds: nothing moves, no row but that carries a force.
    #[test]
    fn a_load_on_held_dofs_alone_is_certified() {
        for n in [2, 3, 9, 40, 1000] {
            for kind in [RowKind::Inequality, RowKind::Equality] {
                let mut problem = chains(n);
                let mut load = vec![0.0; n];
                load[0] = -2.7;
                problem.set_load(0, &load).unwrap();
                let held = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[-1.0], rhs: None };
                problem.add_rows(kind, held).unwrap();
                let (lambda, mu) = forces_of_a_certified_answer(&mut problem, 1.0);
                assert!(
                    (lambda.iter().chain(&mu).sum::<f64>() - 2.7).abs() < 1e-10,
                    "{n}: {lambda:?} {mu:?}"
                );
            }
        }
    }

    /// Two obstacles overlap with the chains at rest, or their end is moved: they move as one, without a force.
    #[test]
    fn bodies_that_are_moved_without_load_are_certified() {
        for n in [2, 3, 9, 40, 200] {
            for kind in [RowKind::Inequality, RowKind::Equality] {
                let mut problem = chains(n);
                let moved =
                    RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[-1.0], rhs: Some(&[-0.123]) };
                problem.add_rows(kind, moved).unwrap();
                let (lambda, mu) = forces_of_a_certified_answer(&mut problem, 0.123);
                assert!(lambda.iter().chain(&mu).all(|force| force.abs() < 1e-10), "{n}: {lambda:?} {mu:?}");
                assert!((problem.displacements().unwrap()[2 * n - 1] - 0.123).abs() < 1e-12);
            }
        }
    }
}
