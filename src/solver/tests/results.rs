//! Results that are read after a solve.

use crate::error::Kind;
use crate::solver::{Outcome, Problem, RowKind, RowState, RowsInput, SparseInput, Storage};

/// Two springs 1 against walls at 1.
fn two_springs() -> Problem {
    let mut problem = Problem::new();
    for _ in 0..2 {
        let body = problem.add_body(1).unwrap();
        let k = SparseInput { ptr: &[0, 1], col: &[0], val: &[1.0], storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
    }
    let walls = RowsInput { ptr: &[0, 1, 2], body: None, dof: &[0, 1], val: &[1.0; 2], rhs: Some(&[1.0; 2]) };
    problem.add_rows(RowKind::Inequality, walls).unwrap();
    problem
}

/// The options require another setup, or one that exceeds the memory limit.
#[test]
fn an_answer_outlives_the_check_of_another_under_other_options() {
    let mut problem = two_springs();
    problem.set_load(0, &[3.0]).unwrap();
    problem.solve().unwrap();
    let answer = problem.displacements().unwrap().to_vec();
    problem.set_str("method", "paper-feasible").unwrap();
    problem.set_i64("memory_limit", 1).unwrap();
    assert!(problem.check(&answer, &[2.0, 0.0], &[]).unwrap().passed());
    assert!(!problem.check(&answer, &[0.0, 0.0], &[]).unwrap().passed());
    assert_eq!(problem.displacements().unwrap(), answer);
    assert_eq!(problem.solve().unwrap_err().kind, Kind::Memory);
}

/// The second spring touches nothing: it has neither forces nor violations.
#[test]
fn the_error_of_the_forces_on_a_body_is_known_with_an_answer() {
    let mut problem = two_springs();
    problem.set_load(0, &[3.0]).unwrap();
    assert_eq!(problem.body_facts(0).unwrap().force_error, None);
    problem.solve().unwrap();
    assert!(problem.body_facts(0).unwrap().force_error.is_some_and(|error| error <= 1e-12));
    assert_eq!(problem.body_facts(1).unwrap().force_error, Some(0.0));
    assert_eq!(problem.active().unwrap(), [RowState::Closed, RowState::Open]);
}

/// Loads 3 and 2, then 5 and 2.
#[test]
fn the_force_on_a_body_is_that_of_the_present_answer_and_of_the_kind_asked_for() {
    let mut problem = two_springs();
    let reaction = |problem: &mut Problem, kind, body| {
        let mut r = [7.0];
        problem.reaction(kind, body, &mut r).map(|()| r[0])
    };
    let (all, contact, ties) = (None, Some(RowKind::Inequality), Some(RowKind::Equality));
    assert_eq!(reaction(&mut problem, all, 0).unwrap_err().kind, Kind::State);
    for load in [3.0, 5.0] {
        problem.set_load(0, &[load]).unwrap();
        problem.set_load(1, &[2.0]).unwrap();
        problem.solve().unwrap();
        for (kind, expected) in [(all, [1.0 - load, -1.0]), (ties, [0.0; 2]), (contact, [1.0 - load, -1.0])] {
            for body in [0, 1] {
                let found = reaction(&mut problem, kind, body).unwrap();
                assert!((found - expected[body]).abs() < 1e-12, "{kind:?} {body}: {found}");
            }
        }
    }
}

#[test]
fn a_method_that_nobody_has_offered_is_refused() {
    let mut problem = two_springs();
    problem.set_load(0, &[3.0]).unwrap();
    problem.set_str("method", "paper-monotone").unwrap();
    let error = problem.solve().unwrap_err();
    assert_eq!((error.kind, error.to_string().contains("method")), (Kind::State, true));
    problem.set_str("method", "proportioning").unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
}
