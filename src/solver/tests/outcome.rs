//! How a solve ends.

use crate::error::Kind;
use crate::solver::{Modes, Outcome, Problem, RowKind, RowState, RowsInput, SparseInput, Storage};

/// Two independent springs pushed against walls; the limit of steps stops the second.
#[test]
fn the_group_that_ended_worst_is_named_where_there_are_several() {
    for bodies in [1, 2] {
        let mut problem = Problem::new();
        for p in 0..bodies {
            let body = problem.add_body(2).unwrap();
            let k = SparseInput {
                ptr: &[0, 1, 3],
                col: &[0, 0, 1],
                val: &[2.0, -1.0, 2.0],
                storage: Storage::Lower,
            };
            problem.set_stiffness(body, k).unwrap();
            problem.set_null_space(body, 2, 0, &[], 2, Modes::Exact).unwrap();
            problem.set_load(body, &[3.0, if p + 1 < bodies { -5.0 } else { 4.0 }]).unwrap();
            let first = 2 * p as i64;
            let dof = [first, first + 1];
            let walls = RowsInput {
                ptr: &[0, 1, 2],
                body: None,
                dof: &dof,
                val: &[1.0, 1.5],
                rhs: Some(&[1.0, 0.7]),
            };
            problem.add_rows(RowKind::Inequality, walls).unwrap();
        }
        problem.set_i64("max_steps", 1).unwrap();
        problem.set_i64("direct_limit", 0).unwrap();
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Iterations);
        assert_eq!(report.body, (bodies == 2).then_some(1));
        assert_eq!(problem.findings().unwrap().place.body, report.body);
    }
}

/// A free spring, pulled.
#[test]
fn it_is_said_that_nothing_holds_the_load() {
    let mut problem = Problem::new();
    let body = problem.add_body(2).unwrap();
    let k = SparseInput { ptr: &[0, 1, 3], col: &[0, 0, 1], val: &[1.0, -1.0, 1.0], storage: Storage::Lower };
    problem.set_stiffness(body, k).unwrap();
    problem.set_load(body, &[1.0, 1.0]).unwrap();
    assert_eq!(problem.solve().unwrap_err().kind, Kind::LoadNotHeld, "no row");
    let row = RowsInput { ptr: &[0, 1], body: None, dof: &[1], val: &[-1.0], rhs: None };
    problem.add_rows(RowKind::Inequality, row).unwrap();
    assert_eq!(problem.solve().unwrap_err().kind, Kind::LoadNotHeld, "the wrong side");
}

/// One body of springs 1 that are not coupled; contact rows as (entries, gap).
fn springs(load: &[f64], rows: &[(&[(i64, f64)], f64)], kind: RowKind) -> Problem {
    let mut problem = Problem::new();
    let n = load.len();
    let (ptr, col): (Vec<usize>, Vec<i64>) = ((0..=n).collect(), (0..n as i64).collect());
    problem.add_body(n).unwrap();
    let k = SparseInput { ptr: &ptr, col: &col, val: &vec![1.0; n], storage: Storage::Lower };
    problem.set_stiffness(0, k).unwrap();
    problem.set_load(0, load).unwrap();
    for (entries, rhs) in rows {
        let (dof, val): (Vec<i64>, Vec<f64>) = entries.iter().copied().unzip();
        let row = RowsInput { ptr: &[0, dof.len()], body: None, dof: &dof, val: &val, rhs: Some(&[*rhs]) };
        problem.add_rows(kind, row).unwrap();
    }
    problem
}

#[test]
fn parallel_equality_rows_may_differ_by_rounding_alone() {
    for (second, contradicts) in [(1.0 + 1e-12, false), (1.0 + 1e-9, true)] {
        let row: &[(i64, f64)] = &[(0, 1.0)];
        let ended = springs(&[3.0], &[(row, 1.0), (row, second)], RowKind::Equality).solve();
        assert_eq!(ended.is_err_and(|error| error.kind == Kind::GapsContradict), contradicts, "{second}");
    }
}

/// -u1 - 1e-4 u2 <= -1 and u1 <= 0: the nearest displacement is (0, 1e4).
#[test]
fn rows_that_a_displacement_of_1e4_times_their_gaps_satisfies_contradict_nothing() {
    let rows: [(&[(i64, f64)], f64); 2] = [(&[(0, -1.0), (1, -1e-4)], -1.0), (&[(0, 1.0)], 0.0)];
    let mut problem = springs(&[0.0, 0.0], &rows, RowKind::Inequality);
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let u = problem.displacement(0).unwrap();
    assert!(u[0].abs() < 1e-6 && (u[1] - 1e4).abs() < 1e-3, "{u:?}");
}

/// A mass without stiffness is pushed against a wall by 1e-10 of the load on the adjacent spring.
#[test]
fn a_force_of_1e_10_of_those_on_its_body_holds_a_motion() {
    let mut problem = Problem::new();
    problem.add_body(2).unwrap();
    let k = SparseInput { ptr: &[0, 0, 1], col: &[1], val: &[1.0], storage: Storage::Lower };
    problem.set_stiffness(0, k).unwrap();
    problem.set_load(0, &[1e-10, 1.0]).unwrap();
    let wall = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[1.0], rhs: Some(&[0.5]) };
    problem.add_rows(RowKind::Inequality, wall).unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    assert_eq!((problem.displacement(0).unwrap()[0], problem.active().unwrap()[0]), (0.5, RowState::Closed));
    assert!(problem.open_motion(0).is_err(), "the wall holds it");
}
