//! How processor time grows with the number of bodies: solves of many loose or glued bodies, each against one of fewer bodies in
//! the same run, and loads that nothing holds against the same bodies with a load that is held. One line a comparison,
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
use decks::{masonry, Cube, Deck, Moduli};
use feti_contact::error::{Error, Kind};
use feti_contact::solver::{Outcome, Report};

/// Both solves are run so often, in turns; the ratio is that of the medians.
const ROUNDS: usize = 3;

struct Comparison {
    name: &'static str,
    base: fn() -> Deck,
    grown: fn() -> Deck,
    goal: f64,
    /// Nothing holds the load of the grown one: that is to be named.
    pushed: bool,
}

/// Pushed aside: some rows press on others until nothing holds the last.
fn pushed(mut deck: Deck) -> Deck {
    let middle = deck.bodies.len() / 2;
    let body = &mut deck.bodies[middle];
    body.load.iter_mut().zip(&body.direction).filter(|(_, axis)| **axis == 1).for_each(|(f, _)| *f += 1.0);
    deck
}

const COMPARISONS: [Comparison; 10] = [
    solved_both("tower", || masonry::tower(100), || masonry::tower(1000), 20.0),
    solved_both("chain", || masonry::chain(200), || masonry::chain(2000), 20.0),
    solved_both("wall_flat", || masonry::wall(8, 0.0), || masonry::wall(24, 0.0), 20.0),
    solved_both("wall_scattered", || masonry::wall(8, 1e-4), || masonry::wall(24, 1e-4), 20.0),
    solved_both("heap", || masonry::wall(18, 1e-4), || masonry::heap(500, 1), 3.0),
    solved_both("apart", || masonry::wall(24, 1e-4), || masonry::apart(2000), 3.0),
    solved_both("pieces", || pieces(true), || pieces(false), 1.5),
    solved_both("cube", || cube(5), || cube(10), 20.0),
    not_held("wall_pushed", || masonry::wall(24, 0.0), || pushed(masonry::wall(24, 0.0)), 3.0),
    not_held("chain_pushed", || masonry::chain(2000), || pushed(masonry::chain(2000)), 3.0),
];

const fn solved_both(name: &'static str, base: fn() -> Deck, grown: fn() -> Deck, goal: f64) -> Comparison {
    Comparison { name, base, grown, goal, pushed: false }
}

const fn not_held(name: &'static str, base: fn() -> Deck, grown: fn() -> Deck, goal: f64) -> Comparison {
    Comparison { name, base, grown, goal, pushed: true }
}

/// 432 pieces of two blocks of 40k unknowns, the upper one held or free to slide.
fn pieces(held: bool) -> Deck {
    Pieces { pieces: 6, elements: 3, held }.build()
}

/// A clamped cube on an obstacle, cut into side^3 pieces of 3^3 elements, no two alike.
fn cube(side: usize) -> Deck {
    let mut random = decks::random::Random::new(7);
    let moduli = Moduli::Given((0..side.pow(3)).map(|_| random.between(0.5, 1.5)).collect());
    Cube { subdomains: [side; 3], elements: 3, moduli, ..Cube::default() }.build()
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
        for (k, (deck, times)) in [&base, &grown].into_iter().zip(&mut times).enumerate() {
            let (time, report) = timed(deck, k == 1 && comparison.pushed)?;
            times.push(time);
            if let Some(report) = report.filter(|_| !told) {
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

/// None where nothing is to hold the load, and that is found.
fn timed(deck: &Deck, pushed: bool) -> Result<(f64, Option<Report>), String> {
    let text = |error: Error| format!("{}: {error}", deck.name);
    let mut problem = hand_over::problem(deck).map_err(text)?;
    problem.set_i64("threads", 1).map_err(text)?;
    let clock = Clock::start();
    // as every call of the C interface does
    let _room = problem.working_headroom().map_err(text)?;
    match problem.solve() {
        Ok(report) if !pushed && report.outcome == Outcome::Solved => Ok((clock.lap().cpu, Some(report))),
        Ok(report) => Err(format!("{}: {:?}, {:.1} s", deck.name, report.outcome, clock.lap().cpu)),
        Err(error) if pushed && error.kind == Kind::LoadNotHeld => Ok((clock.lap().cpu, None)),
        Err(error) => Err(text(error)),
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
