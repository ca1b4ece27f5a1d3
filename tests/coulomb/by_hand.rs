//! Problems that are solved by hand.

use decks::{Body, Csr, Deck};
use feti_contact::error::{Kind, Proof};
use feti_contact::solver::{FrictionState, Outcome, Problem, RowKind};

use crate::support::hand_over;

/// A point on springs `k` along x and y, pressed onto a wall below by `press` and pushed along it by `push`: contact row
/// `-u_y <= 0`, tangential row `u_x`.
fn point(k: [f64; 2], press: f64, push: f64, mu: f64, bound: f64) -> Deck {
    let mut stiffness = Csr::empty(2);
    stiffness.push_row(&[(0, k[0])]);
    stiffness.push_row(&[(1, k[1])]);
    let null_space =
        (0..2).filter(|&i| k[i] == 0.0).map(|i| vec![[1.0, 0.0][i], [0.0, 1.0][i]]).collect::<Vec<_>>();
    let body = Body {
        stiffness,
        null_space: Some(null_space).filter(|modes| !modes.is_empty()),
        load: vec![push, -press],
        coordinates: vec![[0.0; 3]; 2],
        node: vec![1; 2],
        direction: vec![1, 2],
    };
    let mut deck = Deck::new("point", vec![body]);
    deck.contact.push(&[(1, -1.0)], 0.0);
    deck.friction.push(Some(0), &[&[(0, 1.0)]], mu, bound);
    deck
}

fn solved(deck: &Deck) -> Problem {
    let mut problem = hand_over::problem(deck).unwrap();
    let report = problem.solve().unwrap();
    assert_eq!(report.outcome, Outcome::Solved, "{:?}", report.certificate);
    problem
}

fn near(found: &[f64], wanted: &[f64]) {
    let size = wanted.iter().fold(1e-3, |most: f64, v| most.max(v.abs()));
    assert_eq!(found.len(), wanted.len());
    assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= 1e-10 * size), "{found:?} for {wanted:?}");
}

#[test]
fn a_point_sticks_below_mu_and_slips_above() {
    for (push, state, force) in
        [(0.4, FrictionState::Stick, 0.4), (0.8, FrictionState::Slip, 0.5), (-0.8, FrictionState::Slip, -0.5)]
    {
        let problem = solved(&point([2.0, 3.0], 1.0, push, 0.5, 0.0));
        near(problem.multipliers(RowKind::Inequality).unwrap(), &[1.0]);
        near(problem.multipliers(RowKind::Tangential).unwrap(), &[force]);
        near(problem.displacements().unwrap(), &[(push - force) / 2.0, 0.0]);
        near(problem.slips().unwrap(), &[(push - force) / 2.0]);
        assert_eq!(problem.friction_states().unwrap(), [state], "{push}");
    }
}

#[test]
fn a_point_without_springs_is_held_by_friction_up_to_mu() {
    let problem = solved(&point([0.0, 0.0], 1.0, 0.49999, 0.5, 0.0));
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[0.49999]);
    let error = hand_over::problem(&point([0.0, 0.0], 1.0, 0.50001, 0.5, 0.0)).unwrap().solve().unwrap_err();
    assert_eq!(error.kind, Kind::LoadNotHeld, "{error}");
}

/// The spring across the wall could press as much as friction needs: that it does not is known by no balance of forces.
#[test]
fn a_point_on_a_spring_across_the_wall_slides_beyond_mu() {
    let problem = solved(&point([0.0, 3.0], 1.0, 0.49999, 0.5, 0.0));
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[0.49999]);
    let mut problem = hand_over::problem(&point([0.0, 3.0], 1.0, 0.625, 0.5, 0.0)).unwrap();
    let error = problem.solve().unwrap_err();
    assert_eq!((error.kind, error.place.body, error.place.dof), (Kind::Slides, Some(0), Some(0)), "{error}");
    let capacity = problem.findings().unwrap().capacity.unwrap();
    assert!((capacity - 0.8).abs() < 1e-10, "{capacity}");
}

/// Lifted off the wall, and held by no spring along it: friction of an open node holds no motion.
#[test]
fn a_point_is_free_along_a_wall_that_it_does_not_touch() {
    for (press, state, free) in [(-1.0, FrictionState::Open, 1), (1.0, FrictionState::Stick, 0)] {
        let problem = solved(&point([0.0, 3.0], press, 0.0, 0.5, 0.0));
        assert_eq!(problem.friction_states().unwrap(), [state]);
        assert_eq!(problem.report().unwrap().undetermined, free, "{press}");
        near(problem.displacements().unwrap(), &[0.0, (-press).max(0.0) / 3.0]);
    }
}

/// A train of two cars: springs within them, a joint between them, the load on the second, the brake on the first.
#[test]
fn the_motion_of_a_slide_keeps_joints_and_its_capacity_is_right() {
    let car = |k: f64, load: [f64; 2]| Body {
        stiffness: [[(0, k), (1, -k)], [(0, -k), (1, k)]].iter().fold(Csr::empty(2), |mut own, row| {
            own.push_row(row);
            own
        }),
        null_space: Some(vec![vec![1.0, 1.0]]),
        load: load.to_vec(),
        coordinates: vec![[0.0; 3]; 2],
        node: vec![1, 2],
        direction: vec![1, 1],
    };
    let wheel = point([0.0, 3.0], 1.0, 0.0, 0.5, 0.0).bodies.remove(0);
    let mut deck = Deck::new("train", vec![wheel, car(2.0, [0.0, 0.0]), car(7.0, [0.0, 0.625])]);
    deck.contact.push(&[(1, -1.0)], 0.0);
    deck.friction.push(Some(0), &[&[(0, 1.0)]], 0.5, 0.0);
    deck.equalities.push(&[(0, 1.0), (2, -1.0)], 0.0);
    deck.equalities.push(&[(3, 1.0), (4, -1.0)], 0.0);
    let mut problem = hand_over::problem(&deck).unwrap();
    let error = problem.solve().unwrap_err();
    assert_eq!(error.kind, Kind::Slides, "{error}");
    let findings = problem.findings().unwrap();
    assert!((findings.capacity.unwrap() - 0.8).abs() < 1e-7, "{:?}", findings.capacity);
    let Some(Proof::Motion { v: motion, .. }) = &findings.proof else { panic!("{:?}", findings.proof) };
    assert!((motion[0] - motion[2]).abs() < 1e-7 && (motion[3] - motion[4]).abs() < 1e-7, "{motion:?}");
    assert!(motion[0].abs() > 0.5 && motion[1] == 0.0, "{motion:?}");
}

#[test]
fn a_bound_acts_at_an_open_point_too() {
    let problem = solved(&point([2.0, 3.0], -1.0, 0.8, 0.5, 0.3));
    near(problem.multipliers(RowKind::Inequality).unwrap(), &[0.0]);
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[0.3]);
    near(problem.displacements().unwrap(), &[0.25, 1.0 / 3.0]);
}

#[test]
fn slip_begins_at_the_reference_and_elastic_stick_gives_way() {
    let mut deck = point([2.0, 3.0], 1.0, 0.4, 0.5, 0.0);
    deck.friction.rows.rhs[0] = 0.1; // sticks at u = 0.1: 0.4 - 2 x 0.1 = 0.2
    near(solved(&deck).multipliers(RowKind::Tangential).unwrap(), &[0.2]);
    deck.friction.rows.rhs[0] = 0.0;
    deck.friction.rows.compliance[0] = 0.5; // u = 0.5 t, 2 u + t = 0.4
    let problem = solved(&deck);
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[0.2]);
    near(problem.displacements().unwrap(), &[0.1, 0.0]);
    near(problem.slips().unwrap(), &[0.0]);
}

#[test]
fn without_a_coefficient_there_is_no_tangential_force() {
    let problem = solved(&point([2.0, 3.0], 1.0, 0.8, 0.0, 0.0));
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[0.0]);
    near(problem.displacements().unwrap(), &[0.4, 0.0]);
    assert_eq!(problem.friction_states().unwrap(), [FrictionState::Open]);
}

/// A wheel on a spring of 1e-3, a load on the car behind it: 900 far without the stop at 200, which is a hundred times beyond all that the
/// load alone moves. Balance of the wheel: `1e-3 u + 0.1 = 2 (200 - u)`.
#[test]
fn a_far_row_that_the_answer_would_go_through_takes_part() {
    let car = |k: f64| Body {
        stiffness: [[(0, k), (1, -k)], [(0, -k), (1, k)]].iter().fold(Csr::empty(2), |mut own, row| {
            own.push_row(row);
            own
        }),
        null_space: Some(vec![vec![1.0, 1.0]]),
        load: vec![0.0, 1.0],
        coordinates: vec![[0.0; 3]; 2],
        node: vec![1, 2],
        direction: vec![1, 1],
    };
    let wheel = point([1e-3, 3.0], 1.0, 0.0, 0.1, 0.0).bodies.remove(0);
    let mut deck = Deck::new("stop", vec![wheel, car(2.0)]);
    deck.contact.push(&[(1, -1.0)], 0.0);
    deck.contact.push(&[(3, 1.0)], 200.0);
    deck.friction.push(Some(0), &[&[(0, 1.0)]], 0.1, 0.0);
    deck.equalities.push(&[(0, 1.0), (2, -1.0)], 0.0);
    let problem = solved(&deck);
    let u = 399.9 / 2.001;
    near(problem.displacements().unwrap(), &[u, 0.0, u, 200.0]);
    near(problem.multipliers(RowKind::Inequality).unwrap(), &[1.0, 1.0 - 2.0 * (200.0 - u)]);
    near(problem.multipliers(RowKind::Tangential).unwrap(), &[0.1]);
}

/// A bar of two points on the ground, its ends held up by a spring of stiffness 1 that both share, pressed by 5 and pushed by 5 at
/// each end where friction holds 2.5: it slides to a stop at its right end, which carries 5 however far it is (up to 1e5 times its deformation).
#[test]
fn what_slides_rests_at_a_stop_however_far_it_is() {
    for gap in [1e-3, 0.1, 1.0, 10.0, 1e3] {
        let mut stiffness = Csr::empty(4);
        stiffness.push_row(&[(0, 1e3), (2, -1e3)]);
        stiffness.push_row(&[]);
        stiffness.push_row(&[(0, -1e3), (2, 1e3)]);
        stiffness.push_row(&[]);
        let modes = [[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
        let body = Body {
            stiffness,
            null_space: Some(modes.iter().map(|mode| mode.to_vec()).collect()),
            load: vec![5.0, -5.0, 5.0, -5.0],
            coordinates: [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]].to_vec(),
            node: vec![1, 1, 2, 2],
            direction: vec![1, 2, 1, 2],
        };
        let mut deck = Deck::new("bar", vec![body]);
        for node in [0, 1] {
            deck.contact.push(&[(2 * node + 1, -1.0)], 0.0);
            deck.friction.push(Some(node), &[&[(2 * node, 1.0)]], 0.5, 0.0);
        }
        deck.contact.push(&[(2, 1.0)], gap);
        deck.equalities.push_compliant(&[(1, 0.5), (3, 0.5)], 0.0, 1.0);
        let problem = solved(&deck);
        near(problem.multipliers(RowKind::Inequality).unwrap(), &[5.0, 5.0, 5.0]);
        near(problem.multipliers(RowKind::Tangential).unwrap(), &[2.5, 2.5]);
    }
}
