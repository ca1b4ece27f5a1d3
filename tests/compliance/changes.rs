//! The compliance of a problem that has been solved: what it discards and what it keeps.

use decks::{Cube, Deck, Stack};
use feti_contact::error::Kind;
use feti_contact::solver::{Problem, RowKind};

use crate::compliance::{answer, answer_of, assert_near, solved};
use crate::support::hand_over;

fn stack() -> Deck {
    Stack { in_plane: vec![4, 3], layers: vec![1], noise: 0.1, ..Stack::default() }.build()
}

fn set(problem: &mut Problem, inv_k: f64) {
    let rows = problem.sizes().rows;
    problem.set_compliance(RowKind::Inequality, 0, &vec![inv_k; rows]).unwrap();
}

#[test]
fn rows_made_rigid_again_give_the_bits_of_rigid_rows_and_nothing_is_factorised_anew() {
    let deck = stack();
    let mut problem = hand_over::problem(&deck).unwrap();
    let factorisations = solved(&mut problem, "rigid").work.factorisations;
    let rigid = answer(&problem);
    set(&mut problem, 0.5);
    assert_eq!(problem.displacement(0).unwrap_err().kind, Kind::State, "the answer of rigid rows is gone");
    solved(&mut problem, "compliant");
    let compliant = answer(&problem);
    assert_ne!(compliant, rigid);
    set(&mut problem, 0.0);
    assert_eq!(solved(&mut problem, "rigid again").work.factorisations, factorisations);
    assert_eq!(answer(&problem), rigid);
    let mut anew = deck.clone();
    anew.contact.compliance.fill(0.5);
    assert_eq!(answer_of(&anew), compliant, "before the first solve or after it");
}

/// A spring 1e10 times as stiff as the bodies is all but rigid.
#[test]
fn stiffer_and_stiffer_springs_approach_rigid_rows() {
    let deck = stack();
    let rigid = answer_of(&deck);
    let mut problem = hand_over::problem(&deck).unwrap();
    for (inv_k, tolerance) in [(1e-6, 1e-4), (1e-8, 1e-6), (1e-10, 1e-8)] {
        set(&mut problem, inv_k);
        solved(&mut problem, "stiff");
        let [u, lambda, _] = answer(&problem);
        assert_near(&u, &rigid[0], tolerance, "u");
        assert_near(&lambda, &rigid[1], tolerance, "lambda");
    }
}

#[test]
fn rows_times_t_with_compliance_times_t_squared_carry_forces_divided_by_t() {
    let mut deck = Cube { layer: 0.4, elements: 2, ..Cube::default() }.build();
    deck.equalities.compliance.iter_mut().step_by(2).for_each(|inv_k| *inv_k = 0.7);
    let [u, lambda, mu] = answer_of(&deck);
    for t in [8.0, 1e-3, 210_000.0] {
        let mut scaled = deck.clone();
        for rows in [&mut scaled.contact, &mut scaled.equalities] {
            rows.matrix.val.iter_mut().for_each(|v| *v *= t);
            rows.rhs.iter_mut().for_each(|c| *c *= t);
            rows.compliance.iter_mut().for_each(|inv_k| *inv_k *= t * t);
        }
        let found = answer_of(&scaled);
        let by = |forces: &[f64]| -> Vec<f64> { forces.iter().map(|l| l / t).collect() };
        let tolerance = if t == 8.0 { 0.0 } else { 1e-10 };
        assert_near(&found[0], &u, tolerance, "u");
        assert_near(&found[1], &by(&lambda), tolerance, "lambda");
        assert_near(&found[2], &by(&mu), tolerance, "mu");
    }
}

/// Compliance belongs to the rows, and rows to the state.
#[test]
fn a_saved_state_brings_back_the_compliance_of_its_rows() {
    let mut problem = hand_over::problem(&stack()).unwrap();
    solved(&mut problem, "rigid");
    let rigid = answer(&problem);
    let state = problem.save_state().unwrap();
    set(&mut problem, 0.5);
    solved(&mut problem, "compliant");
    assert_ne!(answer(&problem), rigid, "springs move the answer");
    problem.restore_state(state).unwrap();
    assert_eq!(problem.displacement(0).unwrap_err().kind, Kind::State);
    solved(&mut problem, "restored");
    assert_eq!(answer(&problem), rigid);
}

#[test]
fn a_warm_start_from_the_answer_takes_no_step_and_one_from_other_springs_fewer_than_a_cold_one() {
    let mut deck = Cube { layer: 0.4, elements: 3, ..Cube::default() }.build();
    deck.equalities.compliance.iter_mut().step_by(3).for_each(|inv_k| *inv_k = 0.7);
    let mut problem = hand_over::problem(&deck).unwrap();
    let cold = solved(&mut problem, "cold");
    let first = answer(&problem);
    problem.set_str("start", "previous").unwrap();
    let again = solved(&mut problem, "from the answer");
    assert!(again.counts.steps() <= 1, "{} steps, cold {}", again.counts.steps(), cold.counts.steps());
    assert_near(&answer(&problem)[1], &first[1], 1e-10, "lambda");
    problem.set_compliance(RowKind::Inequality, 0, &scaled(&deck.contact.compliance, 1.001)).unwrap();
    let warm = solved(&mut problem, "from other springs");
    assert!(
        warm.counts.steps() < cold.counts.steps(),
        "{} steps, cold {}",
        warm.counts.steps(),
        cold.counts.steps()
    );
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|v| v * factor).collect()
}
