//! Coulomb's law as a sequence of problems of Tresca, each with the bounds mu lambda_n of the one before: what the method for Coulomb's
//! law itself is compared to.

use decks::Deck;
use feti_contact::solver::{Problem, RowKind};

use crate::measure::{prepared, TOLERANCE};
use crate::solved::solved;

/// The sequence ends where no bound changes by more than this part of the largest.
const SETTLED: f64 = 1e-6;
const PROBLEMS: usize = 100;
/// Bounds of the first problem, of the largest load: nothing slips.
const STICKS: f64 = 1e3;
/// An inexact problem is solved to this part of the last change of bounds.
const INEXACT: f64 = 0.1;
const TOLERANCE_OF_CERTIFICATE: f64 = 1e-8;

pub struct Sequence {
    /// Products with F of all problems.
    pub products: usize,
    pub problems: usize,
}

/// Problems started from the forces of the one before; where they are not `exact` they are solved no better than bounds are known.
pub fn measure(deck: &Deck, exact: bool) -> Result<Sequence, String> {
    let text = |error: feti_contact::error::Error| error.to_string();
    let mut problem = prepared(deck, TOLERANCE)?;
    problem.set_str("start", "previous").map_err(text)?;
    let nodes = &deck.friction;
    let count = nodes.normal.len();
    let largest = |v: &[f64]| v.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let mut bounds = vec![STICKS * largest(&deck.load()); count];
    let (mut products, mut change) = (0, 1.0);
    for problems in 1..=PROBLEMS {
        if !exact {
            loosen(&mut problem, change).map_err(text)?;
        }
        problem.set_friction_law(0, count, Some(&vec![0.0; count]), Some(&bounds)).map_err(text)?;
        products += solved(&mut problem, "Tresca")?.counts.products;
        let normal = problem.multipliers(RowKind::Inequality).map_err(text)?;
        let new: Vec<f64> = (0..count)
            .map(|i| {
                nodes.bound[i]
                    + nodes.coefficient[i] * nodes.normal[i].map_or(0.0, |row| normal[row].max(0.0))
            })
            .collect();
        let differences: Vec<f64> = bounds.iter().zip(&new).map(|(old, new)| new - old).collect();
        change = (largest(&differences) / largest(&new)).min(1.0);
        bounds = new;
        if change <= SETTLED {
            return Ok(Sequence { products, problems });
        }
    }
    Err(format!("bounds still change by {change:.0e} after {PROBLEMS} problems, {products} products with F"))
}

fn loosen(problem: &mut Problem, change: f64) -> feti_contact::error::Result<()> {
    let allowed = INEXACT * change;
    problem.set_f64("tolerance", allowed.clamp(TOLERANCE, 1e-2))?;
    problem.set_f64("certificate_tolerance", allowed.clamp(TOLERANCE_OF_CERTIFICATE, 1e-2))
}
