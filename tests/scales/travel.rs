//! One free body that travels far before it touches: accuracy is relative to deformation, travel excuses rounding only.

use decks::small::Obstacle;
use decks::{Body, Csr, Deck};
use feti_contact::solver::Problem;

use crate::scales::plane::pressed;
use crate::scales::{add, difference, distance, dot, largest, problem, solved, Answer, Claims};

/// Length; the blocks deform by about 1e-2.
const TRAVELS: [f64; 3] = [0.0, 100.0, 1e4];
const TOLERANCES: [f64; 2] = [1e-12, 1e-8];

/// A spring s between two unknowns, free to move, pushed by f_1 and f_2 onto ground springs k_1 and k_2 that are a travel
/// away: u_i - w_i <= travel. With d = u_1 - u_2: d (1 + s/k_1 + s/k_2) = f_1/k_1 - f_2/k_2, lambda_1 = f_1 - s d,
/// lambda_2 = f_2 + s d, w_i = lambda_i / k_i, u_i = travel + w_i.
struct TwoLegs {
    deck: Deck,
    u: [f64; 4],
    lambda: [f64; 2],
}

const SPRING: f64 = 50.0;
const GROUND: [f64; 2] = [100.0, 300.0];
const LOADS: [f64; 2] = [1.0, 0.5];

fn two_legs(travel: f64) -> TwoLegs {
    let (s, [k1, k2], [f1, f2]) = (SPRING, GROUND, LOADS);
    let ground = |k: f64| Obstacle { spring: k, force: 0.0, gap: 1.0 }.build().deck.bodies[0].clone();
    let bar = Body {
        stiffness: Csr::from_dense(2, &[s, -s, -s, s]),
        null_space: Some(vec![vec![1.0, 1.0]]),
        load: LOADS.to_vec(),
        coordinates: vec![[0.0; 3]; 2],
        node: vec![1, 2],
        direction: vec![1; 2],
    };
    let mut deck = Deck::new("two_legs", vec![bar, ground(k1), ground(k2)]);
    (0..2).for_each(|i| deck.contact.push(&[(i, 1.0), (2 + i, -1.0)], travel));
    let d = (f1 / k1 - f2 / k2) / (1.0 + s / k1 + s / k2);
    let lambda = [f1 - s * d, f2 + s * d];
    let w = [lambda[0] / k1, lambda[1] / k2];
    TwoLegs { deck, u: [travel + w[0], travel + w[1], w[0], w[1]], lambda }
}

fn with_tolerance(deck: &Deck, tolerance: f64) -> Problem {
    let mut problem = problem(deck);
    problem.set_f64("tolerance", tolerance).unwrap();
    problem
}

#[test]
fn forces_of_two_legs_that_travel_are_those_by_hand() {
    let mut claims = Claims::default();
    for (travel, tolerance) in TRAVELS.iter().flat_map(|travel| TOLERANCES.map(|tol| (*travel, tol))) {
        let (legs, what) = (two_legs(travel), format!("travel {travel:e}, tolerance {tolerance:e}"));
        if let Some(found) = claims.solved(&mut with_tolerance(&legs.deck, tolerance), &what) {
            claims.at_most(difference(&found.lambda, &legs.lambda), 1e-6, &format!("{what}, forces"));
            let limit = 1e-6 * legs.u[2] + 4.0 * f64::EPSILON * travel;
            claims.at_most(distance(&found.u, &legs.u), limit, &format!("{what}, u"));
        }
    }
    claims.end();
}

/// The plane blocks with a travel, and the answer of the same blocks that touch from the start: the forces are the same,
/// and so is u but for the travel of the upper block. A loose tolerance costs them no more than it costs those that touch.
fn assert_shifted(across: usize, rows: usize, travels: &[f64]) {
    let mut claims = Claims::default();
    let near = pressed(across, rows, 0.0);
    let expected = solved(&mut problem(&near));
    for (travel, tolerance) in travels.iter().flat_map(|travel| TOLERANCES.map(|tol| (*travel, tol))) {
        let what = format!("travel {travel:e}, tolerance {tolerance:e}");
        let deck = pressed(across, rows, travel);
        if let Some(found) = claims.solved(&mut with_tolerance(&deck, tolerance), &what) {
            let loose = solved(&mut with_tolerance(&near, tolerance));
            let allowed = (3.0 * difference(&loose.lambda, &expected.lambda)).max(1e-6);
            claims.at_most(difference(&found.lambda, &expected.lambda), allowed, &format!("{what}, forces"));
            let back = moved(&near, &found.u, travel);
            claims.at_most(difference(&back, &expected.u), 1e-6, &format!("{what}, u"));
        }
    }
    claims.end();
}

/// u with the upper block moved up.
fn moved(deck: &Deck, u: &[f64], by: f64) -> Vec<f64> {
    let (mut moved, offset) = (u.to_vec(), deck.offset(1));
    moved[offset..].iter_mut().skip(1).step_by(2).for_each(|u| *u += by);
    moved
}

#[test]
fn forces_of_blocks_that_travel_are_those_of_blocks_that_touch() {
    assert_shifted(16, 8, &TRAVELS);
}

#[test]
fn forces_of_blocks_of_40_thousand_unknowns_that_travel_are_those_of_blocks_that_touch() {
    assert_shifted(100, 100, &[100.0, 1e4]);
}

/// The answer of the blocks that touch, moved by the travel: right to rounding of the travel.
fn right(travel: f64) -> (Deck, Answer) {
    let near = pressed(16, 8, 0.0);
    let mut answer = solved(&mut problem(&near));
    answer.u = moved(&near, &answer.u, -travel);
    (pressed(16, 8, travel), answer)
}

#[test]
fn the_right_answer_is_accepted_after_a_travel() {
    let mut claims = Claims::default();
    for travel in TRAVELS {
        let (deck, answer) = right(travel);
        let certificate = problem(&deck).check(&answer.u, &answer.lambda, &answer.mu).unwrap();
        claims
            .claim(certificate.passed(), || format!("travel {travel:e}: worst {:.1e}", certificate.worst()));
        let legs = two_legs(travel);
        let certificate = problem(&legs.deck).check(&legs.u, &legs.lambda, &[]).unwrap();
        claims.claim(certificate.passed(), || {
            format!("two legs, travel {travel:e}: worst {:.1e}", certificate.worst())
        });
    }
    claims.end();
}

/// Refusal of these forces with u as it is.
fn assert_refused(wrong: impl Fn(&[f64]) -> Vec<Vec<f64>>) {
    let mut claims = Claims::default();
    for travel in TRAVELS {
        let (deck, answer) = right(travel);
        let mut problem = problem(&deck);
        for (k, lambda) in wrong(&answer.lambda).iter().enumerate() {
            let certificate = problem.check(&answer.u, lambda, &answer.mu).unwrap();
            let worst = certificate.worst();
            claims.claim(!certificate.passed(), || format!("travel {travel:e}, lie {k}: worst {worst:.1e}"));
        }
    }
    claims.end();
}

#[test]
fn forces_wrong_by_1e_4_are_refused_after_a_travel() {
    assert_refused(|lambda| vec![lambda.iter().map(|l| l * (1.0 + 1e-4)).collect()]);
}

/// Every force of at least 1e-5 of the largest, one by one.
#[test]
fn forces_with_one_row_left_out_are_refused_after_a_travel() {
    assert_refused(|lambda| {
        let counts = (0..lambda.len()).filter(|i| lambda[*i] >= 1e-5 * largest(lambda));
        let without = |i: usize| {
            let mut wrong = lambda.to_vec();
            wrong[i] = 0.0;
            wrong
        };
        counts.map(without).collect()
    });
}

/// Forces that are wrong by `share` of themselves in a way that leaves every body in balance, and u as it is under them:
/// only the gaps of the rows tell, and they are wrong by that share of the deformation.
#[test]
fn forces_in_balance_that_are_wrong_are_refused_after_a_travel() {
    let mut claims = Claims::default();
    for (travel, share) in
        TRAVELS.iter().flat_map(|travel| [1.0, 0.1, 1e-2, 1e-4].map(|share| (*travel, share)))
    {
        let (deck, answer) = right(travel);
        let mut problem = problem(&deck);
        let force = in_balance(&answer.lambda, share);
        let wrong: Vec<f64> = answer.lambda.iter().zip(&force).map(|(l, d)| l + d).collect();
        let (mut u, push) = (answer.u.clone(), deck.contact.matrix.transpose_times(&force));
        for p in 0..2 {
            let range = deck.offset(p)..deck.offset(p + 1);
            let mut bent = vec![0.0; range.len()];
            problem.kplus(p, &push[range.clone()], &mut bent).unwrap();
            add(-1.0, &bent, &mut u[range]);
        }
        settle(&deck, &mut u, &answer.lambda);
        let certificate = problem.check(&u, &wrong, &answer.mu).unwrap();
        claims.claim(!certificate.passed(), || {
            format!("travel {travel:e}, forces off by {share:e}: worst {:.1e}", certificate.worst())
        });
    }
    claims.end();
}

/// A self-equilibrated change of the forces on three closed rows next to each other: weights 1, -2, 1 of `share` times half
/// of the smallest of the three, which is the largest such change that keeps every sign for a share of 1.
fn in_balance(lambda: &[f64], share: f64) -> Vec<f64> {
    let least = |i: usize| lambda[i].min(lambda[i + 1]).min(lambda[i + 2]);
    let first = (0..lambda.len() - 2).max_by(|i, j| least(*i).total_cmp(&least(*j))).unwrap();
    let mut change = vec![0.0; lambda.len()];
    let size = 0.5 * share * least(first);
    [1.0, -2.0, 1.0].iter().enumerate().for_each(|(i, weight)| change[first + i] = weight * size);
    assert!(size > 1e-3 * share * largest(lambda), "three closed rows next to each other");
    change
}

/// Moves the upper block rigidly so that its equality row holds and its closed rows touch in the mean and do not turn.
fn settle(deck: &Deck, u: &mut [f64], lambda: &[f64]) {
    let (offset, modes) = (deck.offset(1), deck.bodies[1].modes());
    let slide = u[offset];
    u[offset..].iter_mut().step_by(2).for_each(|u| *u -= slide);
    let closed: Vec<usize> = (0..lambda.len()).filter(|i| lambda[*i] > 1e-5 * largest(lambda)).collect();
    // least squares of open + a + b x over the closed rows, x that of the mode about the centre
    let turn: Vec<f64> = {
        let mut v = vec![0.0; deck.dofs()];
        v[offset..].copy_from_slice(&modes[2]);
        deck.contact.matrix.times(&v)
    };
    let moved = deck.contact.matrix.times(u);
    let over: Vec<f64> = closed.iter().map(|i| moved[*i] - deck.contact.rhs[*i]).collect();
    let arm: Vec<f64> = closed.iter().map(|i| turn[*i]).collect();
    let n = closed.len() as f64;
    let (mean, middle) = (over.iter().sum::<f64>() / n, arm.iter().sum::<f64>() / n);
    let centred: Vec<f64> = arm.iter().map(|a| a - middle).collect();
    let slope = dot(&centred, &over) / dot(&centred, &centred);
    let lift = mean - slope * middle;
    u[offset..].iter_mut().skip(1).step_by(2).for_each(|u| *u += lift);
    add(-slope, &modes[2], &mut u[offset..]);
    let slide = u[offset];
    u[offset..].iter_mut().step_by(2).for_each(|u| *u -= slide);
}

/// The same for the two legs: lambda_1 + e, lambda_2 - e, and all displacements by hand, row 1 closed. Row 2 is then off by
/// e (1/s + 1/k_1 + 1/k_2).
#[test]
fn forces_of_two_legs_in_balance_that_are_wrong_are_refused_after_a_travel() {
    let mut claims = Claims::default();
    for (travel, share) in TRAVELS.iter().flat_map(|travel| [1.3, 1e-2, 1e-4].map(|share| (*travel, share))) {
        for sign in [1.0, -1.0] {
            let legs = two_legs(travel);
            let e = sign * share * legs.lambda[1].min(legs.lambda[0]) / 1.4;
            let lambda = [legs.lambda[0] + e, legs.lambda[1] - e];
            let w = [lambda[0] / GROUND[0], lambda[1] / GROUND[1]];
            let first = travel + w[0];
            let u = [first, first - (LOADS[0] - lambda[0]) / SPRING, w[0], w[1]];
            let certificate = problem(&legs.deck).check(&u, &lambda, &[]).unwrap();
            claims.claim(!certificate.passed(), || {
                format!("travel {travel:e}, forces off by {e:.1e}: worst {:.1e}", certificate.worst())
            });
        }
    }
    claims.end();
}
