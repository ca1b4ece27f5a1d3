//! One to three unknowns: the answers by hand.

use approx::assert_relative_eq;
use decks::small::{FacingSprings, GluedBar, Obstacle, Solved, SpringAndBlock};
use feti_contact::solver::{Outcome, RowKind};

use crate::support::hand_over;

/// The answer of the library is that by hand, to 1e-12 of the largest number of its kind, a load among the forces.
fn assert_by_hand(by_hand: &Solved) {
    let deck = &by_hand.deck;
    let mut problem = hand_over::problem(deck).unwrap();
    let report = problem.solve().unwrap();
    assert_eq!(report.outcome, Outcome::Solved, "{}", deck.name);
    assert!(report.certificate.passed(), "{}: {:?}", deck.name, report.certificate);
    let u: Vec<f64> =
        (0..deck.bodies.len()).flat_map(|p| problem.displacement(p).unwrap().to_vec()).collect();
    assert_near(&u, &by_hand.displacement, 0.0);
    // a force that is none is that to rounding of the loads
    let load = deck.load().iter().fold(0.0f64, |size, f| size.max(f.abs()));
    assert_near(problem.multipliers(RowKind::Inequality).unwrap(), &by_hand.forces, load);
    assert_near(problem.multipliers(RowKind::Equality).unwrap(), &by_hand.equality_forces, load);
}

fn assert_near(found: &[f64], expected: &[f64], size: f64) {
    assert_eq!(found.len(), expected.len());
    let size = expected.iter().fold(size, |size, v| size.max(v.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert_relative_eq!(*found, *expected, epsilon = 1e-12 * size, max_relative = 1e-12);
    }
}

#[test]
fn an_obstacle_is_answered_open_touching_and_closed() {
    for force in [1.0, 1.5, 4.0] {
        assert_by_hand(&Obstacle { spring: 3.0, force, gap: 0.5 }.build());
    }
    assert_by_hand(&Obstacle { spring: 2.1e11, force: 1e3, gap: 1e-9 }.build());
}

#[test]
fn a_floating_block_rests_on_the_spring() {
    for block in [None, Some(6.0), Some(6e6)] {
        for gap in [0.25, 0.0, -0.1] {
            assert_by_hand(&SpringAndBlock { spring: 2.0, force: 3.0, gap, block }.build());
        }
    }
}

#[test]
fn facing_springs_are_answered_open_and_closed() {
    for gap in [0.1, 1.7, 10.0] {
        for springs in [[2.0, 5.0], [2.0, 5e6], [0.2, 5.0]] {
            assert_by_hand(&FacingSprings { springs, forces: [3.0, -1.0], gap }.build());
        }
    }
}

#[test]
fn a_glued_bar_is_answered_open_and_closed() {
    for gap in [0.1, 10.0] {
        assert_by_hand(&GluedBar { spring: 2.0, bar: 5.0, force: 3.0, gap }.build());
    }
}
