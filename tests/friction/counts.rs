//! Products with F against those of a linear solve whose states are known: same start, preconditioner, stop and last products.

use feti_contact::qp::friction::{known_face, FrictionStart};
use feti_contact::qp::Verdict;

use crate::deck::Deck;
use crate::problem::Content;

/// Products of both.
fn counts(deck: Deck) -> (usize, usize) {
    let given = deck.given();
    let found = given.from(FrictionStart::default(), 1e-9, 0);
    assert_eq!(found.verdict, Verdict::Solved, "{deck:?} {} {:?}", found.merit, found.tried);
    let (laws, balance) = given.missed(&found);
    assert!(laws < 1e-6 && balance < 1e-10, "{deck:?} {laws:e} {balance:e}");
    let linear = known_face(given.problem(), given.limits(1e-9, 0), &found, &mut Content).unwrap();
    let (own, of) = (found.counts.products, linear);
    let (b, mu, load) = (deck.blocks, deck.mu, deck.load);
    println!(
        "{}D {b} mu {mu} load {load}: {own} / {of} = {:.2}, {:?}",
        deck.dim,
        own as f64 / of as f64,
        found.tried
    );
    (own, of)
}

fn compared(decks: &[Deck]) -> (usize, usize, Vec<f64>) {
    let all: Vec<(usize, usize)> = decks.iter().map(|deck| counts(*deck)).collect();
    let mut ratios: Vec<f64> = all.iter().map(|(own, of)| *own as f64 / *of as f64).collect();
    ratios.sort_by(f64::total_cmp);
    let (own, of) = (all.iter().map(|c| c.0).sum(), all.iter().map(|c| c.1).sum());
    println!("{own} / {of}, median {:.2}, worst {:.2}", ratios[ratios.len() / 2], ratios[ratios.len() - 1]);
    (own, of, ratios)
}

fn decks(sizes: [(usize, usize); 2]) -> Vec<Deck> {
    let mut decks = Vec::new();
    for (dim, n) in sizes {
        for blocks in [1, 3] {
            for mu in [0.1, 0.6, 1.0] {
                decks.extend([0.3, 0.8, 0.97].map(|load| Deck::new(dim, n, blocks, mu, load)));
            }
        }
    }
    decks
}

#[test]
fn friction_costs_little_more_than_the_linear_problem_of_its_states() {
    let some: Vec<Deck> =
        decks([(2, 16), (3, 4)]).into_iter().filter(|deck| deck.mu > 0.1 || deck.blocks == 1).collect();
    let (_, _, ratios) = compared(&some);
    assert!(ratios[ratios.len() / 2] <= 1.3, "median {}", ratios[ratios.len() / 2]);
    assert!(ratios[ratios.len() - 1] <= 2.0, "worst {}", ratios[ratios.len() - 1]);
}

/// All 36; minutes without optimisation: `cargo test --release --test friction -- --ignored --nocapture`.
#[test]
#[ignore]
fn counts_of_the_36_decks() {
    let (_, _, ratios) = compared(&decks([(2, 32), (3, 8)]));
    assert!(ratios[ratios.len() / 2] <= 1.3 && ratios[ratios.len() - 1] <= 5.0);
}

/// Thin plates upon each other with little friction, where Newton's method on the laws themselves goes round in circles.
#[test]
#[ignore]
fn thin_plates_with_little_friction_are_solved() {
    let mut unsolved = 0;
    for (n, blocks) in [(16, 1), (16, 3), (24, 1), (24, 3), (40, 1), (40, 3)] {
        for mu in [0.02, 0.05, 0.1] {
            for load in [0.1, 0.3, 0.8, 0.97] {
                let given = Deck::new(2, n, blocks, mu, load).given();
                let found = given.from(FrictionStart::default(), 1e-9, 1000);
                println!(
                    "{n} {blocks} mu {mu} load {load}: {:?} {} {:?}",
                    found.verdict, found.counts.products, found.tried
                );
                unsolved += usize::from(found.verdict != Verdict::Solved);
            }
        }
    }
    assert!(unsolved == 0, "{unsolved}");
}
