//! Compliant rows, `B u - c <= lambda/k` and `H u - h = mu/k`: by hand, against the same problem with the springs as
//! bodies of their own, and what happens when the compliance changes.

mod by_hand;
mod changes;
mod springs;

use crate::support::hand_over;
use decks::{Body, Csr, Deck};
use feti_contact::solver::{Outcome, Problem, Report, RowKind};

/// A body with unit null vector (1, ..., 1) when it floats; `stiffness` dense by rows.
fn body(stiffness: &[f64], load: &[f64], floating: bool) -> Body {
    let n = load.len();
    Body {
        stiffness: Csr::from_dense(n, stiffness),
        null_space: floating.then(|| vec![vec![1.0; n]]),
        load: load.to_vec(),
        coordinates: vec![[0.0; 3]; n],
        node: (1..=n as i32).collect(),
        direction: vec![1; n],
    }
}

/// Solves; the certificate must hold.
fn solved(problem: &mut Problem, name: &str) -> Report {
    let report = problem.solve().unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(report.outcome, Outcome::Solved, "{name}: {report:?}");
    assert!(report.certificate.passed(), "{name}: {:?}", report.certificate);
    report
}

/// u over all bodies, lambda, mu.
fn answer(problem: &Problem) -> [Vec<f64>; 3] {
    let bodies = problem.sizes().bodies;
    let u = (0..bodies).flat_map(|p| problem.displacement(p).unwrap().to_vec()).collect();
    let [lambda, mu] =
        [RowKind::Inequality, RowKind::Equality].map(|kind| problem.multipliers(kind).unwrap().to_vec());
    [u, lambda, mu]
}

/// The answer of a deck.
fn answer_of(deck: &Deck) -> [Vec<f64>; 3] {
    let mut problem = hand_over::problem(deck).unwrap();
    solved(&mut problem, &deck.name);
    answer(&problem)
}

/// The same numbers to `tolerance` of the largest.
fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let size = expected.iter().fold(0.0f64, |size, v| size.max(v.abs()));
    let error = found.iter().zip(expected).fold(0.0f64, |error, (a, b)| error.max((a - b).abs()));
    assert!(error <= tolerance * size, "{what}: {error:e} of {size:e}: {found:?}, expected {expected:?}");
}
