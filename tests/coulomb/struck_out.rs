//! Nodes whose rows have lost entries to supports: the host has struck out the unknown that moves as prescribed. Its own model with this
//! unknown, held by an equality row, has the same answer.

use decks::random::Random;
use decks::{Body, Csr, Deck, Friction};
use feti_contact::solver::{Outcome, Problem, RowKind};

use crate::support::hand_over;

/// The point on springs along its unknowns.
pub fn springs(stiffness: &[f64], load: &[f64]) -> Body {
    let mut matrix = Csr::empty(stiffness.len());
    stiffness.iter().enumerate().for_each(|(i, k)| matrix.push_row(&[(i, *k)]));
    Body {
        stiffness: matrix,
        null_space: None,
        load: load.to_vec(),
        coordinates: vec![[0.0; 3]; stiffness.len()],
        node: vec![1; stiffness.len()],
        direction: (1..=stiffness.len() as i32).collect(),
    }
}

/// A point on springs in front of an oblique wall; its x moves by `moved`.
struct Point {
    k: Vec<f64>,
    load: Vec<f64>,
    /// The normal, then the tangents.
    frame: Vec<Vec<f64>>,
    mu: f64,
    moved: f64,
}

impl Point {
    /// Without x, or with x and an equality row.
    fn deck(&self, struck: bool) -> Deck {
        let from = usize::from(struck);
        let dofs = self.k.len() - from;
        let mut deck = Deck::new("point", vec![springs(&self.k[from..], &self.load[from..])]);
        let row = |i: usize| -> Vec<(usize, f64)> {
            let own = self.frame[i][from..].iter().copied().enumerate();
            own.filter(|(_, v)| *v != 0.0).collect()
        };
        let taken = |i: usize| if struck { self.frame[i][0] * self.moved } else { 0.0 };
        deck.contact.push(&row(0), -taken(0));
        let tangents: Vec<_> = (1..self.frame.len()).map(row).collect();
        deck.friction = Friction::none(tangents.len(), dofs);
        let views: Vec<&[(usize, f64)]> = tangents.iter().map(Vec::as_slice).collect();
        deck.friction.push(Some(0), &views, self.mu, 0.0);
        (0..tangents.len()).for_each(|i| deck.friction.rows.rhs[i] = -taken(i + 1));
        if !struck {
            deck.equalities.push(&[(0, 1.0)], self.moved);
        }
        deck
    }
}

/// Forces, normal first.
fn forces(deck: &Deck, what: &str) -> (Vec<f64>, Problem) {
    let mut problem = hand_over::problem(deck).unwrap_or_else(|error| panic!("{what}: {error}"));
    let report = problem.solve().unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(report.outcome, Outcome::Solved, "{what}: {:?}", report.certificate);
    let mut found = problem.multipliers(RowKind::Inequality).unwrap().to_vec();
    found.extend(problem.multipliers(RowKind::Tangential).unwrap());
    (found, problem)
}

fn assert_the_same(point: &Point, what: &str) {
    let ((found, problem), (whole, _)) = (forces(&point.deck(true), what), forces(&point.deck(false), what));
    let size = whole[0].abs();
    assert!(size > 0.1, "{what}: {whole:?}");
    assert!(
        found.iter().zip(&whole).all(|(a, b)| (a - b).abs() < 1e-6 * size),
        "{what}: {found:?} {whole:?}"
    );
    let tangential = found[1..].iter().fold(0.0, |all: f64, v| all.hypot(*v));
    assert!((tangential - point.mu * found[0]).abs() < 1e-7 * size, "{what}: slips");
    let slips = problem.slips().unwrap();
    let slip = slips.iter().fold(0.0, |all: f64, v| all.hypot(*v));
    assert!(slips
        .iter()
        .zip(&found[1..])
        .all(|(s, t)| (s * tangential - t * slip).abs() < 1e-6 * size * slip));
}

/// The first tangent is x, turned by this angle.
const ANGLES: [f64; 9] = [0.0, 2e-18, 1e-13, 1e-12, 1e-11, 1e-9, 1e-4, 3e-3, 0.2];

fn turned(random: &mut Random, dim: usize, angle: f64) -> Vec<Vec<f64>> {
    let (s, c) = angle.sin_cos();
    if dim == 2 {
        return vec![vec![-s, c], vec![c, s]];
    }
    let ((sx, cx), (sy, cy)) = (random.between(0.0, 6.3).sin_cos(), random.between(0.0, 6.3).sin_cos());
    // a frame (x, y', z') turned in the plane of x and y', then about its own first axis
    let (e, y, z) = (vec![c, s * cx, s * sx], [-s, c * cx, c * sx], [0.0, -sx, cx]);
    let mixed = |a: f64, b: f64| (0..3).map(|k| a * y[k] + b * z[k]).collect::<Vec<f64>>();
    vec![mixed(cy, sy), e, mixed(-sy, cy)]
}

fn drawn(random: &mut Random, dim: usize, angle: f64, moved: f64) -> Point {
    let frame = turned(random, dim, angle);
    let k: Vec<f64> = (0..dim).map(|_| random.decades(-0.3, 0.3)).collect();
    // pressed onto the wall, and pushed along the last tangent
    let (press, push) = (random.between(2.0, 4.0), random.between(2.0, 4.0));
    let load = (0..dim).map(|j| press * frame[0][j] + if dim == 3 { push * frame[2][j] } else { 0.0 });
    Point { k, load: load.collect(), frame, mu: random.between(0.1, 0.4), moved }
}

#[test]
fn a_tangential_row_left_short_by_a_support_is_solved_as_the_whole_model() {
    let mut random = Random::new(7);
    for (angle, case) in ANGLES.into_iter().flat_map(|angle| (0..6).map(move |case| (angle, case))) {
        assert_the_same(&drawn(&mut random, 3, angle, 0.0), &format!("{angle:e} {case}"));
    }
}

#[test]
fn what_moves_as_prescribed_rubs_also_along_rows_without_entries() {
    let mut random = Random::new(8);
    for (angle, case) in ANGLES.into_iter().flat_map(|angle| (0..6).map(move |case| (angle, case))) {
        for dim in [2, 3] {
            let moved = random.between(0.1, 1.0) * if case % 2 == 0 { 1.0 } else { -1.0 };
            assert_the_same(&drawn(&mut random, dim, angle, moved), &format!("{dim} {angle:e} {case}"));
        }
    }
}

/// A slip of the reference begins and ends between solves, as the prescribed motion of a tool does.
#[test]
fn a_reference_of_a_row_without_entries_acts_while_it_is_there() {
    let mut random = Random::new(9);
    let point = drawn(&mut random, 3, 0.0, 0.7);
    let (moving, _) = forces(&point.deck(true), "moving");
    let (resting, _) = forces(&Point { moved: 0.0, ..point }.deck(true), "resting");
    let point = drawn(&mut Random::new(9), 3, 0.0, 0.7);
    let mut problem = hand_over::problem(&point.deck(true)).unwrap();
    let s_old = point.deck(true).friction.rows.rhs;
    for (s_old, expected) in [(&s_old[..], &moving), (&[0.0; 2], &resting), (&s_old, &moving)] {
        problem.set_friction_reference(0, 1, 2, s_old).unwrap();
        problem.solve().unwrap();
        let tangential = problem.multipliers(RowKind::Tangential).unwrap();
        assert!(tangential.iter().zip(&expected[1..]).all(|(a, b)| a == b), "{tangential:?} {expected:?}");
    }
    let saved = problem.save_state().unwrap();
    problem.set_friction_reference(0, 1, 2, &[0.0; 2]).unwrap();
    problem.solve().unwrap();
    problem.restore_state(saved).unwrap();
    problem.solve().unwrap();
    let tangential = problem.multipliers(RowKind::Tangential).unwrap();
    assert!(tangential.iter().zip(&moving[1..]).all(|(a, b)| a == b), "{tangential:?} {moving:?}");
    // the step is accepted: a row without entries has reached nothing
    problem.commit_friction().unwrap();
    problem.solve().unwrap();
    assert_eq!(problem.multipliers(RowKind::Tangential).unwrap()[0], 0.0);
}
