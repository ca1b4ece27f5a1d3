//! Unknowns without stiffness: rotations of shells, orphan nodes, killed elements.

use std::sync::{Arc, Mutex};

use feti_contact::error::Kind;
use feti_contact::solver::{LogLevel, Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

/// Unit springs along a chain of `n` unknowns, fixed to the ground at the first, and `loose` empty unknowns after it.
fn chain(n: usize, loose: usize) -> Problem {
    let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
    for i in 0..n + loose {
        if i > 0 && i < n {
            col.push(i as i64 - 1);
            val.push(-1.0);
        }
        if i < n {
            col.push(i as i64);
            val.push(if i + 1 < n { 2.0 } else { 1.0 });
        }
        ptr.push(col.len());
    }
    let mut problem = Problem::new();
    problem.add_body(n + loose).unwrap();
    let input = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
    problem.set_stiffness(0, input).unwrap();
    problem
}

fn row(problem: &mut Problem, dof: i64, c: f64) {
    let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[dof], val: &[1.0], rhs: Some(&[c]) };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
}

fn load(problem: &mut Problem, n: usize, at: usize) {
    let mut f = vec![0.0; n];
    (f[4], f[at]) = (3.0, if at == 4 { 3.0 } else { 1.0 });
    problem.set_load(0, &f).unwrap();
}

#[test]
fn unknowns_without_stiffness_are_no_motions_and_are_told_in_one_line() {
    let mut problem = chain(5, 841);
    load(&mut problem, 846, 4);
    row(&mut problem, 4, 2.0);
    let lines = Arc::new(Mutex::new(Vec::new()));
    let heard = Arc::clone(&lines);
    problem.on_log(Some((
        LogLevel::Result,
        Box::new(move |_, line: &str| {
            heard.lock().unwrap().push(line.to_owned());
            0
        }),
    )));
    let report = problem.solve().unwrap();
    assert_eq!((report.outcome, report.undetermined), (Outcome::Solved, 0));
    assert!((problem.displacement(0).unwrap()[4] - 2.0).abs() < 1e-14);
    assert!(problem.displacement(0).unwrap()[5..].iter().all(|u| *u == 0.0));
    let told: Vec<String> =
        lines.lock().unwrap().iter().filter(|line| line.contains("no stiffness")).cloned().collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("841 unknowns"), "{told:?}");
    assert_eq!(problem.null_space(0).unwrap().0, 0);
}

#[test]
fn a_load_on_an_unknown_without_stiffness_is_not_held_also_if_it_comes_after_a_solve() {
    let mut problem = chain(5, 3);
    load(&mut problem, 8, 4);
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    load(&mut problem, 8, 6);
    let error = problem.solve().unwrap_err();
    assert_eq!((error.kind, error.place.body, error.place.dof), (Kind::LoadNotHeld, Some(0), Some(6)));
    assert_eq!(problem.escaping_motion(0).unwrap(), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    load(&mut problem, 8, 4);
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
}

#[test]
fn a_row_holds_a_load_on_an_unknown_without_stiffness() {
    let mut problem = chain(5, 3);
    row(&mut problem, 6, 0.25);
    load(&mut problem, 8, 6);
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    assert!((problem.multipliers(RowKind::Inequality).unwrap()[0] - 1.0).abs() < 1e-15);
    assert!((problem.displacement(0).unwrap()[6] - 0.25).abs() < 1e-15);
    let u = problem.displacements().unwrap().to_vec();
    assert!(problem.check(&u, &[1.0], &[]).unwrap().worst() <= 1.0);
    assert!(problem.check(&u, &[0.5], &[]).unwrap().worst() > 1.0);
}

#[test]
fn a_body_without_any_stiffness_rests() {
    let mut problem = chain(0, 3);
    let report = problem.solve().unwrap();
    assert_eq!(report.outcome, Outcome::Solved);
    assert_eq!(problem.displacement(0).unwrap(), [0.0; 3]);
}

/// An exact null space that names the empty unknowns, and one that does not.
#[test]
fn a_null_space_may_name_unknowns_without_stiffness_or_leave_them_out() {
    for r in [0, 3] {
        let mut problem = chain(5, 3);
        let basis: Vec<f64> =
            (0..3).flat_map(|j| (0..8).map(move |i| f64::from(u8::from(i == 5 + j)))).collect();
        problem.set_null_space(0, 8, r, &basis[..8 * r], 8, Modes::Exact).unwrap();
        load(&mut problem, 8, 4);
        row(&mut problem, 4, 2.0);
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved, "{r} vectors");
    }
}
