//! Products with F against those of a linear solve whose states are known: same start, preconditioner, stop and last products.

use feti_contact::qp::friction::{known_face, FrictionStart, Pairs};
use feti_contact::qp::Verdict;

use crate::friction::deck::Deck;
use crate::friction::problem::Content;

/// Products of both.
fn counts(deck: Deck) -> (usize, usize) {
    let given = deck.given();
    let found = given.from(FrictionStart::default(), 1e-9, 0);
    assert_eq!(found.verdict, Verdict::Solved, "{deck:?} {} {:?}", found.merit, found.counts);
    let (laws, balance) = given.missed(&found);
    assert!(laws < 1e-6 && balance < 1e-10, "{deck:?} {laws:e} {balance:e}");
    let linear =
        known_face(given.problem(), given.limits(1e-9, 0), (&found.x, &found.alpha), &mut Content).unwrap();
    let (own, of) = (found.counts.products, linear);
    let (b, mu, load) = (deck.blocks, deck.mu, deck.load);
    println!(
        "{}D {b} mu {mu} load {load}: {own} / {of} = {:.2}, {:?}",
        deck.dim,
        own as f64 / of as f64,
        found.counts
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

/// All 36; minutes without optimisation: `cargo test --release --test batteries friction:: -- --ignored --nocapture`.
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
                let limit = std::env::var("DIRECT").map_or(1000, |limit| limit.parse().unwrap());
                let found = given.from(FrictionStart::default(), 1e-9, limit);
                println!(
                    "{n} {blocks} mu {mu} load {load}: {:?} {} {:?}",
                    found.verdict, found.counts.products, found.counts
                );
                unsolved += usize::from(found.verdict != Verdict::Solved);
            }
        }
    }
    assert!(unsolved == 0, "{unsolved}");
}

/// A push that grows, falls and turns round, slips kept from step to step: warm starts with the pairs of earlier steps.
#[test]
fn nine_steps_of_a_loop_cost_less_than_cold_linear_problems() {
    for deck in [Deck::new(2, 16, 1, 0.6, 0.0), Deck::new(3, 4, 1, 0.6, 0.0)] {
        let (mut own, mut linear, mut slips) = (0, 0, Vec::new());
        let (mut x, mut alpha, mut pairs) = (None, None, Pairs::default());
        for load in [0.3, 0.6, 0.9, 0.6, 0.3, 0.0, -0.3, -0.6, -0.9] {
            let mut given = Deck { load, ..deck }.given();
            slips.resize(given.d.len(), 0.0);
            given.d.iter_mut().zip(&slips).for_each(|(d, slip)| *d -= slip);
            let start = FrictionStart { x: x.as_deref(), alpha: alpha.as_deref(), pairs };
            let found = given.from(start, 1e-9, 0);
            assert_eq!(found.verdict, Verdict::Solved, "{load} {} {:?}", found.merit, found.counts);
            let known =
                known_face(given.problem(), given.limits(1e-9, 0), (&found.x, &found.alpha), &mut Content)
                    .unwrap();
            println!("push {load}: {} / {known}", found.counts.products);
            (own, linear) = (own + found.counts.products, linear + known);
            let r = given.gaps(&found);
            let tangents = given.cones.nodes().iter().flat_map(|node| node.tangents().to_vec());
            tangents.for_each(|row| slips[row] -= r[row]);
            (x, alpha, pairs) = (Some(found.x), Some(found.alpha), found.pairs);
        }
        println!("{own} / {linear}");
        assert!(own < linear, "{own} {linear}");
    }
}
