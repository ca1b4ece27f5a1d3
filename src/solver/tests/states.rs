//! Saved states.

use crate::error::Kind;
use crate::solver::{Problem, RowKind, RowsInput, SparseInput, Storage};

/// Two unknowns with a spring between them, pushed against a wall.
#[test]
fn a_restored_answer_has_its_setup_or_is_none() {
    let mut problem = Problem::new();
    let body = problem.add_body(2).unwrap();
    let (ptr, col, val) = ([0, 1, 3], [0, 0, 1], [1.0, -1.0, 1.0]);
    let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
    problem.set_stiffness(body, k).unwrap();
    problem.set_load(body, &[2.0, 0.5]).unwrap();
    let wall = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[1.0], rhs: Some(&[1.0]) };
    problem.add_rows(RowKind::Inequality, wall).unwrap();
    problem.solve().unwrap();
    let (state, amplitudes) = (problem.save_state().unwrap(), problem.amplitudes(body).unwrap().to_vec());
    problem.clear_rows(RowKind::Inequality);
    problem.add_rows(RowKind::Inequality, wall).unwrap();
    problem.restore_state(state).unwrap();
    assert_eq!(problem.amplitudes(body).unwrap_err().kind, Kind::State);
    problem.setup().unwrap();
    problem.restore_state(state).unwrap();
    assert_eq!(problem.amplitudes(body).unwrap(), amplitudes);
}
