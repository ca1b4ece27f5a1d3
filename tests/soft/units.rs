//! The unit of forces and that of lengths change no answer, and a file keeps it.

use decks::Deck;
use feti_contact::solver::{Modes, Problem};

use crate::soft::{add_diagonal, column_on, difference, given, solved, with_springs, Solved, ELEMENTS};

/// A column with springs, and one that is driven at the top corners.
fn decks() -> [Deck; 2] {
    let [nx, ny, _] = ELEMENTS;
    let mut driven = column_on(2, 3..=5, 1e-3);
    for body in &mut driven.bodies {
        for node in [ny * (nx + 1), ny * (nx + 1) + nx] {
            add_diagonal(body, 2 * node, -3e-3);
        }
    }
    [with_springs(column_on(2, 0..=nx, 0.15), 1e-8), driven]
}

/// Forces times `force`, lengths times `length`, K as both ask.
fn in_units(deck: &Deck, force: f64, length: f64) -> Deck {
    let mut deck = deck.clone();
    for body in &mut deck.bodies {
        body.stiffness.val.iter_mut().for_each(|v| *v *= force / length);
        body.load.iter_mut().for_each(|f| *f *= force);
    }
    deck.contact.rhs.iter_mut().chain(&mut deck.equalities.rhs).for_each(|c| *c *= length);
    deck
}

fn answer(deck: &Deck) -> Solved {
    solved(&mut given(deck, Modes::Soft)).unwrap()
}

fn bits(values: &[f64], by: f64) -> Vec<u64> {
    values.iter().map(|v| (v * by).to_bits()).collect()
}

fn assert_same_bits(found: &Solved, one: &Solved, force: f64, length: f64) {
    assert!(bits(&found.lambda, 1.0) == bits(&one.lambda, force), "forces {force:e} {length:e}");
    assert!(bits(&found.mu, 1.0) == bits(&one.mu, force), "forces {force:e} {length:e}");
    assert!(bits(&found.u, 1.0) == bits(&one.u, length), "lengths {force:e} {length:e}");
    assert_eq!(found.products, one.products);
}

#[test]
fn powers_of_two_give_the_same_bits() {
    for deck in decks() {
        let one = answer(&deck);
        assert!(one.lambda.iter().any(|l| *l > 0.0));
        for (force, length) in [(37, 0), (-52, 0), (0, 11), (0, -30), (24, -9)] {
            let (force, length) = (2f64.powi(force), 2f64.powi(length));
            assert_same_bits(&answer(&in_units(&deck, force, length)), &one, force, length);
        }
    }
}

#[test]
fn other_factors_give_the_same_answer_to_rounding() {
    for deck in decks() {
        let one = answer(&deck);
        for (force, length) in [(1e-7, 1.0), (3e9, 1.0), (1.0, 1e-7), (1.0, 3e9), (3e9, 1e-7)] {
            let found = answer(&in_units(&deck, force, length));
            let scaled = |x: &[f64], by: f64| x.iter().map(|x| x * by).collect::<Vec<_>>();
            let forces = difference(&found.lambda, &scaled(&one.lambda, force));
            let u = difference(&found.u, &scaled(&one.u, length));
            assert!(forces <= 1e-9 && u <= 1e-9, "{force:e} {length:e}: forces {forces:.1e} u {u:.1e}");
        }
    }
}

/// The file knows that the motions are soft: taken as exact ones they would be refused, or give another answer.
#[test]
fn a_problem_file_keeps_soft_motions_and_the_bits_of_their_answer() {
    for deck in decks() {
        let mut problem = given(&deck, Modes::Soft);
        let path = std::env::temp_dir().join(format!("soft_{}_{}.feti", std::process::id(), deck.dofs()));
        problem.write_file(&path).unwrap();
        let mut read = Problem::new();
        let found = read.read_file(&path);
        std::fs::remove_file(&path).unwrap();
        found.unwrap();
        let (one, found) = (solved(&mut problem).unwrap(), solved(&mut read).unwrap());
        assert_same_bits(&found, &one, 1.0, 1.0);
        assert_eq!(read.findings().unwrap().soft, problem.findings().unwrap().soft);
        let exact = solved(&mut given(&deck, Modes::Exact));
        assert!(exact.map_or(true, |exact| bits(&exact.lambda, 1.0) != bits(&one.lambda, 1.0)));
    }
}
