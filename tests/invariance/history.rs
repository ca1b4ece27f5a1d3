//! Threads and earlier solves: the same bits every time.

use decks::rubbing::Rubbing;
use decks::{Blocks, Cube, Deck, Glue};
use feti_contact::error::Kind;
use feti_contact::solver::{Problem, RowKind, RowState};

use crate::invariance::answer::{decks, Answer};
use crate::support::hand_over;

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    // Small decks take one thread whatever is asked for; the subtrees of this one are shared among the threads.
    let large = Blocks { elements: 12, young: 1.0 }.build();
    for deck in decks().into_iter().chain([large]) {
        let with = |threads| {
            let mut problem = hand_over::problem(&deck).unwrap();
            problem.set_i64("threads", threads).unwrap();
            Answer::from(&mut problem, &deck.name)
        };
        let expected = with(1);
        for threads in [2, 4, 0] {
            with(threads).assert_same(&expected, &format!("{} on {threads} threads", deck.name));
        }
    }
}

#[test]
fn solving_twice_gives_the_same_bits() {
    for deck in decks() {
        let mut problem = hand_over::problem(&deck).unwrap();
        let first = Answer::from(&mut problem, &deck.name);
        let factorisations = problem.report().unwrap().work.factorisations;
        Answer::from(&mut problem, &deck.name).assert_same(&first, &deck.name);
        assert_eq!(problem.report().unwrap().work.factorisations, factorisations, "{}", deck.name);
    }
}

/// The last face is kept, and the blocks of dependent rows on it.
#[test]
fn a_preconditioner_kept_from_the_last_solve_gives_the_same_bits() {
    let deck = Cube { glue: Glue::Redundant, waves: 0.3, clamp: false, ..Cube::default() }.build();
    for preconditioner in ["lumped", "dirichlet"] {
        let mut problem = hand_over::problem(&deck).unwrap();
        problem.set_str("preconditioner", preconditioner).unwrap();
        let first = Answer::from(&mut problem, preconditioner);
        change(&mut problem, &deck, 1.0, -0.5);
        Answer::from(&mut problem, preconditioner);
        change(&mut problem, &deck, 1.0, 1.0);
        Answer::from(&mut problem, preconditioner).assert_same(&first, preconditioner);
    }
}

/// Loads times `load`, gaps times `gap`.
fn change(problem: &mut Problem, deck: &Deck, load: f64, gap: f64) {
    let by = |values: &[f64], factor: f64| -> Vec<f64> { values.iter().map(|v| v * factor).collect() };
    for (p, body) in deck.bodies.iter().enumerate() {
        problem.set_load(p, &by(&body.load, load)).unwrap();
    }
    problem.set_rhs(RowKind::Inequality, 0, &by(&deck.contact.rhs, gap)).unwrap();
    problem.set_rhs(RowKind::Equality, 0, &by(&deck.equalities.rhs, gap)).unwrap();
}

#[test]
fn an_old_load_after_a_new_one_gives_the_bits_of_the_first_time() {
    for deck in decks() {
        let mut problem = hand_over::problem(&deck).unwrap();
        let first = Answer::from(&mut problem, &deck.name);
        for (load, gap) in [(0.7, 1.0), (1.0, 1.5), (0.3, 0.0)] {
            change(&mut problem, &deck, load, gap);
            let between = Answer::from(&mut problem, &deck.name);
            let mut fresh = hand_over::problem(&deck).unwrap();
            change(&mut fresh, &deck, load, gap);
            between.assert_same(&Answer::from(&mut fresh, &deck.name), &format!("{}, new load", deck.name));
            change(&mut problem, &deck, 1.0, 1.0);
            Answer::from(&mut problem, &deck.name).assert_same(&first, &format!("{}, old load", deck.name));
        }
    }
}

#[test]
fn a_body_that_was_changed_and_changed_back_gives_the_bits_of_the_first_time() {
    for deck in decks() {
        let mut problem = hand_over::problem(&deck).unwrap();
        let first = Answer::from(&mut problem, &deck.name);
        let mut stiffer = deck.bodies[0].clone();
        stiffer.stiffness.val.iter_mut().for_each(|k| *k *= 3.0);
        hand_over::set_body(&mut problem, 0, &stiffer).unwrap();
        let other = Answer::from(&mut problem, &deck.name);
        assert_ne!(other.u, first.u, "{}: the new stiffness was not used", deck.name);
        hand_over::set_body(&mut problem, 0, &deck.bodies[0]).unwrap();
        Answer::from(&mut problem, &deck.name).assert_same(&first, &deck.name);
    }
}

/// 0 <= c and 0 = h hold by themselves or not at all, also where c and h come after a setup.
#[test]
fn right_hand_sides_of_rows_without_entries_are_looked_at_in_every_solve() {
    let mut deck = decks().swap_remove(0);
    deck.contact.push(&[], 0.5);
    deck.equalities.push(&[], 0.0);
    let mut problem = hand_over::problem(&deck).unwrap();
    let (row, equality) = (deck.contact.len() - 1, deck.equalities.len() - 1);
    problem.solve().unwrap();
    assert_eq!(problem.active().unwrap()[row], RowState::Open);
    for (kind, row, good, bad) in
        [(RowKind::Inequality, row, 0.0, -0.5), (RowKind::Equality, equality, 0.0, 0.5)]
    {
        problem.set_rhs(kind, row, &[bad]).unwrap();
        let error = problem.solve().unwrap_err();
        assert_eq!((error.kind, error.place.row), (Kind::GapsContradict, Some(row)));
        problem.set_rhs(kind, row, &[good]).unwrap();
        problem.solve().unwrap();
    }
    assert_eq!(problem.active().unwrap()[row], RowState::Weak);
}

/// Bits of an answer.
fn bits(problem: &mut Problem) -> Vec<u64> {
    problem.solve().unwrap();
    let lambda = problem.multipliers(RowKind::Inequality).unwrap();
    problem.displacements().unwrap().iter().chain(lambda).map(|v| v.to_bits()).collect()
}

/// The columns of F of rows that stay were made beside other rows than those of a new problem.
#[test]
fn friction_and_rows_that_go_and_come_back_leave_the_bits_of_a_new_problem() {
    for rubbing in Rubbing::floating_36().into_iter().step_by(4) {
        let (deck, name) = (rubbing.build(), rubbing.name());
        let mut problem = hand_over::problem(&deck).unwrap();
        let state = problem.save_state().unwrap();
        let first = bits(&mut problem);
        problem.clear_friction();
        let _ = problem.solve();
        problem.restore_state(state).unwrap();
        assert!(bits(&mut problem) == first, "{name}: state restored");
        problem.clear_friction();
        let _ = problem.solve();
        hand_over::add_friction(&mut problem, &deck.friction).unwrap();
        assert!(bits(&mut problem) == first, "{name}: friction added again");
        let mut problem = hand_over::problem(&deck).unwrap();
        problem.clear_friction();
        let _ = problem.solve();
        hand_over::add_friction(&mut problem, &deck.friction).unwrap();
        assert!(bits(&mut problem) == first, "{name}: friction added to a problem solved without");
        let bytes = problem.write_bytes().unwrap();
        let mut back = Problem::new();
        back.read_bytes(&bytes).unwrap();
        let modes_found = bits(&mut back);
        let _ = problem.solve();
        assert!(bits(&mut problem) == first && modes_found == first, "{name}: written and read");
    }
}
