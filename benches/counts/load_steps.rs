//! The load of one deck applied in equal steps, each started from the forces of the one before.

use std::time::Instant;

use decks::Deck;
use feti_contact::error::Result as Solver;
use feti_contact::solver::{Problem, RowKind};

use crate::linear;
use crate::measure::{prepared, Measurement};
use crate::solved::solved;
use crate::table::Case;

const STEPS: usize = 6;

/// Counts of the steps from `first` on, against linear solves that start cold.
pub fn measure(case: &Case, first: usize, tolerance: f64) -> Result<Vec<Measurement>, String> {
    let mut deck = case.model.build();
    let whole: Vec<Vec<f64>> = deck.bodies.iter().map(|body| body.load.clone()).collect();
    let mut problem = prepared(&deck, tolerance)?;
    let mut measured = Vec::new();
    for step in 1..=STEPS {
        let started = Instant::now();
        let part = step as f64 / STEPS as f64;
        for (body, load) in deck.bodies.iter_mut().zip(&whole) {
            body.load = load.iter().map(|f| part * f).collect();
        }
        next(&mut problem, &deck, step > 1).map_err(|e| e.to_string())?;
        let report = solved(&mut problem, "contact")?;
        if step >= first {
            let multipliers = problem.multipliers(RowKind::Inequality).map_err(|e| e.to_string())?;
            let residual = tolerance * report.gap_scale;
            let mut cold = prepared(&deck, tolerance)?;
            let linear = linear::products(&mut cold, &deck.contact, multipliers, residual)?;
            measured.push(Measurement::new(&report, linear, started));
        }
    }
    Ok(measured)
}

/// The loads of the deck, and the last forces as a start.
fn next(problem: &mut Problem, deck: &Deck, warm: bool) -> Solver<()> {
    for kind in [RowKind::Inequality, RowKind::Equality].into_iter().filter(|_| warm) {
        let multipliers = problem.multipliers(kind)?.to_vec();
        problem.start_from(kind, &multipliers)?;
    }
    deck.bodies.iter().enumerate().try_for_each(|(p, body)| problem.set_load(p, &body.load))
}
