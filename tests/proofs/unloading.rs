//! Loads go down to zero, each solve beginning at the forces of the one before.

use feti_contact::solver::{Outcome, Problem, RowKind};

use crate::proofs::{body, deck, springs};
use crate::support::hand_over;

/// A spring column on the ground and a floating pair, glued in redundant ways: supports as equality rows.
fn glued() -> Problem {
    let lower = body(springs(3, &[(0, 1, 2.0), (1, 2, 3.0)], &[]), vec![vec![1.0; 3]], vec![0.0; 3]);
    let upper = body(springs(3, &[(0, 1, 5.0), (1, 2, 1.0)], &[]), vec![vec![1.0; 3]], vec![0.0; 3]);
    let deck = deck(
        vec![lower, upper],
        &[(&[(2, 1.0), (3, -1.0)], 0.1), (&[(1, 1.0), (4, -1.0)], 0.3)],
        &[(&[(0, 1.0)], 0.0), (&[(5, 1.0)], 0.0), (&[(0, 1.0), (5, -1.0)], 0.0)],
    );
    let mut problem = hand_over::problem(&deck).unwrap();
    problem.set_str("start", "previous").unwrap();
    problem
}

fn load(problem: &mut Problem, by: f64) {
    problem.set_load(0, &[0.0, 0.3 * by, 1.7 * by]).unwrap();
    problem.set_load(1, &[-0.9 * by, 0.1 * by, 0.0]).unwrap();
}

#[test]
fn unloaded_to_zero_everything_is_zero_in_a_few_steps() {
    let mut problem = glued();
    for by in [1.0, 0.5, 0.0] {
        load(&mut problem, by);
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Solved, "{by}: {report:?}");
        if by == 0.0 {
            assert!(report.counts.steps() <= 10, "{} steps", report.counts.steps());
            let zero = |values: &[f64]| values.iter().all(|v| *v == 0.0);
            assert!(zero(problem.displacements().unwrap()), "{:?}", problem.displacements());
            assert!(zero(problem.multipliers(RowKind::Inequality).unwrap()));
            assert!(zero(problem.multipliers(RowKind::Equality).unwrap()));
        }
    }
}

#[test]
fn a_zero_load_after_any_start_is_answered_with_zeros() {
    let mut problem = glued();
    load(&mut problem, 1.0);
    problem.solve().unwrap();
    for forces in [[1.0, 0.0], [1e8, 3.0], [1e-8, 1e8]] {
        load(&mut problem, 0.0);
        problem.start_from(RowKind::Inequality, &forces).unwrap();
        problem.start_from(RowKind::Equality, &[-2.0, 7e3, 1.0]).unwrap();
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Solved, "{forces:?}: {report:?}");
        assert!(problem.displacements().unwrap().iter().all(|u| *u == 0.0), "{:?}", problem.displacements());
    }
}

/// A chain flies to a wall: its deformation becomes less than the last digits of its displacement.
#[test]
fn a_load_below_the_rounding_of_the_way_to_a_wall_is_told_and_held() {
    let mut told = 0;
    for by in [1e-6, 1e-13, 1e-15, 1e-17, 1e-20] {
        let load = vec![0.3 * by, 0.0, 0.7 * by];
        let chain = body(springs(3, &[(0, 1, 2.0), (1, 2, 3.0)], &[]), vec![vec![1.0; 3]], load);
        let walls: [(&[(usize, f64)], f64); 2] = [(&[(2, 1.0)], 1.1), (&[(1, 1.0)], 1.1)];
        let mut problem = hand_over::problem(&deck(vec![chain], &walls, &[])).unwrap();
        let report = problem.solve().unwrap();
        let force: f64 = problem.multipliers(RowKind::Inequality).unwrap().iter().sum();
        assert!((force - by).abs() < 1e-12 * by, "{by:e}: {force:e}");
        let expected = if report.travelled.is_some() { Outcome::Marginal } else { Outcome::Solved };
        assert_eq!(report.outcome, expected, "{by:e}: {report:?}");
        assert!(report.travelled.is_none() || by < 1e-12, "{by:e}");
        if report.travelled.is_some() {
            told += 1;
            assert_eq!(problem.findings().unwrap().place.body, Some(0));
        }
    }
    assert!(told >= 3, "{told}");
}

/// The cube of springs of a user: a network on supports by equality rows, 1, .5, 0.
#[test]
fn a_cube_of_springs_on_supports_is_unloaded() {
    for n in [2, 3, 4] {
        let mut problem = cube(n);
        let order = 3 * n * n * n;
        let full: Vec<f64> = (0..order)
            .map(|i| if i % 3 == 2 { -1.0 - 0.1 * (i as f64).sin() } else { 0.02 * (i as f64).cos() })
            .collect();
        for by in [1.0, 0.5, 1e-12, 0.0] {
            problem.set_load(0, &full.iter().map(|f| by * f).collect::<Vec<_>>()).unwrap();
            let report = problem.solve().unwrap();
            assert_eq!(report.outcome, Outcome::Solved, "{n}, {by}: {report:?}");
            if by == 0.0 {
                assert!(report.counts.steps() <= 10, "{n}: {} steps", report.counts.steps());
                assert!(problem.displacements().unwrap().iter().all(|u| *u == 0.0));
            }
        }
    }
}

/// n^3 nodes of 3 unknowns: springs along edges, face and space diagonals; the bottom held by equality rows, a wall above
/// the ground for every bottom node (redundant with them) and at the sides.
fn cube(n: usize) -> Problem {
    let at = |x: usize, y: usize, z: usize| x + n * (y + n * z);
    let order = 3 * n * n * n;
    let mut k = vec![0.0; order * order];
    let position = |i: usize| [i % n, i / n % n, i / n / n].map(|v| v as f64);
    for i in 0..n * n * n {
        for j in 0..i {
            let d: Vec<f64> = position(i).iter().zip(position(j)).map(|(a, b)| a - b).collect();
            let length2: f64 = d.iter().map(|d| d * d).sum();
            if length2 > 3.5 || d.iter().any(|d| d.abs() > 1.0) {
                continue;
            }
            for a in 0..3 {
                for b in 0..3 {
                    let v = d[a] * d[b] / length2 * 1e5;
                    for (p, q, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
                        k[(3 * p + a) * order + 3 * q + b] += sign * v;
                    }
                }
            }
        }
    }
    let stiffness = decks::Csr::from_dense(order, &k);
    let mut modes = vec![vec![0.0; order]; 6];
    for i in 0..n * n * n {
        let [x, y, z] = position(i);
        (0..3).for_each(|a| modes[a][3 * i + a] = 1.0);
        (modes[3][3 * i], modes[3][3 * i + 1]) = (-y, x);
        (modes[4][3 * i + 1], modes[4][3 * i + 2]) = (-z, y);
        (modes[5][3 * i], modes[5][3 * i + 2]) = (z, -x);
    }
    let mut all = decks::Deck::new("a cube of springs", vec![body(stiffness, modes, vec![0.0; order])]);
    for x in 0..n {
        for y in 0..n {
            let node = at(x, y, 0);
            (0..3).for_each(|a| all.equalities.push(&[(3 * node + a, 1.0)], 0.0));
            let side = at(n - 1, x, y);
            all.contact.push(&[(3 * side, 1.0)], 1e-6);
        }
    }
    let mut problem = hand_over::problem(&all).unwrap();
    problem.set_str("start", "previous").unwrap();
    problem
}
