//! Units of force and of length, and the units of single rows.

use decks::random::Random;
use decks::{Deck, Rows};

use crate::invariance::answer::{decks, Answer};

/// K by `stiffness`, f by `force`, c and h by `length`.
pub fn in_units(deck: &Deck, stiffness: f64, force: f64, length: f64) -> Deck {
    let mut deck = deck.clone();
    for body in &mut deck.bodies {
        body.stiffness.val.iter_mut().for_each(|k| *k *= stiffness);
        body.load.iter_mut().for_each(|f| *f *= force);
    }
    for rows in [&mut deck.contact, &mut deck.equalities] {
        rows.rhs.iter_mut().for_each(|c| *c *= length);
        rows.compliance.iter_mut().for_each(|inv_k| *inv_k /= stiffness);
    }
    deck
}

/// Row i of `rows`, entries and right-hand side, by `factors[i]`; its compliance by the square.
fn with_factors(rows: &mut Rows, factors: &[f64]) {
    let matrix = &mut rows.matrix;
    for (i, factor) in factors.iter().enumerate() {
        matrix.val[matrix.ptr[i]..matrix.ptr[i + 1]].iter_mut().for_each(|v| *v *= factor);
        rows.rhs[i] *= factor;
        rows.compliance[i] *= factor * factor;
    }
}

/// The deck with every row in its own unit, and its answer expected from that of the deck.
pub fn with_rows_in_units(deck: &Deck, answer: &Answer, mut factor: impl FnMut() -> f64) -> (Deck, Answer) {
    let (mut deck, mut answer) = (deck.clone(), answer.clone());
    let pairs = [(&mut deck.contact, &mut answer.lambda), (&mut deck.equalities, &mut answer.mu)];
    for (rows, multipliers) in pairs {
        let factors: Vec<f64> = (0..rows.len()).map(|_| factor()).collect();
        with_factors(rows, &factors);
        multipliers.iter_mut().zip(&factors).for_each(|(l, factor)| *l /= factor);
    }
    (deck, answer)
}

/// `found` with its forces in the units of `reference`, of which `expected` is the answer in the units of `found`.
pub fn in_units_of(reference: &Answer, expected: &Answer, found: Answer) -> Answer {
    let back = |found: &[f64], expected: &[f64], reference: &[f64]| -> Vec<f64> {
        assert_eq!(found.len(), expected.len());
        let ratios = expected.iter().zip(reference).map(|(e, r)| if *e == 0.0 { 1.0 } else { r / e });
        found.iter().zip(ratios).map(|(l, ratio)| l * ratio).collect()
    };
    let lambda = back(&found.lambda, &expected.lambda, &reference.lambda);
    let mu = back(&found.mu, &expected.mu, &reference.mu);
    Answer { lambda, mu, ..found }
}

fn power(exponent: i32) -> f64 {
    2f64.powi(exponent)
}

#[test]
fn powers_of_two_in_forces_change_no_bit() {
    for deck in decks() {
        let expected = Answer::of(&deck);
        for exponent in [1, -1, 17, -64, 101] {
            let unit = power(exponent);
            let found = Answer::of(&in_units(&deck, unit, unit, 1.0));
            found.assert_same(&expected.in_units(1.0, unit), &format!("{}, 2^{exponent}", deck.name));
        }
    }
}

#[test]
fn powers_of_two_in_lengths_change_no_bit() {
    for deck in decks() {
        let expected = Answer::of(&deck);
        for exponent in [1, -1, 10, -33] {
            let unit = power(exponent);
            let found = Answer::of(&in_units(&deck, 1.0 / unit, 1.0, unit));
            found.assert_same(&expected.in_units(unit, 1.0), &format!("{}, 2^{exponent}", deck.name));
        }
    }
}

#[test]
fn powers_of_two_in_loads_and_gaps_change_no_bit() {
    for deck in decks() {
        let expected = Answer::of(&deck);
        for exponent in [3, -40] {
            let unit = power(exponent);
            let found = Answer::of(&in_units(&deck, 1.0, unit, unit));
            found.assert_same(&expected.in_units(unit, unit), &format!("{}, 2^{exponent}", deck.name));
        }
    }
}

#[test]
fn powers_of_two_in_single_rows_change_no_bit() {
    for (seed, deck) in decks().iter().enumerate() {
        let answer = Answer::of(deck);
        let mut random = Random::new(seed as u64);
        let (in_units, expected) = with_rows_in_units(deck, &answer, || power(random.below(41) as i32 - 20));
        Answer::of(&in_units).assert_same(&expected, &deck.name);
    }
}

/// Other factors round: the same numbers to 1e-9, each count of steps within one.
fn assert_rounding(found: &Answer, expected: &Answer, what: &str) {
    found.assert_near(expected, 1e-9, what);
    let total = |answer: &Answer| answer.steps.iter().sum::<usize>();
    assert!(
        total(found).abs_diff(total(expected)) <= 1,
        "{what}: {:?} against {:?}",
        found.steps,
        expected.steps
    );
}

#[test]
fn any_unit_of_force_or_length_gives_the_same_answer() {
    for deck in decks() {
        let expected = Answer::of(&deck);
        for unit in [210_000.0, 1e-3, 3.7] {
            let what = format!("{}, {unit}", deck.name);
            let found = Answer::of(&in_units(&deck, unit, unit, 1.0));
            assert_rounding(&found, &expected.in_units(1.0, unit), &what);
            let found = Answer::of(&in_units(&deck, 1.0 / unit, 1.0, unit));
            assert_rounding(&found, &expected.in_units(unit, 1.0), &what);
        }
    }
}

#[test]
fn any_unit_of_a_row_gives_the_same_answer() {
    for (seed, deck) in decks().iter().enumerate() {
        let answer = Answer::of(deck);
        let mut random = Random::new(seed as u64);
        let factors = [210_000.0, 1e-3, 3.7];
        let (in_units, expected) = with_rows_in_units(deck, &answer, || factors[random.below(3)]);
        let found = in_units_of(&answer, &expected, Answer::of(&in_units));
        assert_rounding(&found, &answer, &deck.name);
    }
}
