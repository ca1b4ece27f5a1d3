//! Bodies that slide along rows whose normals have few digits: what resists a motion only by noise of the normals neither
//! holds it nor moves it, and no slide is silent.

use decks::random::Random;
use decks::{Block, Body, Csr, Deck};
use feti_contact::solver::{Outcome, Problem};

use crate::scales::{answer, difference, largest, problem, solved};
use crate::support::warnings::told;

/// A block (x, y_1, y_2) with a spring between y_1 and y_2 that presses with 1 and 1.3 on rows `t_i x - y_i <= 0`. For t = 0
/// the forces are 1 and 1.3, and x is undetermined.
fn block(slopes: [f64; 2]) -> Problem {
    let k = 1e3;
    let body = Body {
        stiffness: Csr::from_dense(3, &[0.0, 0.0, 0.0, 0.0, k, -k, 0.0, -k, k]),
        null_space: Some(vec![vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 1.0]]),
        load: vec![0.0, -1.0, -1.3],
        coordinates: vec![[0.0; 3]; 3],
        node: vec![1, 1, 2],
        direction: vec![1, 2, 2],
    };
    let mut deck = Deck::new("three unknowns", vec![body]);
    (0..2).for_each(|i| deck.contact.push(&[(0, slopes[i]), (1 + i, -1.0)], 0.0));
    problem(&deck)
}

#[test]
fn slopes_that_are_noise_leave_forces_and_rest_as_without_slopes() {
    for slopes in [[1e-12, 2e-12], [1e-12, -2e-12], [1e-13, -2e-13], [3e-11, -2e-11], [-1e-15, 2e-15]] {
        let found = answer(&mut block(slopes)).unwrap();
        // x has no stiffness and is a body of its own, without load: any force on it is large beside its load
        assert!(found.report.outcome <= Outcome::Marginal, "{slopes:?} {:?}", found.report);
        assert!(difference(&found.lambda, &[1.0, 1.3]) < 1e-9, "{slopes:?} {:?}", found.lambda);
        assert!(largest(&found.u) < 1e-3, "{slopes:?} {:?}", found.u);
        assert_eq!(found.report.undetermined, 1, "{slopes:?}");
    }
}

#[test]
fn a_slide_along_slopes_that_may_be_noise_is_told_and_ends_with_the_accuracy_of_the_data() {
    for slopes in [[1e-8, -2e-8], [1e-7, -2e-7], [1e-9, -2e-9]] {
        let mut problem = block(slopes);
        let told = told(&mut problem);
        let found = answer(&mut problem).unwrap();
        assert_eq!(found.report.outcome, Outcome::Marginal, "{slopes:?}");
        let slide = found.report.slide.unwrap();
        assert!(slide.travel > 1e4 && slide.resisted < 1e-5, "{slide:?}");
        assert!(told.lock().unwrap().contains("set data_accuracy"));
        problem.set_f64("data_accuracy", 1e-6).unwrap();
        let found = answer(&mut problem).unwrap();
        assert!(difference(&found.lambda, &[1.0, 1.3]) < 1e-5, "{slopes:?} {:?}", found.lambda);
        assert!(largest(&found.u) < 1e-3, "{slopes:?} {:?}", found.u);
    }
}

/// A floating block of 4 x 3 elements turned by an angle, pressed on the plane below it by uneven loads normal to the plane;
/// the normals of its five bottom nodes are off by up to `noise`.
fn turned(angle: f64, noise: f64, seed: u64) -> Deck {
    let block =
        Block { dimension: 2, elements: [4, 3, 1], size: [4.0, 3.0, 1.0], young: 1e3, ..Block::default() };
    let mut body = block.floating().body;
    let (n, random) = (body.dofs(), &mut Random::new(seed));
    let (sin, cos) = angle.sin_cos();
    let turn = |v: &[f64]| -> Vec<f64> {
        let pairs = v.chunks_exact(2).flat_map(|v| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]]);
        pairs.collect()
    };
    // Q K Q', column by column
    let mut half = vec![0.0; n * n];
    for j in 0..n {
        let mut unit = vec![0.0; n];
        unit[j] = 1.0;
        let back: Vec<f64> =
            unit.chunks_exact(2).flat_map(|v| [cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]]).collect();
        let column = turn(&body.stiffness.times(&back));
        (0..n).for_each(|i| half[i * n + j] = column[i]);
    }
    let dense: Vec<f64> = (0..n * n).map(|at| 0.5 * (half[at] + half[at % n * n + at / n])).collect();
    body.stiffness = Csr::from_dense(n, &dense);
    body.null_space = body.null_space.map(|modes| modes.iter().map(|mode| turn(mode)).collect());
    let mut load = vec![0.0; n];
    for at in block.grids().filter(|at| at[1] == 3) {
        load[2 * block.node(at) + 1] = -1.0 - 0.1 * at[0] as f64;
    }
    body.load = turn(&load);
    let mut deck = Deck::new("turned", vec![body]);
    for at in block.grids().filter(|at| at[1] == 0) {
        let (node, (sin, cos)) = (block.node(at), (angle + noise * random.between(-1.0, 1.0)).sin_cos());
        deck.contact.push(&[(2 * node, sin), (2 * node + 1, -cos)], 0.0);
    }
    deck
}

#[test]
fn a_turned_block_on_normals_of_few_digits_has_the_forces_of_exact_normals() {
    for angle in [0.0, 0.3, 1.1] {
        let exact = solved(&mut problem(&turned(angle, 0.0, 1)));
        for (seed, noise) in [1e-15, 1e-14, 1e-13, 1e-12, 1e-11].into_iter().enumerate() {
            let found = solved(&mut problem(&turned(angle, noise, 7 + seed as u64)));
            assert!(difference(&found.lambda, &exact.lambda) < 1e-9, "{angle} {noise:e}: {:?}", found.lambda);
            assert!(difference(&found.u, &exact.u) < 1e-6, "{angle} {noise:e}: {:e}", largest(&found.u));
        }
    }
}

#[test]
fn no_slide_of_a_turned_block_is_silent() {
    for angle in [0.0, 0.3, 1.1] {
        let exact = solved(&mut problem(&turned(angle, 0.0, 1)));
        for seed in 0..10 {
            for noise in [1e-10, 1e-9, 1e-8, 1e-7, 1e-6] {
                let mut problem = problem(&turned(angle, noise, seed));
                if let Ok(found) = answer(&mut problem) {
                    let is_far = largest(&found.u) > 1e4 * largest(&exact.u);
                    let silent = is_far && found.report.outcome == Outcome::Solved;
                    assert!(!silent, "{angle} {noise:e}: {:e}", largest(&found.u));
                }
                if noise > 1e-7 {
                    continue;
                }
                problem.set_f64("data_accuracy", 1e-6).unwrap();
                let found = answer(&mut problem).unwrap();
                assert!(
                    difference(&found.lambda, &exact.lambda) < 10.0 * noise,
                    "{angle} {noise:e} {seed} {:?} {:?} {:?}",
                    found.report.outcome,
                    found.lambda,
                    exact.lambda
                );
                assert!(largest(&found.u) < 2.0 * largest(&exact.u), "{angle} {noise:e}");
            }
        }
    }
}

/// The turned block, shifted, with coordinates printed to `digits` digits; the host computes the normals from these.
fn printed(angle: f64, shift: f64, digits: usize) -> (Deck, Vec<f64>) {
    let mut deck = turned(angle, 0.0, 1);
    let (sin, cos) = angle.sin_cos();
    let round = |x: f64| format!("{x:.*e}", digits - 1).parse::<f64>().unwrap();
    let place = |node: usize| {
        let (x, y) = ((node % 5) as f64 * 1.013 + shift, (node / 5) as f64 * 1.007 - 0.7 * shift);
        [round(cos * x - sin * y), round(sin * x + cos * y)]
    };
    let mut contact = decks::Rows::none(deck.dofs());
    for node in 0..5 {
        let (a, b) = (place(node.max(1) - 1), place((node + 1).min(4)));
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let (along, up) = ((b[1] - a[1]) / length, (b[0] - a[0]) / length);
        contact.push(&[(2 * node, along), (2 * node + 1, -up)], 0.0);
    }
    deck.contact = contact;
    let coordinates = (0..20).flat_map(|node| [place(node); 2]).flatten().collect();
    (deck, coordinates)
}

#[test]
fn a_block_with_printed_coordinates_has_the_forces_of_exact_coordinates_to_their_digits() {
    let (mut right, mut all) = (0, 0);
    for (angle, shift) in [(0.3, 0.0), (1.1, 0.0), (0.7, 1e3)] {
        let exact = solved(&mut problem(&turned(angle, 0.0, 1)));
        for digits in 8..=15 {
            let (deck, coordinates) = printed(angle, shift, digits);
            let mut problem = problem(&deck);
            let (node, direction): (Vec<i32>, Vec<i32>) = (0..40).map(|i| (i / 2 + 1, i % 2 + 1)).unzip();
            problem.set_coordinates(0, 2, &node, &direction, &coordinates, 2).unwrap();
            let found = answer(&mut problem).unwrap();
            let noise = 10.0f64.powi(2 - digits as i32) * (1.0 + shift);
            let what = format!("{angle} {shift} {digits} {:?} {:?}", found.report.outcome, found.lambda);
            let follows = difference(&found.lambda, &exact.lambda) < noise
                && largest(&found.u) < 2.0 * largest(&exact.u);
            assert!(follows || found.report.outcome != Outcome::Solved, "{what}");
            (right, all) = (right + usize::from(follows), all + 1);
        }
    }
    assert!(10 * right >= 8 * all, "{right} of {all}");
}
