//! Nodes with friction from one load step to the next: commit, saved states, starts.
//!
//! A block on springs, K = diag(2, 2), is pressed by 4 against a wall, row 0, and pushed along it by 1: it sticks. Node 1 has a
//! contact row that never closes, and follows its unknown.

use std::sync::Arc;

use crate::error::Kind;
use crate::solver::{FrictionInput, Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

const LOAD: [f64; 2] = [1.0, 4.0];

fn block() -> Problem {
    let mut problem = Problem::new();
    for body in 0..2 {
        problem.add_body(2).unwrap();
        let k = SparseInput { ptr: &[0, 1, 2], col: &[0, 1], val: &[2.0, 2.0], storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
        problem.set_null_space(body, 2, 0, &[], 2, Modes::Exact).unwrap();
        problem.set_load(body, &LOAD).unwrap();
    }
    let rows = |dof, rhs| RowsInput { ptr: &[0, 1, 2], body: None, dof, val: &[1.0, 1.0], rhs };
    problem.add_rows(RowKind::Inequality, rows(&[1, 3], Some(&[0.0, f64::INFINITY]))).unwrap();
    let nodes = FrictionInput {
        dim: 1,
        normal: &[0, 1],
        rows: rows(&[0, 2], None),
        coefficient: Some(&[0.5, 0.5]),
        bound: None,
    };
    problem.add_friction(nodes).unwrap();
    problem
}

fn near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}, not {expected:?}");
}

fn s_old(problem: &Problem) -> &[f64] {
    &problem.model.friction.rows.rhs
}

/// With s_old = 1/4 and C_t = 1/2: u - 1/4 = lambda_t / 2 and lambda_t = 1 - 2 u give u = 3/8, lambda_t = 1/4.
#[test]
fn a_commit_takes_what_was_reached_at_open_nodes_too_and_leaves_the_answer() {
    let mut problem = block();
    problem.set_friction_compliance(0, &[0.5, 0.5]).unwrap();
    problem.set_friction_reference(0, 2, 1, &[0.25, 0.125]).unwrap();
    assert_eq!(problem.commit_friction().unwrap_err().kind, Kind::State);
    problem.solve().unwrap();
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[0.25, 0.0]);
    near(problem.displacement(0).unwrap(), &[0.375, 0.0]);
    near(problem.slips().unwrap(), &[0.0, 0.375]);
    near(s_old(&problem), &[0.25, 0.125]);
    let slips = problem.slips().unwrap().to_vec();
    problem.commit_friction().unwrap();
    near(s_old(&problem), &[0.25, 0.5]);
    assert_eq!(problem.slips().unwrap(), slips, "those of the step that has ended");
    let committed = s_old(&problem).to_vec();
    problem.set_load(0, &[0.5, 4.0]).unwrap();
    problem.set_friction_reference(0, 2, 1, &[7.0, 7.0]).unwrap();
    problem.commit_friction().unwrap();
    assert_eq!(s_old(&problem), committed, "of the answer, whatever has been given since");
    problem.set_friction_compliance(0, &[0.25]).unwrap();
    assert_eq!(problem.commit_friction().unwrap_err().kind, Kind::State);
    problem.solve().unwrap();
    near(problem.slips().unwrap(), &[0.0, 0.0]);
}

#[test]
fn only_a_certified_answer_is_committed() {
    let mut problem = block();
    problem.set_friction_compliance(0, &[0.5, 0.5]).unwrap();
    problem.set_friction_reference(0, 2, 1, &[0.25, 0.125]).unwrap();
    problem.solve().unwrap();
    problem.history().previous = None;
    for (outcome, is_certified) in [
        (Outcome::Inaccurate, false),
        (Outcome::Stalled, false),
        (Outcome::Iterations, false),
        (Outcome::Time, false),
        (Outcome::Cancelled, false),
        (Outcome::Marginal, true),
    ] {
        let answer = &mut problem.history.current.as_mut().unwrap().answer;
        Arc::get_mut(answer).unwrap().report.outcome = outcome;
        let committed = problem.commit_friction();
        assert_eq!(committed.is_ok(), is_certified, "{outcome:?}");
        assert!(is_certified || committed.unwrap_err().kind == Kind::State);
        assert_eq!(s_old(&problem)[1] == 0.125, !is_certified, "{outcome:?}");
    }
}

/// A separate body that nothing holds: its group has no answer, the block has one.
#[test]
fn nothing_is_committed_where_a_group_has_no_answer() {
    let mut problem = block();
    problem.add_body(1).unwrap();
    let k = SparseInput { ptr: &[0, 1], col: &[0], val: &[0.0], storage: Storage::Lower };
    problem.set_stiffness(2, k).unwrap();
    problem.set_null_space(2, 1, 1, &[1.0], 1, Modes::Exact).unwrap();
    problem.set_load(2, &[1.0]).unwrap();
    problem.solve().unwrap_err();
    near(problem.displacement(0).unwrap(), &[0.0, 0.0]);
    assert_eq!(problem.commit_friction().unwrap_err().kind, Kind::State);
    assert_eq!(s_old(&problem), [0.0, 0.0]);
}

#[test]
fn a_restored_state_has_its_laws_its_references_and_its_answer() {
    let mut problem = block();
    problem.set_friction_reference(0, 2, 1, &[0.25, 0.0]).unwrap();
    problem.solve().unwrap();
    let forces = problem.multipliers(RowKind::Tangential).unwrap().to_vec();
    let slips = problem.slips().unwrap().to_vec();
    let state = problem.save_state().unwrap();
    problem.commit_friction().unwrap();
    problem.set_friction_law(0, 2, Some(&[0.75, 0.75]), None).unwrap();
    problem.set_load(0, &[1.5, 4.0]).unwrap();
    problem.solve().unwrap();
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[1.0, 0.0]);
    problem.restore_state(state).unwrap();
    assert_eq!(s_old(&problem), [0.25, 0.0]);
    assert_eq!(problem.model.friction.nodes[1].coefficient, 0.5);
    assert_eq!(problem.multipliers(RowKind::Tangential).unwrap(), forces);
    assert_eq!(problem.slips().unwrap(), slips);
    problem.solve().unwrap();
    assert_eq!(problem.multipliers(RowKind::Tangential).unwrap(), forces, "cold, the bits of then");
}

#[test]
fn an_answer_for_other_nodes_is_not_restored_and_the_nodes_are() {
    let mut problem = block();
    problem.solve().unwrap();
    let state = problem.save_state().unwrap();
    problem.clear_friction();
    assert_eq!(problem.slips().unwrap_err().kind, Kind::State);
    problem.solve().unwrap();
    near(problem.displacement(0).unwrap(), &[0.5, 0.0]);
    problem.restore_state(state).unwrap();
    assert_eq!(problem.slips().unwrap_err().kind, Kind::State);
    assert_eq!((problem.sizes().nodes, problem.sizes().tangential), (2, 2));
    problem.solve().unwrap();
    near(problem.displacement(0).unwrap(), &[0.0, 0.0]);
    // a friction bound at the node without contact: it acts, and was included in the setup
    let state = problem.save_state().unwrap();
    problem.set_friction_law(1, 1, None, Some(&[8.0])).unwrap();
    assert_eq!(problem.slips().unwrap_err().kind, Kind::State);
    problem.solve().unwrap();
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[1.0, 1.0]);
    problem.restore_state(state).unwrap();
    assert_eq!(problem.slips().unwrap_err().kind, Kind::State);
    problem.solve().unwrap();
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[1.0, 0.0]);
}

#[test]
fn a_start_with_tangential_forces_is_used_up_and_dropped_with_the_nodes() {
    let mut problem = block();
    let error = problem.start_from(RowKind::Tangential, &[1.0]).unwrap_err();
    assert_eq!((error.kind, error.place.limit), (Kind::Argument("rows"), Some(2.0)));
    problem.start_from(RowKind::Tangential, &[1.0, 0.0]).unwrap();
    problem.start_from(RowKind::Inequality, &[4.0, 0.0]).unwrap();
    problem.solve().unwrap();
    assert!(problem.history().start.iter().all(Option::is_none));
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[1.0, 0.0]);
    problem.start_from(RowKind::Tangential, &[1.0, 0.0]).unwrap();
    problem.clear_friction();
    assert!(problem.history().start.iter().all(Option::is_none));
}

#[test]
fn the_operators_to_validate_are_those_of_the_other_rows() {
    let mut problem = block();
    let (mut image, mut rhs) = ([9.0; 2], [9.0; 2]);
    problem.dual_apply(&[3.0, 5.0], &mut image).unwrap();
    near(&image, &[1.5, 0.0]);
    problem.dual_rhs(&mut rhs).unwrap();
    near(&rhs[..1], &[2.0]);
    assert_eq!(rhs[1], f64::NEG_INFINITY);
}
