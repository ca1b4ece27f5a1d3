//! One more row, so far away that it never closes, as legacy codes mark "no partner": it must change nothing.

use decks::{Deck, Rows};
use feti_contact::solver::{Problem, RowKind};

use crate::scales::plane::{pressed, under_a_wall};
use crate::scales::{difference, distance, largest, problem, solved, Claims};
use crate::support::hand_over;

/// Gaps of the far row, length; the displacements are about 1e-2.
const GAPS: [f64; 6] = [1e8, 1e12, 1e20, 1e30, 1e300, f64::INFINITY];

/// Unknowns across a model: 41 contact rows.
const ACROSS: usize = 40;

fn wall() -> Deck {
    under_a_wall(ACROSS, 10)
}

fn floating() -> Deck {
    pressed(ACROSS, 6, 0.0)
}

/// The deck with u_dof <= gap as its last row.
fn with_far_row(deck: &Deck, dof: usize, gap: f64) -> Deck {
    let mut far = deck.clone();
    far.contact.push(&[(dof, 1.0)], gap);
    far
}

/// The answer with the far row is that without it, under the same options.
fn assert_changes_nothing(deck: &Deck, dof: usize, gaps: &[f64], options: impl Fn(&mut Problem)) {
    let mut claims = Claims::default();
    let mut without = problem(deck);
    options(&mut without);
    let expected = solved(&mut without);
    assert!(expected.report.active > 5, "{:?}", expected.report);
    for gap in gaps {
        let what = format!("gap {gap:e}");
        let mut with = match hand_over::problem(&with_far_row(deck, dof, *gap)) {
            Ok(problem) => problem,
            Err(error) => {
                claims.claim(false, || format!("{what}: {error}"));
                continue;
            }
        };
        options(&mut with);
        if let Some(found) = claims.solved(&mut with, &what) {
            let (far, near) = found.lambda.split_last().unwrap();
            claims.claim(*far == 0.0, || format!("{what}: the far row carries {far:e}"));
            claims.at_most(difference(near, &expected.lambda), 1e-10, &format!("{what}, forces"));
            claims.at_most(difference(&found.u, &expected.u), 1e-10, &format!("{what}, u"));
            claims.claim(found.report.active == expected.report.active, || {
                format!("{what}: {} rows closed, not {}", found.report.active, expected.report.active)
            });
            let scale = expected.report.gap_scale;
            let off = (found.report.gap_scale / scale - 1.0).abs();
            claims.at_most(off, 1.0, &format!("{what}, scale of the gaps"));
        }
    }
    claims.end();
}

/// A side node of the first body.
fn side(deck: &Deck) -> usize {
    deck.bodies[0].dofs() / 2
}

#[test]
fn a_far_row_changes_nothing() {
    assert_changes_nothing(&wall(), side(&wall()), &GAPS, |_| {});
}

#[test]
fn a_far_row_changes_nothing_under_a_loose_tolerance() {
    assert_changes_nothing(&wall(), side(&wall()), &GAPS, |p| p.set_f64("tolerance", 1e-8).unwrap());
}

#[test]
fn a_far_row_changes_nothing_without_the_direct_method() {
    assert_changes_nothing(&wall(), side(&wall()), &GAPS, |p| p.set_i64("direct_limit", 0).unwrap());
}

#[test]
fn a_far_row_changes_nothing_under_a_loose_tolerance_without_the_direct_method() {
    assert_changes_nothing(&wall(), side(&wall()), &GAPS, |p| {
        p.set_f64("tolerance", 1e-8).unwrap();
        p.set_i64("direct_limit", 0).unwrap();
    });
}

#[test]
fn a_far_row_of_a_held_block_changes_nothing_for_the_floating_block_pressed_on_it() {
    assert_changes_nothing(&floating(), side(&floating()), &GAPS, |_| {});
    assert_changes_nothing(&floating(), side(&floating()), &GAPS, |p| p.set_f64("tolerance", 1e-8).unwrap());
}

/// The last unknown: a corner of the top of the floating block, vertical.
#[test]
fn a_far_row_of_a_floating_block_changes_nothing() {
    let deck = floating();
    assert_changes_nothing(&deck, deck.dofs() - 1, &GAPS, |_| {});
    assert_changes_nothing(&deck, deck.dofs() - 1, &GAPS, |p| p.set_i64("direct_limit", 0).unwrap());
}

/// Solved as far as rounding allows: one more column in F rounds the others otherwise, and with the default the forces are
/// known to 3e-10, with the far row and without it.
#[test]
fn a_far_row_changes_nothing_among_40_thousand_unknowns() {
    let deck = under_a_wall(140, 140);
    assert_changes_nothing(&deck, side(&deck), &[1e12, 1e30, f64::INFINITY], |p| {
        p.set_f64("tolerance", 1e-14).unwrap();
    });
}

/// What the loads alone do, without a row.
fn without_rows(deck: &Deck) -> Vec<f64> {
    let none = Rows::none(deck.dofs());
    let alone = Deck { contact: none.clone(), equalities: none, ..deck.clone() };
    solved(&mut problem(&alone)).u
}

#[test]
fn the_answer_without_contact_is_refused_beside_a_far_row() {
    let mut claims = Claims::default();
    let deck = wall();
    let free = without_rows(&deck);
    let moved = deck.contact.matrix.times(&free);
    let depth = moved.iter().zip(&deck.contact.rhs).map(|(u, c)| u - c);
    assert!(depth.fold(0.0, f64::max) > 0.1 * largest(&free), "the loads close the gap");
    for gap in GAPS {
        let Ok(mut far) = hand_over::problem(&with_far_row(&deck, side(&deck), gap)) else {
            claims.claim(false, || format!("gap {gap:e} is not accepted"));
            continue;
        };
        let certificate = far.check(&free, &vec![0.0; ACROSS + 2], &[]).unwrap();
        claims.claim(!certificate.passed(), || {
            format!("gap {gap:e}: no contact at all passes, worst {:.1e}", certificate.worst())
        });
    }
    claims.end();
}

/// With the force 0 for the far row.
#[test]
fn the_right_answer_is_accepted_beside_a_far_row() {
    let mut claims = Claims::default();
    for deck in [wall(), floating()] {
        let right = solved(&mut problem(&deck));
        let lambda: Vec<f64> = right.lambda.iter().copied().chain([0.0]).collect();
        for gap in GAPS {
            let Ok(mut far) = hand_over::problem(&with_far_row(&deck, side(&deck), gap)) else {
                claims.claim(false, || format!("gap {gap:e} is not accepted"));
                continue;
            };
            let certificate = far.check(&right.u, &lambda, &right.mu).unwrap();
            claims.claim(certificate.passed(), || format!("gap {gap:e}: worst {:.1e}", certificate.worst()));
        }
    }
    claims.end();
}

/// A far row that carries a force of 1e-4 of the largest, with u as it must be under that force.
#[test]
fn a_force_on_a_far_row_is_refused() {
    let mut claims = Claims::default();
    let deck = wall();
    let right = solved(&mut problem(&deck));
    let force = 1e-4 * largest(&right.lambda);
    for gap in GAPS {
        let Ok(mut far) = hand_over::problem(&with_far_row(&deck, side(&deck), gap)) else {
            claims.claim(false, || format!("gap {gap:e} is not accepted"));
            continue;
        };
        let (mut push, mut moved) = (vec![0.0; deck.dofs()], vec![0.0; deck.dofs()]);
        push[side(&deck)] = force;
        far.kplus(0, &push, &mut moved).unwrap();
        let u: Vec<f64> = right.u.iter().zip(&moved).map(|(u, m)| u - m).collect();
        assert!(distance(&u, &right.u) > 0.0);
        let lambda: Vec<f64> = right.lambda.iter().copied().chain([force]).collect();
        let certificate = far.check(&u, &lambda, &right.mu).unwrap();
        claims.claim(!certificate.passed(), || {
            format!("gap {gap:e}: passes, worst {:.1e}", certificate.worst())
        });
    }
    claims.end();
}

/// The gap of a row becomes "never" and comes back, as partners are lost and found between load steps.
#[test]
fn a_row_may_lose_its_partner_and_find_it_again() {
    let deck = wall();
    let mut problem = problem(&deck);
    let before = solved(&mut problem);
    let last = deck.contact.len() - 1;
    problem.set_rhs(RowKind::Inequality, last, &[f64::INFINITY]).unwrap();
    solved(&mut problem);
    problem.set_rhs(RowKind::Inequality, last, &[deck.contact.rhs[last]]).unwrap();
    assert_eq!(solved(&mut problem).lambda, before.lambda);
}
