//! One K for several bodies: every connected component of a matrix is solved as a body of its own.

mod directions;
mod loose;
mod queries;

use crate::support::hand_over;
use std::time::Instant;

use decks::rubbing::{self, Rubbing};
use decks::{battery, hard, masonry, varied, Blocks, Cube, Deck, Stack};
use feti_contact::error::Result;
use feti_contact::solver::{Problem, RowKind};

/// How a solve ended, with the bits of its answer, and its products.
fn end(problem: Result<Problem>) -> (String, Vec<u64>) {
    let mut problem = match problem {
        Ok(problem) => problem,
        Err(error) => return (format!("{:?}", error.kind), Vec::new()),
    };
    let report = match problem.solve() {
        Ok(report) => report,
        Err(error) => return (format!("{:?} {:?}", error.kind, error.place.row), Vec::new()),
    };
    let kinds = [RowKind::Inequality, RowKind::Equality, RowKind::Tangential];
    let forces = kinds.into_iter().flat_map(|kind| problem.multipliers(kind).unwrap().to_vec());
    let bits = forces.chain(problem.displacements().unwrap().to_vec()).map(f64::to_bits).collect();
    (format!("{:?} {:?}", report.outcome, report.counts), bits)
}

#[track_caller]
fn assert_same(name: &str, deck: &Deck) {
    let twin = deck.one_k();
    assert_eq!(end(hand_over::problem(deck)), end(hand_over::problem(&twin)), "{name}, null space given");
    let found = [deck, &twin].map(|deck| end(hand_over::without_null_spaces(deck)));
    assert_eq!(found[0], found[1], "{name}, nothing given");
}

#[test]
fn blocks_in_one_matrix_have_the_bits_of_separate_bodies() {
    assert_same("tower", &masonry::tower(12));
    assert_same("apart", &masonry::apart(9));
    assert_same("heap", &masonry::heap(15, 7));
    assert_same("chain", &masonry::chain(10));
    assert_same("wall", &masonry::wall(3, 0.01));
}

#[test]
fn random_problems_in_one_matrix_end_as_those_of_separate_bodies() {
    let seeds = std::env::var("PARTS").ok().and_then(|n| n.parse().ok()).unwrap_or(150);
    for seed in 0..seeds {
        assert_same(&format!("battery {seed}"), &battery::case(910_000 + seed).deck);
        assert_same(&format!("varied {seed}"), &varied::case(920_000 + seed).deck);
        assert_same(&format!("hard {seed}"), &hard::case(930_000 + seed).deck);
    }
}

#[test]
fn counts_decks_in_one_matrix_have_the_bits_and_products_of_separate_bodies() {
    for rubbing in Rubbing::floating_36().iter().filter(|rubbing| rubbing.name().contains("2d")) {
        assert_same(&rubbing.name(), &rubbing.build());
    }
    assert_same("stack", &Stack::default().build());
    assert_same("cube", &Cube::default().build());
    assert_same("cube with friction", &rubbing::cube(&Cube::default(), 0.5, 0.3));
}

/// `cargo test --release --test claims parts:: -- --ignored --nocapture`
#[test]
#[ignore = "prints times"]
fn times_of_one_matrix_against_those_of_separate_bodies() {
    for (name, deck) in [
        ("blocks 13k", Blocks { elements: 12, ..Blocks::default() }.build()),
        ("blocks 40k", Blocks { elements: 18, ..Blocks::default() }.build()),
        ("tower of 400", masonry::tower(400)),
        ("heap of 400", masonry::heap(400, 3)),
    ] {
        let twins = [deck.clone(), deck.one_k()];
        let time = |deck: &Deck| {
            let mut problem = hand_over::problem(deck).unwrap();
            problem.set_i64("threads", 1).unwrap();
            let begun = Instant::now();
            problem.solve().unwrap();
            begun.elapsed().as_secs_f64()
        };
        let mut ratios: Vec<f64> = (0..7).map(|_| time(&twins[1]) / time(&twins[0])).collect();
        ratios.sort_by(f64::total_cmp);
        println!("{name}: one K / bodies {:.2} ({:.2} to {:.2})", ratios[3], ratios[0], ratios[6]);
    }
}

/// Equal blocks in one matrix share one analysis and one factor.
#[test]
fn equal_components_share_their_factor() {
    let deck = masonry::apart(20);
    let mut problem = hand_over::problem(&deck.one_k()).unwrap();
    problem.solve().unwrap();
    let work = problem.work();
    assert_eq!((work.analyses, work.factorisations), (1, 1));
}
