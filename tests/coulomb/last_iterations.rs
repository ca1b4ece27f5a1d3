//! The last iterations of a Newton loop: the loads nearly cancel the forces, and what still moves is a small part of what has moved.

use decks::{Deck, Rows};
use feti_contact::solver::{Modes, Outcome, RowKind};

use crate::coulomb::battery::answer;
use crate::coulomb::drawn;
use crate::coulomb::driven::pressed;
use crate::coulomb::judge::Answer;
use crate::support::hand_over;

/// An increment is right if its error is below this part of it, or below this part of what has moved: loads are rounded, and the answer
/// before is known no better.
const RIGHT: f64 = 1e-5;
const ROUNDING: f64 = 1e-10;
/// Forces stay what they are to this part of the largest.
const STEADY: f64 = 1e-7;
/// Forces on a body below this part of its loads are none.
const HELD: f64 = 1e-3;

/// What is left to be solved once the part 1 - `left` of the displacements is there.
fn after(deck: &Deck, u: &[f64], left: f64) -> Deck {
    let mut rest = Deck { name: format!("{} left {left:e}", deck.name), ..deck.clone() };
    let done: Vec<f64> = u.iter().map(|u| (1.0 - left) * u).collect();
    for p in 0..deck.bodies.len() {
        let inside = deck.bodies[p].stiffness.times(&done[deck.offset(p)..deck.offset(p + 1)]);
        rest.bodies[p].load.iter_mut().zip(inside).for_each(|(f, inside)| *f -= inside);
    }
    let shift = |rows: &mut Rows| {
        let moved = rows.matrix.times(&done);
        rows.rhs.iter_mut().zip(moved).for_each(|(rhs, moved)| *rhs -= moved);
    };
    shift(&mut rest.contact);
    shift(&mut rest.equalities);
    shift(&mut rest.friction.rows);
    rest
}

fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most, v| most.max(v.abs()))
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// What is wrong with the increment, if anything. Hosts start from the forces of the last iteration.
fn fault(deck: &Deck, before: &Answer, left: f64, modes: Modes) -> Option<String> {
    let rest = after(deck, &before.u, left);
    let mut problem = hand_over::with_motions(&rest, modes).unwrap();
    for (kind, forces) in [
        (RowKind::Inequality, &before.lambda),
        (RowKind::Equality, &before.mu),
        (RowKind::Tangential, &before.along),
    ] {
        problem.start_from(kind, forces).unwrap();
    }
    let report = match problem.solve() {
        // where a body travels, that is told
        Ok(report) if matches!(report.outcome, Outcome::Solved | Outcome::Marginal) => report,
        Ok(report) => return Some(format!("{:?}, {:e}", report.outcome, report.certificate.worst())),
        Err(error) => return Some(error.to_string()),
    };
    let found = answer(&problem);
    if modes == Modes::Exact {
        // there may be other rests
        let (error, what) = crate::coulomb::judge::worst(&rest, &found);
        return (!(error <= 1e-5)).then(|| format!("{what}: {error:e}"));
    }
    let forces = |of: &Answer| [&of.lambda[..], &of.along, &of.mu].concat();
    let (due, moved): (Vec<f64>, f64) = (before.u.iter().map(|u| left * u).collect(), size(&before.u));
    let (off, allowed) = (distance(&found.u, &due), RIGHT * left * moved + ROUNDING * moved);
    let turned = distance(&forces(&found), &forces(before)) / size(&forces(before));
    let is_right = off <= allowed && turned <= STEADY;
    (!is_right).then(|| {
        format!("{off:e} of {allowed:e}, forces {turned:e}, certificate {:e}", report.certificate.worst())
    })
}

/// Forces hold every floating body: another one is left with the rounding of its loads, which nothing holds.
fn all_held(deck: &Deck, found: &Answer) -> bool {
    let mut reaction = deck.contact.matrix.transpose_times(&found.lambda);
    for more in [
        deck.friction.rows.matrix.transpose_times(&found.along),
        deck.equalities.matrix.transpose_times(&found.mu),
    ] {
        reaction.iter_mut().zip(more).for_each(|(r, more)| *r += more);
    }
    (0..deck.bodies.len()).all(|p| {
        let body = &deck.bodies[p];
        body.modes().is_empty()
            || size(&reaction[deck.offset(p)..deck.offset(p + 1)]) > HELD * size(&body.load)
    })
}

/// The decks whose answer passes, each with its answer.
fn solved(decks: impl Iterator<Item = Deck>, modes: Modes) -> Vec<(Deck, Answer)> {
    let solve = |deck: Deck| {
        let mut problem = hand_over::with_motions(&deck, modes).ok()?;
        let report = problem.solve().ok()?;
        let found = answer(&problem);
        (report.outcome == Outcome::Solved && all_held(&deck, &found)).then_some((deck, found))
    };
    decks.filter_map(solve).collect()
}

fn check(decks: &[(Deck, Answer)], modes: Modes, least: usize) {
    let mut faults = Vec::new();
    for (deck, before) in decks {
        for left in [1e-2, 1e-4, 1e-6, 1e-8] {
            faults.extend(
                fault(deck, before, left, modes).map(|what| format!("{} {left:e}: {what}", deck.name)),
            );
        }
    }
    assert!(
        decks.len() >= least && faults.is_empty(),
        "{} of {}:\n{}",
        faults.len(),
        decks.len(),
        faults.join("\n")
    );
}

#[test]
fn pressed_blocks_with_negative_stiffness_end_their_newton_loops() {
    check(&solved((0..60).map(pressed), Modes::Soft), Modes::Soft, 50);
}

#[test]
fn bodies_with_friction_end_their_newton_loops() {
    let decks = (0..300).map(|seed| {
        let d = drawn::case(seed, &drawn::SIZES).deck;
        Deck { name: format!("{seed} {}", d.name), ..d }
    });
    check(&solved(decks, Modes::Exact), Modes::Exact, 120);
}
