//! Programs that lead a method on proportioning astray, each solved by hand.

use approx::assert_relative_eq;
use decks::random::Random;
use feti_contact::error::Result;
use feti_contact::qp::{minimise, Observer, StepKind, StepReport, Verdict};

use crate::qp::dense::{dot, norm, Dense};
use crate::qp::program::Program;

fn assert_near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_relative_eq!(*found, *expected, epsilon = 1e-9, max_relative = 1e-9);
    }
}

fn identity(m: usize) -> Dense {
    Dense::diagonal(&vec![1.0; m])
}

#[test]
fn without_rows_there_is_nothing_to_do() {
    let solution = Program::new(Dense(vec![]), &[]).solved();
    assert!(solution.x.is_empty() && solution.counts.steps() == 0);
    let balanced = Program::new(Dense(vec![]), &[]).with_equalities(&[&[], &[]], &[0.0, 0.0]);
    assert_eq!(balanced.solved().undetermined, 2);
    let loose = Program::new(Dense(vec![]), &[]).with_equalities(&[&[], &[]], &[0.0, 3.0]);
    assert!(
        matches!(loose.minimise().verdict, Verdict::Infeasible { direction, .. } if direction == [0.0, 3.0])
    );
}

#[test]
fn without_modes_the_bounds_alone_hold() {
    // x = (1/2, 0): r = A x - b = (0, 1/2 + 1)
    let program = Program::new(Dense(vec![vec![2.0, 1.0], vec![1.0, 2.0]]), &[1.0, -1.0]);
    assert_near(&program.solved().x, &[0.5, 0.0]);
    assert_near(&Program::new(identity(3), &[-1.0, -2.0, 0.0]).solved().x, &[0.0; 3]);
}

#[test]
fn without_load_the_answer_is_zero_at_once() {
    let program = Program::new(identity(3), &[0.0; 3]).with_equalities(&[&[1.0, -1.0, 2.0]], &[0.0]);
    let solution = program.solved();
    assert_eq!((solution.x.as_slice(), solution.counts.steps()), ([0.0; 3].as_slice(), 0));
}

#[test]
fn without_bounds_one_linear_system_is_solved() {
    // A x - G'alpha = b, x1 + x2 + x3 = 3: x_i = (b_i + alpha) / i with alpha = (3 - 1 + 1 - 1) / (11/6)
    let program = Program::new(Dense::diagonal(&[1.0, 2.0, 3.0]), &[1.0, -2.0, 3.0])
        .with_equalities(&[&[1.0, 1.0, 1.0]], &[3.0])
        .with_free_rows(&[0, 1, 2]);
    let solution = program.solved();
    let alpha = 12.0 / 11.0;
    assert_near(&solution.alpha, &[alpha]);
    assert_near(&solution.x, &[1.0 + alpha, (alpha - 2.0) / 2.0, (alpha + 3.0) / 3.0]);
    assert_eq!((solution.counts.expansions, solution.counts.releases), (0, 0));
    assert!(solution.counts.conjugate_gradient <= 3, "{:?}", solution.counts);
}

/// Least squares on the face give one of many multipliers, and not always one that proves the vertex optimal.
#[test]
fn a_degenerate_vertex_is_optimal_though_its_least_squares_multiplier_says_otherwise() {
    // x1 + x2 = 0 with x >= 0 leaves only 0: r = (-1, -3) - alpha (1, 1) >= 0 with alpha <= -3
    let corner = Program::new(identity(2), &[1.0, 3.0]).with_equalities(&[&[1.0, 1.0]], &[0.0]);
    assert_near(&corner.solved().x, &[0.0; 2]);
    // x2 + x3 = 0 leaves only (1, 0, 0)
    let point = Program::new(identity(3), &[2.0, 1.0, 4.0])
        .with_equalities(&[&[1.0, 1.0, 1.0], &[0.0, 1.0, 1.0]], &[1.0, 0.0]);
    assert_near(&point.solved().x, &[1.0, 0.0, 0.0]);
    // x1 = x2: theta = x^2 + 2 x, 0 is optimal with alpha in [-3, -1]; no row moves, least squares give 0
    let line = Program::new(identity(2), &[1.0, -3.0]).with_equalities(&[&[1.0, -1.0]], &[0.0]);
    assert_near(&line.solved().x, &[0.0; 2]);
    // x1 = x2: theta = x^2 - 2 x, 0 is a vertex and not optimal
    let line = Program::new(identity(2), &[-1.0, 3.0]).with_equalities(&[&[1.0, -1.0]], &[0.0]);
    assert_near(&line.solved().x, &[1.0, 1.0]);
    // x1 = 2 x2 + x3: (1/2, 0, 1/2) with alpha = -1/2 leaves r = (0, 4, 0)
    let cone = Program::new(identity(3), &[1.0, -5.0, 0.0]).with_equalities(&[&[1.0, -2.0, -1.0]], &[0.0]);
    let solution = cone.solved();
    assert_near(&solution.x, &[0.5, 0.0, 0.5]);
    assert_near(&solution.alpha, &[-0.5]);
}

/// P d = 0: neither a scale for the stop nor a direction can be taken from it.
#[test]
fn as_many_rows_as_modes_leave_no_direction_to_search() {
    // three rows, three modes: x = G^-1 e whatever A and b, alpha = G^-T (A x - b)
    let g: [&[f64]; 3] = [&[1.0, 1.0, 1.0], &[0.0, 1.0, -1.0], &[1.0, 0.0, -1.0]];
    let a = Dense::gram(&Dense(vec![vec![1.0, 2.0, 0.0], vec![0.0, 1.0, -1.0]]));
    let program = Program::new(a, &[5.0, -7.0, 1.0]).with_equalities(&g, &[6.0, -1.0, -2.0]);
    for free in [vec![], vec![1], vec![0, 1, 2]] {
        let solution = program.clone().with_free_rows(&free).solved();
        assert_near(&solution.x, &[1.0, 2.0, 3.0]);
        assert!(solution.counts.products <= 3, "{:?}", solution.counts);
    }
}

#[test]
fn dependent_rows_give_one_displacement_though_the_multipliers_are_many() {
    // two rows on one spring: A = (1 1; 1 1), the forces share 3 - 1 = 2
    let twice = Program::new(Dense(vec![vec![1.0; 2]; 2]), &[2.0, 2.0]);
    let solution = twice.solved();
    assert_relative_eq!(solution.x[0] + solution.x[1], 2.0, max_relative = 1e-9);
    // three equal rows against one mode and another row
    let row = [1.0, 1.0, 1.0, -2.0];
    let a = Dense::gram(&Dense(vec![row.to_vec()]));
    let mode: &[f64] = &[1.0, 1.0, 1.0, 1.0];
    let solution = Program::new(a, &[3.0, 3.0, 3.0, 0.0]).with_equalities(&[mode], &[3.0]).solved();
    // y = sum of the first three, x4 = 3 - y: 1/2 (3 y - 6)^2 - 3 y -> min at y = 7/3
    assert_relative_eq!(solution.x[3], 2.0 / 3.0, max_relative = 1e-9);
}

#[test]
fn of_repeated_rows_the_tightest_carries_the_force() {
    // rows of one spring k = 1 with gaps 0, .1, .2, 1e-9: b_i = 1 - c_i; the tightest alone is closed
    let gaps = [0.1, 0.0, 0.2, 1e-3];
    let b: Vec<f64> = gaps.iter().map(|c| 1.0 - c).collect();
    let solution = Program::new(Dense(vec![vec![1.0; 4]; 4]), &b).solved();
    assert_near(&solution.x, &[0.0, 1.0, 0.0, 0.0]);
    // the same under a body that floats: the force is the load
    let mode: &[f64] = &[1.0; 4];
    let solution = Program::new(Dense(vec![vec![1.0; 4]; 4]), &b).with_equalities(&[mode], &[5.0]).solved();
    assert_near(&solution.x, &[0.0, 5.0, 0.0, 0.0]);
}

#[test]
fn a_mode_that_depends_on_others_changes_nothing() {
    let once = Program::new(Dense::diagonal(&[1.0, 2.0, 4.0]), &[1.0, 1.0, -1.0])
        .with_equalities(&[&[1.0, 1.0, 1.0]], &[2.0]);
    let thrice = once
        .clone()
        .with_equalities(&[&[1.0, 1.0, 1.0], &[2.0, 2.0, 2.0], &[0.0, 0.0, 0.0]], &[2.0, 4.0, 0.0]);
    let (expected, found) = (once.solved(), thrice.solved());
    assert_near(&found.x, &expected.x);
    assert_relative_eq!(found.alpha[0] + 2.0 * found.alpha[1], expected.alpha[0], max_relative = 1e-9);
    assert_eq!(found.undetermined, 2);
    let torn = thrice
        .clone()
        .with_equalities(&[&[1.0, 1.0, 1.0], &[2.0, 2.0, 2.0], &[0.0, 0.0, 0.0]], &[2.0, 5.0, 0.0]);
    assert!(matches!(torn.minimise().verdict, Verdict::Infeasible { .. }));
}

/// m rows with eigenvalues of A from 1 to `condition`, r random modes, half of the rows active at the answer.
fn stiff(m: usize, r: usize, condition: f64, seed: u64) -> Program {
    let mut random = Random::new(seed);
    let mut a = Dense::zeros(m, m);
    for k in 0..m {
        let direction = random.normals(m, 1.0);
        let size = condition.powf(k as f64 / (m - 1) as f64) / dot(&direction, &direction);
        for (row, &d) in a.0.iter_mut().zip(&direction) {
            row.iter_mut().zip(&direction).for_each(|(a, e)| *a += size * d * e);
        }
    }
    let g = Dense((0..r).map(|_| random.normals(m, 1.0)).collect());
    let x: Vec<f64> = (0..m).map(|i| if i % 2 == 0 { random.between(0.5, 1.5) } else { 0.0 }).collect();
    let coarse = g.transpose_times(&random.normals(r, 1.0), m);
    let image = a.times(&x);
    let force = |i: usize| if x[i] > 0.0 { 0.0 } else { 0.1 * (1.0 + i as f64) };
    let b = (0..m).map(|i| image[i] - coarse[i] - force(i)).collect();
    let e = g.times(&x);
    Program { a, b, g, e, bounded: vec![true; m] }
}

#[test]
fn conjugate_gradients_reach_the_tightest_tolerance_without_leaving_the_equalities() {
    for seed in 0..20 {
        let program = stiff(40, 3, 1e4, seed);
        let solution = program.minimise_from(&[0.0; 40], 1e-14, 1e-13);
        let residuals = program.residuals(&solution.x, &solution.alpha);
        assert_eq!(solution.verdict, Verdict::Solved, "seed {seed}: {:?} {residuals:?}", solution.counts);
        assert!(solution.counts.steps() < 1000, "seed {seed}: {:?}", solution.counts);
        assert!((1..40).step_by(2).all(|i| solution.x[i] == 0.0), "seed {seed}: the active rows");
    }
}

/// A projection with `G G'` of condition 1e6 leaves 1e-10 of what it should take away: after a single one,
/// conjugate gradients leave the equalities and diverge.
#[test]
fn modes_that_almost_depend_on_each_other_do_not_spoil_the_equalities() {
    for seed in 0..20 {
        let mut program = stiff(40, 3, 1e3, seed);
        let (first, rest) = program.g.0.split_at_mut(1);
        for row in rest {
            row.iter_mut().zip(&first[0]).for_each(|(v, first)| *v = first + 1e-3 * *v);
        }
        let x: Vec<f64> = (0..40).map(|i| if i % 2 == 0 { 1.0 } else { 0.0 }).collect();
        program.e = program.g.times(&x);
        let solution = program.minimise_from(&[0.0; 40], 1e-12, 1e-8);
        let residuals = program.residuals(&solution.x, &solution.alpha);
        assert_eq!(solution.verdict, Verdict::Solved, "seed {seed}: {:?} {residuals:?}", solution.counts);
        assert!(residuals.equality <= 1e-11 * residuals.equality_size, "seed {seed}: {residuals:?}");
    }
}

#[test]
fn a_tighter_tolerance_never_gives_a_larger_theta() {
    for seed in 0..20 {
        let program = stiff(30, 2, 1e3, seed);
        let values: Vec<f64> = [1e-2, 1e-4, 1e-8, 1e-12]
            .map(|t| program.value(&program.minimise_from(&[0.0; 30], t, 1.0).x))
            .into();
        let size = norm(&values);
        assert!(values.windows(2).all(|pair| pair[1] <= pair[0] + 1e-14 * size), "seed {seed}: {values:?}");
    }
}

/// Remembers the active set before every step.
#[derive(Default)]
struct Faces {
    last: Vec<bool>,
    expansions: usize,
}

impl Observer for Faces {
    fn step(&mut self, now: &StepReport) -> Result<()> {
        if now.kind == StepKind::Expansion {
            let opened = self.last.iter().zip(now.active).filter(|(before, after)| **before && !**after);
            assert_eq!(opened.count(), 0, "an expansion has opened rows");
            self.expansions += usize::from(self.last.contains(&true));
        }
        self.last = now.active.to_vec();
        Ok(())
    }
}

/// Projected on the whole feasible set, the point of an expansion opens rows that the face has closed; they close
/// again, and open again, for ever.
#[test]
fn an_expansion_never_opens_a_closed_row() {
    let mut expansions = 0;
    for seed in 0..20 {
        let program = stiff(60, 2, 1e3, seed);
        let mut faces = Faces::default();
        let solution = program.watched(minimise, &[0.0; 60], &mut faces);
        assert_eq!(solution.verdict, Verdict::Solved, "seed {seed}");
        expansions += faces.expansions;
    }
    assert!(expansions > 20, "{expansions} from faces with closed rows show nothing");
}
