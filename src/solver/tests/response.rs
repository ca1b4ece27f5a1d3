//! Answers that pass within the rounding of their loads.

use crate::solver::{Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

/// A chain of n springs 1, its first end held, pushed by 1 at the other end against an obstacle `1e-12` away: the load
/// alone would move it by n, so rounding of load and contact force moves it by n eps, far more than the displacement eps
/// / 2 of the last unknown alone.
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

/// The answer and whether it passes; no answer passes that is moved by `1e-6` of the motion.
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

/// The load acts on the first dof of the first chain, which a row holds: nothing moves, and only that row carries a
/// force.
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
            assert!((lambda.iter().chain(&mu).sum::<f64>() - 2.7).abs() < 1e-10, "{n}: {lambda:?} {mu:?}");
        }
    }
}

/// Two obstacles overlap with the chains at rest, or their end is moved: the chains move together, without a force.
#[test]
fn bodies_that_are_moved_without_load_are_certified() {
    for n in [2, 3, 9, 40, 200] {
        for kind in [RowKind::Inequality, RowKind::Equality] {
            let mut problem = chains(n);
            let moved = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[-1.0], rhs: Some(&[-0.123]) };
            problem.add_rows(kind, moved).unwrap();
            let (lambda, mu) = forces_of_a_certified_answer(&mut problem, 0.123);
            assert!(lambda.iter().chain(&mu).all(|force| force.abs() < 1e-10), "{n}: {lambda:?} {mu:?}");
            assert!((problem.displacements().unwrap()[2 * n - 1] - 0.123).abs() < 1e-12);
        }
    }
}
