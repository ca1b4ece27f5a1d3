//! One deck solved with contact, then linearly on the face it ends on.

use std::time::Instant;

use decks::Deck;
use feti_contact::solver::{Problem, Report, RowKind};

use crate::hand_over;
use crate::linear;
use crate::solved::solved;
use crate::table::Case;

/// The dual is solved to this fraction of the scale w of its gaps.
pub const TOLERANCE: f64 = 1e-9;

/// Options of every run that are words.
const METHOD: [(&str, &str); 1] = [("preconditioner", "dirichlet")];

/// Counts of one deck.
pub struct Measurement {
    /// Products with F, every one of them.
    pub products: usize,
    /// Products with F of the linear solve.
    pub linear: usize,
    /// Products with the preconditioner M.
    pub preconditioned: usize,
    pub coarse_solves: usize,
    pub coarse_factorisations: usize,
    /// Rows in contact with a force, of all contact rows.
    pub closed: usize,
    pub rows: usize,
    /// Wall time of setup and solve with contact; of everything, generation and linear solve included.
    pub seconds: f64,
    pub seconds_in_all: f64,
}

impl Measurement {
    pub fn new(report: &Report, linear: usize, started: Instant) -> Self {
        Self {
            products: report.counts.products,
            linear,
            preconditioned: report.counts.preconditioned,
            coarse_solves: report.counts.coarse_solves,
            coarse_factorisations: report.counts.coarse_factorisations,
            closed: report.active,
            rows: report.sizes.rows,
            seconds: report.seconds_setup + report.seconds_solve,
            seconds_in_all: started.elapsed().as_secs_f64(),
        }
    }

    pub fn ratio(&self) -> f64 {
        self.products as f64 / self.linear as f64
    }

    /// Closed rows, percent.
    pub fn closed_percent(&self) -> f64 {
        100.0 * self.closed as f64 / self.rows as f64
    }
}

/// Counts of `case` at `tolerance`; the text names what failed. Memory is given back before the next deck.
pub fn measure(case: &Case, tolerance: f64) -> Result<Measurement, String> {
    let started = Instant::now();
    let deck = case.model.build();
    let mut problem = prepared(&deck, tolerance)?;
    let report = solved(&mut problem, "contact")?;
    let multipliers = problem.multipliers(RowKind::Inequality).map_err(|e| e.to_string())?.to_vec();
    let residual = tolerance * report.gap_scale;
    let linear = linear::products(&mut problem, &deck.contact, &multipliers, residual)?;
    Ok(Measurement::new(&report, linear, started))
}

/// The deck with the options of every run.
pub fn prepared(deck: &Deck, tolerance: f64) -> Result<Problem, String> {
    let mut problem = hand_over::problem(deck).map_err(|e| e.to_string())?;
    for (option, word) in METHOD {
        problem.set_str(option, word).map_err(|e| e.to_string())?;
    }
    problem.set_i64("direct_limit", 0).map_err(|e| e.to_string())?;
    problem.set_f64("tolerance", tolerance).map_err(|e| e.to_string())?;
    Ok(problem)
}
