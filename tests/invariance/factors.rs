//! Units that are no powers of two on the model decks, with every preconditioner. Everything rounds otherwise, so the bits
//! differ; the answer and the path to it must not.

use decks::random::Random;
use decks::{Cube, Deck, Moduli, Stack};

use crate::invariance::answer::Answer;
use crate::invariance::units::{in_units, in_units_of, with_rows_in_units};
use crate::support::hand_over;

/// Stiffness, force and length.
const UNITS: [[f64; 3]; 4] =
    [[3.0, 3.0, 1.0], [1.0 / 0.7, 1.0, 0.7], [1.0, 1e5 / 3.0, 1e5 / 3.0], [7e-3, 2.1e-4, 0.03]];

fn cubic() -> Cube {
    Cube { subdomains: [3; 3], ..Cube::default() }
}

/// The load closes few rows under stiff subdomains: it grows with the contrast.
fn checkerboard(contrast: f64) -> Cube {
    let pressure = 0.3 * contrast * Cube::default().pressure;
    Cube { moduli: Moduli::Checkerboard(contrast), pressure, ..cubic() }
}

/// Two bodies, floating and held, a cube, a slab, layers, a checkerboard.
fn decks() -> Vec<Deck> {
    let stack = Stack { in_plane: vec![8, 6], layers: vec![4, 3], ..Stack::default() };
    let layers = Moduli::Layers(1e4);
    vec![
        stack.build(),
        Stack { hold: true, pressure: 2.0 * stack.pressure, ..stack }.build(),
        cubic().build(),
        Cube { subdomains: [4, 4, 1], clamp: false, waves: 0.3, ..cubic() }.build(),
        Cube { moduli: layers, gap_offset: -0.005, ..cubic() }.build(),
        checkerboard(10.0).build(),
    ]
}

fn solve(deck: &Deck, preconditioner: &str) -> Answer {
    let mut problem = hand_over::problem(deck).unwrap();
    problem.set_str("preconditioner", preconditioner).unwrap();
    Answer::from(&mut problem, &deck.name)
}

/// Decks with preconditioners, a text that names both, and the answer.
fn solved() -> impl Iterator<Item = (Deck, &'static str, String, Answer)> {
    let all = ["none", "lumped", "dirichlet"];
    decks().into_iter().flat_map(move |deck| {
        all.map(|preconditioner| {
            let answer = solve(&deck, preconditioner);
            (deck.clone(), preconditioner, format!("{}, {preconditioner}", deck.name), answer)
        })
    })
}

fn assert_same_path(found: &Answer, expected: &Answer, what: &str) {
    found.assert_near(expected, 1e-9, what);
    let (found, expected) = (found.products, expected.products);
    // Rows whose forces are equal tie. Rounding decides which of them leaves first, and without a preconditioner the
    // courses stay apart.
    let apart = if what.contains("none") { 1 + expected / 6 } else { 1 };
    assert!(found.abs_diff(expected) <= apart, "{what}: {found} products against {expected}");
}

#[test]
fn any_unit_of_stiffness_force_and_length_takes_the_same_path_to_the_same_answer() {
    for (deck, preconditioner, what, answer) in solved() {
        for [stiffness, force, length] in UNITS {
            let found = solve(&in_units(&deck, stiffness, force, length), preconditioner);
            let what = format!("{what}: {stiffness}, {force}, {length}");
            assert_same_path(&found, &answer.in_units(length, force), &what);
        }
    }
}

#[test]
fn any_unit_of_a_single_row_takes_the_same_path_to_the_same_answer() {
    for (seed, (deck, preconditioner, what, answer)) in solved().enumerate() {
        let mut random = Random::new(seed as u64);
        let factors = [3.0, 0.7, 1e5 / 3.0];
        let (in_units, expected) = with_rows_in_units(&deck, &answer, || factors[random.below(3)]);
        let found = in_units_of(&answer, &expected, solve(&in_units, preconditioner));
        assert_same_path(&found, &answer, &what);
    }
}

/// A checkerboard of 1000 takes 100 steps on one face: conjugate gradients lose their orthogonality on the way, which
/// step loses it first is a matter of rounding, and so is the last of a hundred. Not so the answer.
#[test]
fn on_long_runs_the_count_is_rounding_to_one_tenth_and_the_answer_is_not() {
    let deck = checkerboard(1000.0).build();
    let answer = solve(&deck, "dirichlet");
    for [stiffness, force, length] in UNITS {
        let found = solve(&in_units(&deck, stiffness, force, length), "dirichlet");
        let what = format!("{stiffness}, {force}, {length}");
        found.assert_near(&answer.in_units(length, force), 1e-8, &what);
        let (found, expected) = (found.products, answer.products);
        assert!(10 * found.abs_diff(expected) <= expected, "{what}: {found} products against {expected}");
    }
}
