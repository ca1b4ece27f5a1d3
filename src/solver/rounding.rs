//! What rounding of the loads explains in the gaps and the energies of an answer.
//!
//! f - B'lambda - H'mu is known to rounding of its terms, and u to rounding of what they would move. Where loads and
//! forces of the rows all but cancel, as in the last increments of Newton's method or where loads act on held dofs alone,
//! that is far more than u itself: its gaps and energies are lost, although every force is right to rounding.

use crate::error::Result;
use crate::linalg::memory::zeros;
use crate::linalg::vector::dot;
use crate::solver::certificate::{certify, metric, Answer, Certificate, Data};
use crate::solver::setup::Ready;

/// The certificate of an answer; where its gaps or energies alone fail, with the work of the loads in their noise.
pub fn certify_to_rounding(
    data: &mut Data,
    answer: Answer,
    ready: &Ready,
    threads: usize,
) -> Result<Certificate> {
    let certificate = certify(data, answer)?;
    if data.work_of_loads.is_some() || !certificate.only_motions_fail() {
        return Ok(certificate);
    }
    data.work_of_loads = Some(work_of_loads(data, answer.u.len(), ready, threads)?);
    certify(data, answer)
}

/// `sum_p (g'v)^2 / v'K v` of the loads g that balance themselves, force x length. For any motion v that is no more than
/// `g'K+ g`, the work of the load on the body alone: v = K+ g makes it large, but cannot make it wrong.
fn work_of_loads(data: &Data, unknowns: usize, ready: &Ready, threads: usize) -> Result<f64> {
    let mut load = zeros(unknowns, "the work of the loads")?;
    let metric = metric(data, unknowns);
    for body in &data.bodies {
        let range = body.start..body.start + body.stiffness.order();
        if let Some(f) = body.load {
            let resultants = body.null_space.mul_transposed(f);
            let rigid = &mut load[range.clone()];
            body.null_space.mul_add(-1.0 / body.unit, &resultants, rigid);
            rigid.iter_mut().zip(f).zip(&metric[range]).for_each(|((g, f), d)| *g = *f + d * *g);
        }
    }
    let motion = ready.displacement(threads, &load, &vec![0.0; ready.dual.modes()])?;
    let mut strain = zeros(unknowns, "the work of the loads")?;
    let mut work = 0.0;
    for body in &data.bodies {
        let range = body.start..body.start + body.stiffness.order();
        let (g, v, strain) = (&load[range.clone()], &motion[range.clone()], &mut strain[range]);
        body.stiffness.mul(v, strain)?;
        let (done, stored) = (dot(g, v), dot(v, strain));
        work += if stored > 0.0 { done * done / stored } else { 0.0 };
    }
    Ok(work)
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

    /// Free chains of n springs, the load on the first dof of the first, which a row holds; the second glued to its end.
    /// Nothing moves, and no row but the first carries a force.
    #[test]
    fn a_load_on_held_dofs_alone_is_certified() {
        for n in [2, 3, 9, 40, 1000] {
            for kind in [RowKind::Inequality, RowKind::Equality] {
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
                let mut load = vec![0.0; n];
                load[0] = -2.7;
                problem.set_load(0, &load).unwrap();
                let held = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[-1.0], rhs: None };
                problem.add_rows(kind, held).unwrap();
                let dof = [n as i64 - 1, n as i64];
                let glued = RowsInput { ptr: &[0, 2], body: None, dof: &dof, val: &[0.7, -0.7], rhs: None };
                problem.add_rows(RowKind::Equality, glued).unwrap();
                let report = problem.solve().unwrap();
                assert!(matches!(report.outcome, Outcome::Solved), "{n}: {:?}", report.certificate);
                let (lambda, mu) =
                    (problem.multipliers(RowKind::Inequality), problem.multipliers(RowKind::Equality));
                let (lambda, mu) = (lambda.unwrap().to_vec(), mu.unwrap().to_vec());
                assert!(
                    (lambda.iter().chain(&mu).sum::<f64>() - 2.7).abs() < 1e-10,
                    "{n}: {lambda:?} {mu:?}"
                );
                let moved = vec![-1e-6; 2 * n];
                assert!(!problem.check(&moved, &lambda, &mu).unwrap().passed(), "{n}");
            }
        }
    }

    /// A free spring moved by the equality row: nothing strains it, its forces are rounding.
    #[test]
    fn a_body_that_a_row_moves_without_load_is_certified() {
        let mut problem = Problem::new();
        problem.add_body(3).unwrap();
        let val = [3.1, -3.1, 6.57, -3.47, 3.47];
        let k = SparseInput { ptr: &[0, 1, 3, 5], col: &[0, 0, 1, 1, 2], val: &val, storage: Storage::Lower };
        problem.set_stiffness(0, k).unwrap();
        let row = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[1.0], rhs: Some(&[0.3]) };
        problem.add_rows(RowKind::Equality, row).unwrap();
        let report = problem.solve().unwrap();
        assert!(matches!(report.outcome, Outcome::Solved), "{:?}", report.certificate);
        assert!(!problem.check(&[0.3, 0.3, 0.30001], &[], &[0.0]).unwrap().passed());
    }
}
