//! Nothing is computed twice: the counters of the report say what a change of the data costs.

mod bodies;
mod borrowed;
mod forms;
mod rows;
mod values;

use decks::Deck;
use feti_contact::solver::{Outcome, Problem, RowKind};

/// Solves and tells what it cost; `before` is what all solves before have cost.
pub fn spent(problem: &mut Problem, before: &mut [usize; 4]) -> [usize; 4] {
    let report = problem.solve().unwrap();
    assert_eq!(report.outcome, Outcome::Solved, "{report:?}");
    let all = [
        report.work.analyses,
        report.work.factorisations,
        report.work.columns_computed,
        report.work.columns_kept,
    ];
    let now = std::array::from_fn(|k| all[k] - before[k]);
    *before = all;
    now
}

/// u, lambda, mu.
pub fn answer(problem: &Problem) -> [Vec<f64>; 3] {
    let bodies = 0..problem.sizes().bodies;
    let u = bodies.flat_map(|p| problem.displacement(p).unwrap().to_vec()).collect();
    let [lambda, mu] =
        [RowKind::Inequality, RowKind::Equality].map(|k| problem.multipliers(k).unwrap().to_vec());
    [u, lambda, mu]
}

/// The largest difference against the largest of the expected numbers.
pub fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let size = expected.iter().fold(0.0f64, |size, v| size.max(v.abs()));
    let error = found.iter().zip(expected).fold(0.0f64, |error, (a, b)| error.max((a - b).abs()));
    assert!(error <= tolerance * size, "{what}: {error:e} of {size:e}");
}

/// Touches of rows and bodies: columns of all dual operators, for rows that are decoupled by no other.
pub fn touches(deck: &Deck) -> usize {
    let body = |dof: usize| (0..deck.bodies.len()).rfind(|&p| deck.offset(p) <= dof).unwrap();
    let touched = |row: usize| {
        let mut bodies: Vec<usize> = deck.contact.matrix.row(row).map(|(dof, _)| body(dof)).collect();
        bodies.dedup();
        bodies.len()
    };
    (0..deck.contact.len()).map(touched).sum()
}
