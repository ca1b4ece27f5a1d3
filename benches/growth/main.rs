//! How processor time grows with the number of bodies: solves of many loose or glued bodies, each against one of fewer bodies in
//! the same run. One line a comparison,
//!
//! ```text
//! growth <name> T <seconds> to <seconds> ratio <r> goal <g> ok|short
//! ```
//!
//! Arguments: parts of the names to run, none for all. Exit code 1 when a problem is not solved; a short one alone leaves it 0.

#[path = "../bench/clock.rs"]
#[allow(dead_code)]
mod clock;
#[path = "../../tests/support/hand_over.rs"]
mod hand_over;

use std::process::ExitCode;

use clock::Clock;
use decks::pieces::Pieces;
use decks::{masonry, Deck};
use feti_contact::solver::{Outcome, Report};

/// Both solves are run so often, in turns; the ratio is that of the medians.
const ROUNDS: usize = 3;

struct Comparison {
    name: &'static str,
    base: fn() -> Deck,
    grown: fn() -> Deck,
    goal: f64,
}

const COMPARISONS: [Comparison; 7] = [
    Comparison { name: "tower", base: || masonry::tower(100), grown: || masonry::tower(1000), goal: 20.0 },
    Comparison { name: "chain", base: || masonry::chain(200), grown: || masonry::chain(2000), goal: 20.0 },
    Comparison {
        name: "wall_flat",
        base: || masonry::wall(8, 0.0),
        grown: || masonry::wall(24, 0.0),
        goal: 20.0,
    },
    Comparison {
        name: "wall_scattered",
        base: || masonry::wall(8, 1e-4),
        grown: || masonry::wall(24, 1e-4),
        goal: 20.0,
    },
    Comparison { name: "heap", base: || masonry::wall(18, 1e-4), grown: || masonry::heap(500, 1), goal: 3.0 },
    Comparison { name: "apart", base: || masonry::wall(24, 1e-4), grown: || masonry::apart(2000), goal: 3.0 },
    Comparison { name: "pieces", base: || pieces(true), grown: || pieces(false), goal: 1.5 },
];

/// 432 pieces of two blocks of 40k unknowns, the upper one held or free to slide.
fn pieces(held: bool) -> Deck {
    Pieces { pieces: 6, elements: 3, held }.build()
}

fn main() -> ExitCode {
    let wanted: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let wants = |name: &str| wanted.is_empty() || wanted.iter().any(|part| name.contains(part));
    let (mut short, mut failed) = (0, 0);
    for comparison in COMPARISONS.iter().filter(|comparison| wants(comparison.name)) {
        match measured(comparison) {
            Ok((base, grown)) => {
                let (name, goal, ratio) = (comparison.name, comparison.goal, grown / base);
                let is_short = ratio > goal;
                short += usize::from(is_short);
                let verdict = if is_short { "short" } else { "ok" };
                println!("growth {name} T {base:.3} to {grown:.3} ratio {ratio:.2} goal {goal:.2} {verdict}");
            }
            Err(fault) => {
                failed += 1;
                println!("growth {} failed: {fault}", comparison.name);
            }
        }
    }
    println!("growth: {short} short, {failed} failed");
    ExitCode::from(u8::from(failed > 0))
}

/// Medians of the processor times, setup and solve, on one thread.
fn measured(comparison: &Comparison) -> Result<(f64, f64), String> {
    let (base, grown) = ((comparison.base)(), (comparison.grown)());
    let (mut times, mut told) = ([Vec::new(), Vec::new()], false);
    for _ in 0..ROUNDS {
        for (deck, times) in [&base, &grown].into_iter().zip(&mut times) {
            let (time, report) = solved(deck)?;
            times.push(time);
            if !told {
                tell(deck, time, &report);
            }
        }
        told = true;
    }
    let median = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    let [base, grown] = times;
    Ok((median(base), median(grown)))
}

fn solved(deck: &Deck) -> Result<(f64, Report), String> {
    let text = |error: feti_contact::error::Error| format!("{}: {error}", deck.name);
    let mut problem = hand_over::problem(deck).map_err(text)?;
    problem.set_i64("threads", 1).map_err(text)?;
    let clock = Clock::start();
    // as every call of the C interface does
    let _room = problem.working_headroom().map_err(text)?;
    let report = problem.solve().map_err(text)?;
    match report.outcome {
        Outcome::Solved => Ok((clock.lap().cpu, report)),
        outcome => Err(format!("{}: {outcome:?}, {:.1} s", deck.name, clock.lap().cpu)),
    }
}

fn tell(deck: &Deck, time: f64, report: &Report) {
    let (counts, bodies, rows) =
        (&report.counts, deck.bodies.len(), deck.contact.len() + deck.equalities.len());
    println!(
        "    {}: {bodies} bodies, {} unknowns, {rows} rows, {time:.3} s: products {}, coarse solves {}, \
         factorisations {}, undetermined {}",
        deck.name,
        deck.dofs(),
        counts.products,
        counts.coarse_solves,
        counts.coarse_factorisations,
        report.undetermined
    );
}
