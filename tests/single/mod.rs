//! Whole bodies factorised in single precision (option steps): answers are those of double precision, with any number of threads, with
//! friction, matrix-free, and in later solves; flat bodies keep double precision.

use crate::support::hand_over;
use decks::rubbing::{push, with_friction};
use decks::{Blocks, Deck};
use feti_contact::solver::{LogLevel, Outcome, Problem};
use std::sync::{Arc, Mutex};

/// Two blocks of 16^3 elements: 14 thousand unknowns each, whose factorisation is worth single precision.
fn blocks() -> Deck {
    Blocks { elements: 16, young: 2e11 }.build()
}

fn rubbing() -> Deck {
    let mut deck = with_friction(blocks(), 0.3);
    let pressed = deck.load().iter().sum::<f64>().abs();
    push(&mut deck, 1, [0.1 * pressed, 0.0]);
    deck
}

/// Factors in single precision, and the answers for its loads and for 1.1 times these.
fn solved(deck: &Deck, options: &str) -> (usize, [Answer; 2]) {
    let mut problem = hand_over::problem(deck).unwrap();
    problem.set_text(&format!("certificate_tolerance=1e-9 {options}")).unwrap();
    let lines = Arc::new(Mutex::new(Vec::new()));
    let book = Arc::clone(&lines);
    let tell = move |_: LogLevel, text: &str| {
        book.lock().unwrap().push(text.to_owned());
        0
    };
    problem.on_log(Some((LogLevel::Phase, Box::new(tell))));
    let first = Answer::of(&mut problem);
    for (p, body) in deck.bodies.iter().enumerate() {
        let load: Vec<f64> = body.load.iter().map(|f| 1.1 * f).collect();
        problem.set_load(p, &load).unwrap();
    }
    let later = Answer::of(&mut problem);
    let lines = lines.lock().unwrap();
    let told = lines.iter().find_map(|line| line.strip_prefix("factors in single precision: "));
    (told.map_or(0, |count| count.parse().unwrap()), [first, later])
}

struct Answer {
    u: Vec<f64>,
    energy: f64,
}

impl Answer {
    fn of(problem: &mut Problem) -> Self {
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Solved);
        Self { u: problem.displacements().unwrap().to_vec(), energy: report.energy }
    }

    /// Largest difference of displacements relative to the largest one.
    fn apart(&self, other: &Self) -> f64 {
        let largest = |all: &mut dyn Iterator<Item = f64>| all.fold(0.0, |most: f64, v| most.max(v.abs()));
        largest(&mut self.u.iter().zip(&other.u).map(|(a, b)| a - b)) / largest(&mut self.u.iter().copied())
    }
}

#[test]
fn few_steps_are_solved_with_factors_in_single_precision_to_the_accuracy_of_double_precision() {
    for (deck, options) in [(blocks(), ""), (blocks(), "dual_operator=implicit"), (rubbing(), "")] {
        let (none, expected) = solved(&deck, options);
        let (both, found) = solved(&deck, &format!("{options} steps=2"));
        assert_eq!((none, both), (0, 2));
        for (expected, found) in expected.iter().zip(&found) {
            assert!((found.energy / expected.energy - 1.0).abs() < 1e-10, "{options}");
            assert!(found.apart(expected) < 1e-8, "{options} {}", found.apart(expected));
        }
    }
}

/// Moduli that differ from element to element by up to 1:2000, and a body that is a million times as stiff as the other.
#[test]
fn uneven_bodies_have_the_answers_of_double_precision() {
    let even = Blocks { elements: 16, young: 1e-3 };
    let mut stiff = even.build();
    let upper = &mut stiff.bodies[1];
    upper.stiffness.val.iter_mut().chain(&mut upper.load).for_each(|v| *v *= 1e6);
    for deck in [even.varied(1.999, 5), stiff] {
        let (expected, found) = (solved(&deck, "").1, solved(&deck, "steps=1").1);
        for (expected, found) in expected.iter().zip(&found) {
            assert!((found.energy / expected.energy - 1.0).abs() < 1e-8, "{}", deck.name);
            assert!(found.apart(expected) < 1e-6, "{} {}", deck.name, found.apart(expected));
        }
    }
}

#[test]
fn factors_in_single_precision_give_the_same_bits_for_any_number_of_threads() {
    for deck in [blocks(), rubbing()] {
        let [alone, three] = [1, 3].map(|threads| solved(&deck, &format!("steps=1 threads={threads}")).1);
        for (alone, three) in alone.iter().zip(&three) {
            assert!(alone.u.iter().zip(&three.u).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }
}

#[test]
fn many_steps_and_flat_bodies_have_factors_in_double_precision() {
    let flat = Blocks { elements: 40, young: 2e11 }.layered(2);
    for (deck, steps) in [(blocks(), 3), (blocks(), 0), (flat, 1)] {
        assert_eq!(solved(&deck, &format!("steps={steps}")).0, 0);
    }
}
