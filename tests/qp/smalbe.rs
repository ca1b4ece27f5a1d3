//! SMALBE-M against proportioning and against solutions by hand.

use std::sync::atomic::{AtomicUsize, Ordering};

use approx::assert_relative_eq;
use decks::random::Random;
use feti_contact::error::{Error, Kind, Result};
use feti_contact::linalg::{Csr, Operator};
use feti_contact::qp::{
    smalbe, AcceptanceTest, Limits, Observer, Preconditioner, Qp, Solution, StepReport, Verdict,
};

use crate::dense::{norm, Dense};
use crate::program::Program;

const LIMITS: Limits = Limits { tolerance: 1e-12, gamma: 1.0, steps: 20_000 };

/// Accepts by the residuals of the optimality conditions.
struct Conditions<'a>(&'a Program);

impl AcceptanceTest for Conditions<'_> {
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64> {
        Ok(self.0.residuals(x, alpha).gradient_size)
    }

    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool> {
        Ok(self.0.residuals(x, alpha).within(1e-9))
    }
}

struct Silent;

impl Observer for Silent {
    fn step(&mut self, _: &StepReport) -> Result<()> {
        Ok(())
    }
}

fn qp<'a>(program: &'a Program, a: &'a dyn Operator, g_transposed: &'a Csr) -> Qp<'a> {
    let (b, e, bounded) = (&program.b, &program.e, &program.bounded);
    Qp { a, b, g_transposed, blocks: &[], rounding: 1e-14, e, bounded, preconditioner: None, kept: None }
}

fn run(program: &Program, start: &[f64], limits: Limits) -> Solution {
    let g_transposed = program.g_transposed();
    let qp = qp(program, &program.a, &g_transposed);
    smalbe(qp, start, limits, &mut Conditions(program), &mut Silent).unwrap()
}

fn solved(program: &Program) -> Solution {
    let solution = run(program, &vec![0.0; program.b.len()], LIMITS);
    let residuals = program.residuals(&solution.x, &solution.alpha);
    assert_eq!(solution.verdict, Verdict::Solved, "{:?} {residuals:?}", solution.counts);
    assert!(residuals.within(1e-9), "{residuals:?}");
    solution
}

fn assert_near(found: &[f64], expected: &[f64], relative: f64) {
    assert_eq!(found.len(), expected.len());
    let difference: Vec<f64> = found.iter().zip(expected).map(|(x, y)| x - y).collect();
    let size = norm(expected).max(1.0);
    assert!(norm(&difference) <= relative * size, "{found:?} is not {expected:?}");
}

/// A positive definite, r equalities that a point with half of its rows at zero satisfies, every fourth row free.
fn random_program(m: usize, r: usize, seed: u64) -> Program {
    let mut random = Random::new(seed);
    let mut a = Dense::gram(&Dense((0..m + 2).map(|_| random.normals(m, 1.0)).collect()));
    (0..m).for_each(|i| a.0[i][i] += 0.1);
    let g = Dense((0..r).map(|_| random.normals(m, 1.0)).collect());
    let x: Vec<f64> = random.normals(m, 1.0).iter().map(|x| x.max(0.0)).collect();
    let bounded = (0..m).map(|i| i % 4 != 3).collect();
    Program { a, b: random.normals(m, 3.0), e: g.times(&x), g, bounded }
}

#[test]
fn random_programs_are_solved_as_by_proportioning() {
    for seed in 0..60 {
        for r in [0, 1, 3] {
            let program = random_program(5 + seed as usize % 16, r, seed);
            let (found, expected) = (solved(&program), program.solved());
            assert_near(&found.x, &expected.x, 1e-8);
            assert_near(&found.alpha, &expected.alpha, 1e-8);
        }
    }
}

#[test]
fn any_start_leads_to_the_same_answer() {
    for seed in 0..20 {
        let program = random_program(12, 2, seed);
        let expected = solved(&program);
        let start = Random::new(seed + 100).normals(12, 10.0);
        let found = run(&program, &start, LIMITS);
        assert_eq!(found.verdict, Verdict::Solved, "seed {seed}");
        assert_near(&found.x, &expected.x, 1e-8);
    }
}

#[test]
fn without_equalities_mprgp_alone_solves_the_program() {
    // x = (1/2, 0): r = A x - b = (0, 1/2 + 1)
    let program = Program::new(Dense(vec![vec![2.0, 1.0], vec![1.0, 2.0]]), &[1.0, -1.0]);
    let solution = solved(&program);
    assert_near(&solution.x, &[0.5, 0.0], 1e-12);
    assert_eq!((solution.alpha.len(), solution.counts.coarse_factorisations), (0, 0));
    // without bounds it is the method of conjugate gradients: three eigenvalues, three steps
    let free = Program::new(Dense::diagonal(&[1.0, 2.0, 3.0, 1.0, 2.0]), &[1.0, -2.0, 3.0, 4.0, 5.0])
        .with_free_rows(&[0, 1, 2, 3, 4]);
    let counts = solved(&free).counts;
    assert_eq!((counts.conjugate_gradient, counts.expansions, counts.releases), (3, 0, 0));
}

#[test]
fn every_product_is_counted() {
    let program = random_program(12, 2, 5);
    let g_transposed = program.g_transposed();
    let counting = Counting { a: &program.a, products: 0.into() };
    let qp = qp(&program, &counting, &g_transposed);
    let solution = smalbe(qp, &[0.0; 12], LIMITS, &mut Conditions(&program), &mut Silent).unwrap();
    assert_eq!(solution.counts.products, counting.products.into_inner());
    assert!(solution.counts.products > solution.counts.steps(), "those of the power iteration too");
}

struct Counting<'a> {
    a: &'a Dense,
    products: AtomicUsize,
}

impl Operator for Counting<'_> {
    fn order(&self) -> usize {
        self.a.order()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.products.fetch_add(1, Ordering::Relaxed);
        self.a.apply(x, y);
    }
}

#[test]
fn at_a_degenerate_vertex_its_own_multiplier_is_the_right_one() {
    let identity = || Dense::diagonal(&[1.0; 3]);
    // x1 + x2 + x3 = 0 with x >= 0 leaves only 0: r = (-1, -3, 2) - alpha (1, 1, 1) >= 0 with alpha <= -3
    let corner = Program::new(identity(), &[1.0, 3.0, -2.0]).with_equalities(&[&[1.0, 1.0, 1.0]], &[0.0]);
    let solution = solved(&corner);
    assert_eq!(solution.x, [0.0; 3]);
    assert!(solution.alpha[0] <= -3.0 + 1e-8, "{:?}", solution.alpha);
    // x2 + x3 = 0 leaves only (1, 0, 0)
    let point = Program::new(identity(), &[2.0, 1.0, 4.0])
        .with_equalities(&[&[1.0, 1.0, 1.0], &[0.0, 1.0, 1.0]], &[1.0, 0.0]);
    assert_near(&solved(&point).x, &[1.0, 0.0, 0.0], 1e-9);
}

#[test]
fn as_many_rows_as_modes_leave_the_penalty_alone() {
    // three rows, three modes: x = G^-1 e whatever A and b; P A P = 0
    let g: [&[f64]; 3] = [&[1.0, 1.0, 1.0], &[0.0, 1.0, -1.0], &[1.0, 0.0, -1.0]];
    let a = Dense::gram(&Dense(vec![vec![1.0, 2.0, 0.0], vec![0.0, 1.0, -1.0]]));
    let program = Program::new(a, &[5.0, -7.0, 1.0]).with_equalities(&g, &[6.0, -1.0, -2.0]);
    for free in [vec![], vec![1], vec![0, 1, 2]] {
        assert_near(&solved(&program.clone().with_free_rows(&free)).x, &[1.0, 2.0, 3.0], 1e-9);
    }
}

#[test]
fn without_curvature_a_linear_program_is_solved() {
    // x1 + 2 x2 + 3 x3 -> min on x1 + x2 + x3 = 2: (2, 0, 0), alpha = 1
    let program =
        Program::new(Dense::zeros(3, 3), &[-1.0, -2.0, -3.0]).with_equalities(&[&[1.0, 1.0, 1.0]], &[2.0]);
    let solution = solved(&program);
    assert_near(&solution.x, &[2.0, 0.0, 0.0], 1e-9);
    assert_near(&solution.alpha, &[1.0], 1e-9);
}

#[test]
fn a_mode_that_depends_on_others_changes_nothing() {
    let once = Program::new(Dense::diagonal(&[1.0, 2.0, 4.0]), &[1.0, 1.0, -1.0])
        .with_equalities(&[&[1.0, 1.0, 1.0]], &[2.0]);
    let thrice = once
        .clone()
        .with_equalities(&[&[1.0, 1.0, 1.0], &[2.0, 2.0, 2.0], &[0.0, 0.0, 0.0]], &[2.0, 4.0, 0.0]);
    let (expected, found) = (solved(&once), solved(&thrice));
    assert_near(&found.x, &expected.x, 1e-9);
    assert_relative_eq!(found.alpha[0] + 2.0 * found.alpha[1], expected.alpha[0], max_relative = 1e-8);
    assert_eq!(found.undetermined, 2);
}

#[test]
fn dependent_rows_share_a_force() {
    // two rows on one spring: A = (1 1; 1 1), the forces share 3 - 1 = 2
    let solution = solved(&Program::new(Dense(vec![vec![1.0; 2]; 2]), &[2.0, 2.0]));
    assert_relative_eq!(solution.x[0] + solution.x[1], 2.0, max_relative = 1e-9);
    // theta(x1, x2) = 1/2 (x1 - x2)^2 - x1 - x2 falls without end along (1, 1)
    let endless = Program::new(Dense(vec![vec![1.0, -1.0], vec![-1.0, 1.0]]), &[1.0, 1.0]);
    let Verdict::Unbounded { p } = run(&endless, &[0.0; 2], LIMITS).verdict else { panic!("bounded") };
    assert!(p[0] < 0.0 && p[0] == p[1], "{p:?}");
}

#[test]
fn equalities_that_no_point_meets_end_at_the_step_limit() {
    let program = Program::new(Dense::diagonal(&[1.0; 3]), &[1.0, 2.0, 3.0])
        .with_equalities(&[&[1.0, 1.0, 1.0]], &[-1.0]);
    let limits = Limits { steps: 300, ..LIMITS };
    assert_eq!(run(&program, &[0.0; 3], limits).verdict, Verdict::StepLimit);
    assert_eq!(run(&program, &[0.0; 3], LIMITS).verdict, Verdict::StepLimit);
}

#[test]
fn powers_of_two_give_the_same_bits_and_the_same_counts() {
    let times =
        |values: &[f64], power: i32| -> Vec<f64> { values.iter().map(|v| v * 2f64.powi(power)).collect() };
    let all = |matrix: &Dense, power: i32| Dense(matrix.0.iter().map(|row| times(row, power)).collect());
    for seed in 0..20 {
        let program = random_program(12, 2, seed);
        let expected = solved(&program);
        for (a, b, g) in [(1, 0, 0), (0, 1, 0), (0, 0, 1), (37, 37, 0), (-60, 3, 11), (5, -90, -7)] {
            let scaled = Program {
                a: all(&program.a, a),
                b: times(&program.b, b),
                g: all(&program.g, g),
                e: times(&program.e, g + b - a),
                bounded: program.bounded.clone(),
            };
            let found = solved(&scaled);
            assert_eq!(found.counts, expected.counts, "seed {seed}, 2^{a}, 2^{b}, 2^{g}");
            assert_eq!(found.x, times(&expected.x, b - a));
            assert_eq!(found.alpha, times(&expected.alpha, b - g));
        }
    }
}

/// The inverse of the diagonal of A on the face.
struct Jacobi<'a>(&'a Dense);

impl Preconditioner for Jacobi<'_> {
    fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        (0..r.len()).for_each(|i| z[i] = if held[i] { 0.0 } else { r[i] / self.0 .0[i][i] });
        Ok(())
    }
}

#[test]
fn a_preconditioner_changes_the_number_of_steps_only() {
    for seed in 0..10 {
        let mut program = random_program(20, 1, seed);
        program.a = Dense::diagonal(&(0..20).map(|i| 2f64.powi(i % 10)).collect::<Vec<_>>());
        let expected = solved(&program);
        let jacobi = Jacobi(&program.a);
        let g_transposed = program.g_transposed();
        let found = smalbe(
            Qp { preconditioner: Some(&jacobi), ..qp(&program, &program.a, &g_transposed) },
            &[0.0; 20],
            LIMITS,
            &mut Conditions(&program),
            &mut Silent,
        )
        .unwrap();
        assert_eq!(found.verdict, Verdict::Solved, "seed {seed}");
        assert_near(&found.x, &expected.x, 1e-8);
        assert_near(&found.alpha, &expected.alpha, 1e-8);
        assert!(found.counts.preconditioned > 0 && expected.counts.preconditioned == 0);
        assert!(
            found.counts.steps() < expected.counts.steps(),
            "seed {seed}: {:?} {:?}",
            found.counts,
            expected.counts
        );
    }
}

/// Remembers theta and allows a number of steps.
struct Watching {
    theta: f64,
    allowed: usize,
}

impl Observer for Watching {
    fn step(&mut self, now: &StepReport) -> Result<()> {
        self.theta = now.theta;
        if now.counts.steps() < self.allowed {
            Ok(())
        } else {
            Err(Error::new(Kind::Cancelled, "enough"))
        }
    }
}

#[test]
fn the_observer_sees_theta_and_may_end_the_run_at_the_point_reached() {
    for seed in 0..10 {
        let program = random_program(12, 2, seed);
        let g_transposed = program.g_transposed();
        let run = |allowed| {
            let mut watching = Watching { theta: 0.0, allowed };
            let (qp, start) = (qp(&program, &program.a, &g_transposed), [0.0; 12]);
            let found = smalbe(qp, &start, LIMITS, &mut Conditions(&program), &mut watching).unwrap();
            (found, watching.theta)
        };
        let (whole, theta) = run(usize::MAX);
        assert_relative_eq!(theta, program.value(&whole.x), max_relative = 1e-9, epsilon = 1e-9);
        let (part, _) = run(5);
        assert_eq!((part.verdict, part.counts.steps()), (Verdict::Cancelled, 5));
        assert!(program.residuals(&part.x, &part.alpha).lowest >= 0.0);
    }
}
