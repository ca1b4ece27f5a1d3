//! The order in which bodies and rows are registered.

use decks::random::Random;
use decks::{Deck, Rows};

use crate::invariance::answer::{decks, Answer};

/// A random order of 0..n.
fn shuffled(n: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    (1..n).for_each(|i| order.swap(i, random.below(i + 1)));
    order
}

fn pick(values: &[f64], order: &[usize]) -> Vec<f64> {
    order.iter().map(|&i| values[i]).collect()
}

/// Rows `order[0], order[1], ...` over dofs renamed by `renamed`.
fn rows_in_order(rows: &Rows, order: &[usize], renamed: &[usize]) -> Rows {
    let mut sorted = Rows::none(rows.matrix.cols);
    for &i in order {
        let entries: Vec<_> = rows.matrix.row(i).map(|(dof, value)| (renamed[dof], value)).collect();
        sorted.push_compliant(&entries, rows.rhs[i], rows.compliance[i]);
    }
    sorted
}

/// The bodies in the given order; the dofs of the deck in the order of the new one.
fn bodies_in_order(deck: &Deck, order: &[usize]) -> (Deck, Vec<usize>) {
    let dofs: Vec<usize> = order.iter().flat_map(|&p| deck.offset(p)..deck.offset(p + 1)).collect();
    let mut renamed = vec![0; dofs.len()];
    dofs.iter().enumerate().for_each(|(new, &old)| renamed[old] = new);
    let mut sorted = Deck::new(deck.name.clone(), order.iter().map(|&p| deck.bodies[p].clone()).collect());
    let all = |rows: &Rows| rows_in_order(rows, &(0..rows.len()).collect::<Vec<_>>(), &renamed);
    (sorted.contact, sorted.equalities) = (all(&deck.contact), all(&deck.equalities));
    (sorted, dofs)
}

#[test]
fn the_order_of_the_bodies_does_not_matter() {
    for (seed, deck) in decks().iter().enumerate() {
        let expected = Answer::of(deck);
        let bodies = deck.bodies.len();
        for order in [(0..bodies).rev().collect(), shuffled(bodies, &mut Random::new(seed as u64))] {
            let (sorted, dofs) = bodies_in_order(deck, &order);
            let u = pick(&expected.u, &dofs);
            Answer::of(&sorted).assert_near(&Answer { u, ..expected.clone() }, 1e-9, &deck.name);
        }
    }
}

#[test]
fn the_order_of_the_rows_does_not_matter() {
    for (seed, deck) in decks().iter().enumerate() {
        let expected = Answer::of(deck);
        let mut random = Random::new(100 + seed as u64);
        let same: Vec<usize> = (0..deck.dofs()).collect();
        let contact = shuffled(deck.contact.len(), &mut random);
        let equalities = shuffled(deck.equalities.len(), &mut random);
        let sorted = Deck {
            contact: rows_in_order(&deck.contact, &contact, &same),
            equalities: rows_in_order(&deck.equalities, &equalities, &same),
            ..deck.clone()
        };
        let (lambda, mu) = (pick(&expected.lambda, &contact), pick(&expected.mu, &equalities));
        Answer::of(&sorted).assert_near(&Answer { lambda, mu, ..expected }, 1e-9, &deck.name);
    }
}
