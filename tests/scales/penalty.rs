//! Displacements prescribed by penalty: K_ii += 1e20 and f_i = 1e20 u0 hide no wrong force. The same blocks with the
//! prescribed unknowns eliminated are the reference.

use decks::{Deck, Rows};
use feti_contact::solver::Problem;

use crate::scales::plane::{not_held, under_a_wall};
use crate::scales::{add, difference, problem, solved, Answer, Claims};

const PENALTY: f64 = 1e20;

/// Displacement of the bottom at x: to the right, and up by an amount that changes along x and is nowhere 0.
fn prescribed(shift: f64, dof: usize, x: f64) -> f64 {
    if dof % 2 == 0 {
        shift
    } else {
        0.1 * shift * (1.0 + x)
    }
}

/// Unknowns of the bottom: the first 2 (across + 1), with the values they are to have.
fn bottom(deck: &Deck, across: usize, shift: f64) -> Vec<f64> {
    (0..2 * (across + 1)).map(|dof| prescribed(shift, dof, deck.bodies[0].coordinates[dof][0])).collect()
}

/// The block with its bottom prescribed by penalty.
fn by_penalty(across: usize, rows: usize, shift: f64) -> Deck {
    let mut deck = not_held(across, rows);
    let values = bottom(&deck, across, shift);
    let body = &mut deck.bodies[0];
    body.null_space = None;
    for (i, value) in values.iter().enumerate() {
        let row = body.stiffness.ptr[i]..body.stiffness.ptr[i + 1];
        let diagonal = row.start + body.stiffness.col[row].iter().position(|j| *j == i).unwrap();
        body.stiffness.val[diagonal] += PENALTY;
        body.load[i] = PENALTY * value;
    }
    deck
}

/// The same with the bottom eliminated: the load gains -K_fb u_b.
fn eliminated(across: usize, rows: usize, shift: f64) -> Deck {
    let (whole, mut deck) = (not_held(across, rows), under_a_wall(across, rows));
    let values = bottom(&whole, across, shift);
    let mut u = vec![0.0; whole.dofs()];
    u[..values.len()].copy_from_slice(&values);
    let push = whole.bodies[0].stiffness.times(&u);
    add(-1.0, &push[values.len()..], &mut deck.bodies[0].load);
    deck
}

/// The answer without penalty, the bottom where it is prescribed.
fn reference(across: usize, rows: usize, shift: f64) -> Answer {
    let mut answer = solved(&mut problem(&eliminated(across, rows, shift)));
    assert!(answer.report.active > 3, "{:?}", answer.report);
    answer.u.splice(0..0, bottom(&not_held(across, rows), across, shift));
    answer
}

const SHIFTS: [f64; 3] = [0.0, 0.003, -0.03];

fn assert_right(across: usize, rows: usize, options: impl Fn(&mut Problem)) {
    let mut claims = Claims::default();
    for shift in SHIFTS {
        let (expected, what) = (reference(across, rows, shift), format!("shift {shift}"));
        let mut penalty = problem(&by_penalty(across, rows, shift));
        options(&mut penalty);
        if let Some(found) = claims.solved(&mut penalty, &what) {
            claims.at_most(difference(&found.lambda, &expected.lambda), 1e-8, &format!("{what}, forces"));
            claims.at_most(difference(&found.u, &expected.u), 1e-8, &format!("{what}, u"));
        }
    }
    claims.end();
}

#[test]
fn forces_of_a_block_held_by_penalty_are_those_of_one_held() {
    assert_right(20, 6, |_| {});
}

#[test]
fn forces_of_a_block_held_by_penalty_are_those_of_one_held_without_the_direct_method() {
    assert_right(20, 6, |p| p.set_i64("direct_limit", 0).unwrap());
}

#[test]
fn forces_of_a_block_of_40_thousand_unknowns_held_by_penalty_are_those_of_one_held() {
    assert_right(140, 140, |_| {});
}

/// Both the answer of the solve and that of the block held, in which no force acts on the bottom: the reaction there is less
/// than rounding of the penalty.
#[test]
fn the_right_answer_is_accepted_with_penalty_supports() {
    let mut claims = Claims::default();
    for shift in SHIFTS {
        let mut penalty = problem(&by_penalty(20, 6, shift));
        let own = solved(&mut penalty);
        let certificate = penalty.check(&own.u, &own.lambda, &[]).unwrap();
        claims
            .claim(certificate.passed(), || format!("shift {shift}, own: worst {:.1e}", certificate.worst()));
        // without shift the bottom moves by the reaction over the penalty, which is not in this answer
        if shift != 0.0 {
            let other = reference(20, 6, shift);
            let certificate = penalty.check(&other.u, &other.lambda, &[]).unwrap();
            claims.claim(certificate.passed(), || {
                format!("shift {shift}, held: worst {:.1e}", certificate.worst())
            });
        }
    }
    claims.end();
}

/// With u as it is; with u = K^-1 (f - B' 1.5 lambda), so that only the rows tell; and without any force, u = K^-1 f.
#[test]
fn wrong_forces_are_refused_with_penalty_supports() {
    let mut claims = Claims::default();
    for (shift, factor) in
        SHIFTS.iter().flat_map(|shift| [1.5, 1.0 + 1e-5, 0.0].map(|factor| (*shift, factor)))
    {
        let deck = by_penalty(20, 6, shift);
        let right = solved(&mut problem(&deck));
        let wrong: Vec<f64> = right.lambda.iter().map(|l| factor * l).collect();
        let mut alone = Deck { contact: Rows::none(deck.dofs()), ..deck.clone() };
        add(-1.0, &deck.contact.matrix.transpose_times(&wrong), &mut alone.bodies[0].load);
        let bent = solved(&mut problem(&alone)).u;
        for (u, kind) in [(&right.u, "u kept"), (&bent, "u under them")] {
            let certificate = problem(&deck).check(u, &wrong, &[]).unwrap();
            claims.claim(!certificate.passed(), || {
                format!("shift {shift}, lambda x {factor}, {kind}: worst {:.1e}", certificate.worst())
            });
        }
    }
    claims.end();
}
