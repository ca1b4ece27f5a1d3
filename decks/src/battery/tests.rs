//! Claims about the labels of the battery.

use crate::battery::{cases, Case, Multipliers, Outcome, Proof};
use crate::vector::{axpy, dot, norm, norm_max};
use crate::Deck;

const SEEDS: std::ops::Range<u64> = 0..200;

fn assert_feasible(deck: &Deck, displacement: &[f64]) {
    let closing = deck.contact.matrix.times(displacement);
    assert!(closing.iter().zip(&deck.contact.rhs).all(|(u, gap)| u < gap), "{}", deck.name);
    assert_eq!(deck.equalities.matrix.times(displacement), deck.equalities.rhs);
}

/// lambda >= 0 and R'(f - B'lambda - H'mu) = 0 for every mode of every body.
fn assert_held(deck: &Deck, forces: &Multipliers) {
    assert!(forces.contact.iter().all(|&force| force >= 0.0));
    let mut rest = deck.load();
    axpy(-1.0, &deck.contact.matrix.transpose_times(&forces.contact), &mut rest);
    axpy(-1.0, &deck.equalities.matrix.transpose_times(&forces.equalities), &mut rest);
    for (index, body) in deck.bodies.iter().enumerate() {
        let range = deck.offset(index)..deck.offset(index + 1);
        for mode in body.modes() {
            let work = dot(mode, &rest[range.clone()]);
            assert!(work.abs() <= 1e-12 * norm(mode) * norm(&deck.load()), "{} {work:e}", deck.name);
        }
    }
}

fn assert_separates(deck: &Deck, motion: &[f64]) {
    for (index, body) in deck.bodies.iter().enumerate() {
        let own = &motion[deck.offset(index)..deck.offset(index + 1)];
        let force = norm_max(&body.stiffness.times(own));
        assert!(force <= 1e-12 * norm_max(&body.stiffness.val) * norm_max(motion), "{}", deck.name);
    }
    assert!(deck.contact.matrix.times(motion).iter().all(|&closing| closing <= 1e-13));
    assert!(norm_max(&deck.equalities.matrix.times(motion)) <= 1e-13);
    assert!(dot(&deck.load(), motion) > 0.0);
}

fn assert_contradicts(deck: &Deck, weights: &Multipliers) {
    assert!(weights.contact.iter().all(|&weight| weight >= 0.0));
    let mut sum = deck.contact.matrix.transpose_times(&weights.contact);
    axpy(1.0, &deck.equalities.matrix.transpose_times(&weights.equalities), &mut sum);
    assert!(norm_max(&sum) <= 1e-14, "{}", deck.name);
    let gaps = dot(&weights.contact, &deck.contact.rhs) + dot(&weights.equalities, &deck.equalities.rhs);
    assert!(gaps < 0.0);
}

#[test]
fn every_label_is_proved_by_its_vectors() {
    for case in cases(SEEDS) {
        match &case.proof {
            Proof::Solvable { displacement, forces } => {
                assert_feasible(&case.deck, displacement);
                assert!(forces.contact.iter().all(|&force| force > 0.0));
                assert_held(&case.deck, forces);
            }
            Proof::LoadNotHeld { displacement, motion } => {
                assert_feasible(&case.deck, displacement);
                assert_separates(&case.deck, motion);
            }
            Proof::GapsContradict { forces, weights } => {
                assert_held(&case.deck, forces);
                assert_contradicts(&case.deck, weights);
            }
        }
    }
}

#[test]
fn every_margin_is_at_least_1e_4() {
    let smallest = cases(SEEDS).map(|case| case.margin).fold(f64::INFINITY, f64::min);
    assert!(smallest >= 1e-4, "{smallest:e}");
}

#[test]
fn margins_of_marginal_cases_lie_between_1e_12_and_1e_4() {
    for case in SEEDS.map(crate::battery::marginal) {
        assert!((5e-13..=1e-4).contains(&case.margin), "{} {:e}", case.deck.name, case.margin);
    }
    let smallest = SEEDS.map(|seed| crate::battery::marginal(seed).margin).fold(f64::INFINITY, f64::min);
    assert!(smallest < 1e-10, "{smallest:e}");
}

#[test]
fn all_outcomes_and_all_kinds_of_difficulty_occur() {
    let all: Vec<Case> = cases(SEEDS).collect();
    let count = |outcome: Outcome| all.iter().filter(|case| case.outcome() == outcome).count();
    assert_eq!(count(Outcome::Solvable), 100);
    assert_eq!((count(Outcome::LoadNotHeld), count(Outcome::GapsContradict)), (50, 50));
    assert!(all.iter().any(|case| case.deck.bodies.len() == 8));
    assert!(all.iter().any(|case| case.deck.contact.rhs.iter().any(|&gap| gap < 0.0)));
    assert!(all.iter().any(|case| !case.deck.equalities.is_empty()));
    assert!(all.iter().any(|case| case.deck.bodies.iter().all(|body| body.modes().is_empty())));
    let stiffest = |case: &Case| {
        let sizes = case.deck.bodies.iter().map(|body| norm_max(&body.stiffness.val));
        let (low, high) = sizes.fold((f64::INFINITY, 0f64), |(a, b), s| (a.min(s), b.max(s)));
        high / low
    };
    assert!(all.iter().any(|case| stiffest(case) > 1e3));
    assert!(all.iter().all(|case| case.deck.dofs() < 2000));
}

#[test]
fn same_seed_gives_the_same_case() {
    let pair = [5, 5].map(crate::battery::case);
    assert_eq!(pair[0].deck.load(), pair[1].deck.load());
    assert_eq!(pair[0].deck.contact.matrix, pair[1].deck.contact.matrix);
}
