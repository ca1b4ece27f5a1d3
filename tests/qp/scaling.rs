//! Units: powers of two in A, b and G change no bit of the answer but its exponent.

use decks::random::Random;
use feti_contact::qp::{Solution, Verdict};

use crate::qp::dense::Dense;
use crate::qp::program::Program;

/// A floating program that needs all kinds of steps.
fn program(seed: u64) -> Program {
    let mut random = Random::new(seed);
    let m = 12;
    let mut a = Dense::gram(&Dense((0..m + 3).map(|_| random.normals(m, 1.0)).collect()));
    (0..m).for_each(|i| a.0[i][i] += 0.1);
    let g = Dense((0..2).map(|_| random.normals(m, 1.0)).collect());
    let x: Vec<f64> = random.normals(m, 1.0).iter().map(|x| x.max(0.0)).collect();
    Program { a, b: random.normals(m, 3.0), e: g.times(&x), g, bounded: (0..m).map(|i| i != 4).collect() }
}

/// A in 2^a, b in 2^b, G in 2^g: then x is in 2^(b - a), e in 2^(g + b - a), alpha in 2^(b - g).
fn scaled(program: &Program, a: i32, b: i32, g: i32) -> Program {
    let by =
        |values: &[f64], power: i32| -> Vec<f64> { values.iter().map(|v| v * 2f64.powi(power)).collect() };
    let all = |matrix: &Dense, power: i32| Dense(matrix.0.iter().map(|row| by(row, power)).collect());
    Program {
        a: all(&program.a, a),
        b: by(&program.b, b),
        g: all(&program.g, g),
        e: by(&program.e, g + b - a),
        bounded: program.bounded.clone(),
    }
}

fn assert_same_bits(found: &[f64], expected: &[f64], power: i32) {
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.to_bits(), (expected * 2f64.powi(power)).to_bits(), "{found:e} {expected:e}");
    }
}

fn assert_same_run(found: &Solution, expected: &Solution, x: i32, alpha: i32) {
    assert_eq!(found.verdict, Verdict::Solved);
    assert_eq!(found.counts, expected.counts);
    assert_same_bits(&found.x, &expected.x, x);
    assert_same_bits(&found.alpha, &expected.alpha, alpha);
}

#[test]
fn powers_of_two_give_the_same_bits_and_the_same_counts() {
    for seed in 0..30 {
        let program = program(seed);
        let expected = program.solved();
        for (a, b, g) in [(1, 0, 0), (0, 1, 0), (0, 0, 1), (37, 37, 0), (-60, 3, 11), (5, -90, -7)] {
            let found = scaled(&program, a, b, g).solved();
            assert_same_run(&found, &expected, b - a, b - g);
        }
    }
}

#[test]
fn the_programs_of_this_file_take_every_kind_of_step() {
    let runs: Vec<_> = (0..30).map(|seed| program(seed).solved().counts).collect();
    assert!(runs.iter().any(|counts| counts.conjugate_gradient > 3));
    assert!(runs.iter().any(|counts| counts.expansions > 0));
    assert!(runs.iter().any(|counts| counts.releases > 0));
}

#[test]
fn any_other_unit_gives_the_same_answer() {
    for seed in 0..30 {
        let program = program(seed);
        let expected = program.solved();
        for factor in [210_000.0, 1e-3, 3.7] {
            let mut in_units = program.clone();
            in_units.a.0.iter_mut().flatten().for_each(|v| *v *= factor);
            in_units.b.iter_mut().for_each(|v| *v *= factor);
            let found = in_units.solved();
            let steps = [found.counts.steps(), expected.counts.steps()];
            assert!(steps[0].abs_diff(steps[1]) <= 1, "seed {seed}, {factor}: {steps:?}");
            for (found, expected) in found.x.iter().zip(&expected.x) {
                approx::assert_relative_eq!(*found, *expected, epsilon = 1e-9, max_relative = 1e-9);
            }
        }
    }
}
