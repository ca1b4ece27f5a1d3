//! Rows that contradict each other contradict each other whatever else the model holds.

use decks::small::Obstacle;
use decks::{Csr, Deck};
use feti_contact::error::Kind;

use crate::scales::plane::{pressed, under_a_wall};
use crate::scales::{answer, distance, problem, Claims};
use crate::support::hand_over;

/// Springs [2 -1; -1 2] under the loads `load`: a body of two unknowns.
fn two_unknowns(load: [f64; 2]) -> Deck {
    let mut body = Obstacle { spring: 1.0, force: 1.0, gap: 1.0 }.build().deck.bodies[0].clone();
    body.stiffness = Csr::from_dense(2, &[2.0, -1.0, -1.0, 2.0]);
    body.load = load.to_vec();
    body.coordinates = vec![[0.0; 3], [1.0, 0.0, 0.0]];
    (body.node, body.direction) = (vec![1, 2], vec![1, 1]);
    Deck::new("two_unknowns", vec![body])
}

/// u_2 = `held`, u_2 <= `bound`, and u_1 <= `far` where there is one; `sign` -1 mirrors the model, `unit` is its length.
fn rows(held: f64, bound: f64, far: Option<f64>, sign: f64, unit: f64) -> Deck {
    let mut deck = two_unknowns([0.3 * sign * unit, 0.1 * sign * unit]);
    deck.equalities.push(&[(1, 1.0)], sign * held * unit);
    deck.contact.push(&[(1, sign)], bound * unit);
    far.into_iter().for_each(|far| deck.contact.push(&[(0, sign)], far * unit));
    deck
}

const FAR: [Option<f64>; 5] = [None, Some(1e12), Some(1e20), Some(1e300), Some(f64::INFINITY)];

fn cases() -> impl Iterator<Item = (Option<f64>, f64, f64)> {
    let units = [1.0, 1e-9, 1e9].into_iter();
    let signed = units.flat_map(|unit| [1.0, -1.0].map(|sign| (sign, unit)));
    signed.flat_map(|(sign, unit)| {
        let finite =
            move |far: &Option<f64>| far.is_none_or(|far| (far * unit).is_finite() || far == f64::INFINITY);
        FAR.into_iter().filter(finite).map(move |far| (far, sign, unit))
    })
}

/// .5 against .1, and against .499.
#[test]
fn an_equality_beyond_a_bound_contradicts_it_whatever_is_far_away() {
    let mut claims = Claims::default();
    for ((far, sign, unit), bound) in cases().flat_map(|case| [0.1, 0.499].map(|bound| (case, bound))) {
        let what = format!("far {far:?}, sign {sign}, unit {unit:e}, bound {bound}");
        let got = hand_over::problem(&rows(0.5, bound, far, sign, unit)).and_then(|mut p| answer(&mut p));
        match got {
            Ok(found) => claims.claim(false, || {
                let through = (found.u[1] * sign / unit - bound) / bound;
                format!("{what}: {:?}, penetration {through:.1e} of the bound", found.report.outcome)
            }),
            Err(error) => claims.claim(error.kind == Kind::GapsContradict, || format!("{what}: {error}")),
        }
    }
    claims.end();
}

/// Bounds of .5 and one unit in the last place beside it, and bounds that leave room. By hand u_2 = .5 and
/// u_1 = (.3 + .5) / 2 = .4.
#[test]
fn an_equality_at_a_bound_to_rounding_is_solved_whatever_is_far_away() {
    let mut claims = Claims::default();
    let beside = [0.5, 0.5 * (1.0 - f64::EPSILON / 2.0), 0.5 * (1.0 + f64::EPSILON), 0.5 + 1e-3];
    for ((far, sign, unit), bound) in cases().flat_map(|case| beside.map(|bound| (case, bound))) {
        let what = format!("far {far:?}, sign {sign}, unit {unit:e}, bound {bound:.17}");
        let mut problem = match hand_over::problem(&rows(0.5, bound, far, sign, unit)) {
            Ok(problem) => problem,
            Err(error) => {
                claims.claim(false, || format!("{what}: {error}"));
                continue;
            }
        };
        if let Some(found) = claims.solved(&mut problem, &what) {
            let expected = [0.4 * sign * unit, 0.5 * sign * unit];
            claims.at_most(distance(&found.u, &expected) / unit, 1e-12, &format!("{what}, u"));
            // mu = f_2 - K_2 u - lambda by hand, of which a bound at .5 may carry a part: (.1 + .4 - 1) sign
            let sum = found.mu[0] + sign * found.lambda[0] - sign * unit * (0.1 + 0.4 - 1.0);
            claims.at_most(sum.abs() / unit, 1e-12, &format!("{what}, forces"));
        }
    }
    claims.end();
}

/// Two bounds from both sides: -u_2 <= -.5 and u_2 <= .1.
#[test]
fn bounds_from_both_sides_contradict_each_other_whatever_is_far_away() {
    let mut claims = Claims::default();
    for (far, sign, unit) in cases() {
        let mut deck = rows(0.5, 0.1, far, sign, unit);
        deck.equalities = decks::Rows::none(2);
        deck.contact.push(&[(1, -sign)], -0.5 * unit);
        let got = hand_over::problem(&deck).and_then(|mut p| answer(&mut p));
        let kind = got.as_ref().err().map(|error| error.kind);
        let found = got.as_ref().map(|found| found.report.outcome);
        claims.claim(kind == Some(Kind::GapsContradict), || {
            format!("far {far:?}, sign {sign}, unit {unit:e}: {found:?}")
        });
    }
    claims.end();
}

/// The same among 40 thousand unknowns: one unknown at the top of a block, held 1e-3 beyond its bound, which is about a
/// third of what the block deforms.
#[test]
fn an_equality_beyond_a_bound_contradicts_it_among_40_thousand_unknowns() {
    let mut deck = under_a_wall(140, 140);
    let first = deck.contact.matrix.row(0).next().unwrap().0;
    deck.equalities.push(&[(first, 1.0)], deck.contact.rhs[0] + 1e-3);
    deck.contact.push(&[(first - 2 * 70 * 141, 1.0)], 1e12);
    let error = problem(&deck).solve().map(|report| format!("{report:?}")).unwrap_err();
    assert_eq!(error.kind, Kind::GapsContradict, "{error}");
}

/// The travel of a free body is one thing, the contradiction of two rows of another body a different one.
#[test]
fn an_equality_beyond_a_bound_contradicts_it_beside_a_body_that_travels() {
    let mut deck = pressed(10, 4, 1e9);
    let side = deck.bodies[0].dofs() / 2;
    deck.equalities.push(&[(side, 1.0)], 5e-3);
    deck.contact.push(&[(side, 1.0)], 1e-3);
    let error = problem(&deck).solve().map(|report| format!("{report:?}")).unwrap_err();
    assert_eq!(error.kind, Kind::GapsContradict, "{error}");
}
