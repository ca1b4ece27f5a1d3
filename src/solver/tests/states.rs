//! Saved states.

use crate::error::Kind;
use crate::solver::{Problem, RowKind, RowsInput, SparseInput, Storage};

const WALL: RowsInput<'static> =
    RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[1.0], rhs: Some(&[1.0]) };

fn set_spring(problem: &mut Problem, stiffness: f64) {
    let val = [1.0, -1.0, 1.0].map(|v| stiffness * v);
    let k = SparseInput { ptr: &[0, 1, 3], col: &[0, 0, 1], val: &val, storage: Storage::Lower };
    problem.set_stiffness(0, k).unwrap();
}

/// Two unknowns with a spring between them, pushed against a wall, and the saved state of the answer.
fn pushed() -> (Problem, usize) {
    let mut problem = Problem::new();
    problem.add_body(2).unwrap();
    set_spring(&mut problem, 1.0);
    problem.set_load(0, &[2.0, 0.5]).unwrap();
    problem.add_rows(RowKind::Inequality, WALL).unwrap();
    problem.solve().unwrap();
    let state = problem.save_state().unwrap();
    (problem, state)
}

#[test]
fn a_restored_answer_has_its_setup_or_is_none() {
    let (mut problem, state) = pushed();
    let amplitudes = problem.amplitudes(0).unwrap().to_vec();
    problem.clear_rows(RowKind::Inequality);
    problem.add_rows(RowKind::Inequality, WALL).unwrap();
    problem.restore_state(state).unwrap();
    assert_eq!(problem.amplitudes(0).unwrap_err().kind, Kind::State);
    problem.setup().unwrap();
    problem.restore_state(state).unwrap();
    assert_eq!(problem.amplitudes(0).unwrap(), amplitudes);
}

#[test]
fn an_answer_for_another_matrix_is_not_restored() {
    let (mut problem, state) = pushed();
    set_spring(&mut problem, 2.0);
    problem.solve().unwrap();
    problem.restore_state(state).unwrap();
    assert_eq!(problem.displacement(0).unwrap_err().kind, Kind::State);
    assert!(problem.report().is_none());
}

/// Data that are equal bit by bit need no new factor, but the call that sets them still drops the answer.
#[test]
fn what_a_call_brings_is_new_to_the_answer_and_only_what_differs_to_the_factor() {
    let (mut problem, _) = pushed();
    for (stiffness, factorisations) in [(1.0, 1), (3.0, 2), (3.0, 2)] {
        set_spring(&mut problem, stiffness);
        assert_eq!(problem.displacement(0).unwrap_err().kind, Kind::State);
        problem.solve().unwrap();
        assert_eq!(problem.work().factorisations, factorisations, "{stiffness}");
        assert_eq!(problem.displacement(0).unwrap()[0], 1.0);
    }
}
