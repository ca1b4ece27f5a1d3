//! A run that is watched: what the observer sees, and what is left when observer or operator end it.

use std::sync::atomic::{AtomicUsize, Ordering};

use decks::random::Random;
use feti_contact::error::{Error, Kind, Result};
use feti_contact::linalg::Operator;
use feti_contact::qp::{
    minimise, AcceptanceTest, Limits, Observer, Qp, Solution, StepKind, StepReport, Verdict,
};

use crate::qp::dense::Dense;
use crate::qp::program::Program;

/// A, for so many products.
struct Limited<'a> {
    a: &'a Dense,
    left: AtomicUsize,
    then: Kind,
}

impl Operator for Limited<'_> {
    fn order(&self) -> usize {
        self.a.order()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.a.apply(x, y);
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        let counted =
            self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
        counted.map_err(|_| Error::new(self.then, "no more products"))?;
        self.a.try_apply(x, y)
    }
}

/// Every step, and the error that ends the run at one of them.
#[derive(Default)]
struct Diary {
    steps: Vec<(StepKind, usize, f64)>,
    last: Option<(usize, Kind)>,
}

impl Observer for Diary {
    fn step(&mut self, now: &StepReport) -> Result<()> {
        let size = (now.free * now.free + now.chopped * now.chopped).sqrt();
        assert!((size - now.residual).abs() <= 1e-14 * size && now.small > 0.0);
        self.steps.push((now.kind, now.counts.steps(), now.theta));
        match self.last {
            Some((step, kind)) if step == self.steps.len() => Err(Error::new(kind, "enough")),
            _ => Ok(()),
        }
    }
}

struct Content;

impl AcceptanceTest for Content {
    fn scale(&mut self, _: &[f64], _: &[f64]) -> Result<f64> {
        Ok(1.0)
    }

    fn accepts(&mut self, _: &[f64], _: &[f64]) -> Result<bool> {
        Ok(true)
    }
}

/// From `start`, with so many products.
fn run(program: &Program, start: &[f64], products: usize, then: Kind, diary: &mut Diary) -> Result<Solution> {
    let a = Limited { a: &program.a, left: AtomicUsize::new(products), then };
    let g_transposed = program.g_transposed();
    let qp = Qp::plain(&a, &program.b, &g_transposed, &program.e, &program.bounded);
    let limits = Limits { tolerance: 1e-12, gamma: 1.0, steps: 5000 };
    minimise(qp, start, limits, &mut Content, diary)
}

/// Definite, bounded, sum of all entries 10: expansions, releases and conjugate gradients.
fn program(seed: u64) -> Program {
    let (mut random, m) = (Random::new(seed), 24);
    let mut a = Dense::diagonal(&(0..m).map(|k| 1.0 + k as f64).collect::<Vec<_>>());
    for _ in 0..4 {
        let direction = random.normals(m, 1.0);
        for (row, d) in a.0.iter_mut().zip(&direction) {
            row.iter_mut().zip(&direction).for_each(|(a, e)| *a += d * e);
        }
    }
    Program::new(a, &random.normals(m, 20.0)).with_equalities(&[&[1.0; 24]], &[10.0])
}

#[test]
fn a_refused_product_leaves_a_feasible_point_no_worse_than_those_before() {
    for seed in 0..10 {
        let program = program(seed);
        let start = vec![0.0; 24];
        let whole = run(&program, &start, usize::MAX, Kind::Cancelled, &mut Diary::default()).unwrap();
        assert!(whole.verdict == Verdict::Solved && whole.counts.expansions > 0, "{:?}", whole.counts);
        let mut value = f64::INFINITY;
        for products in 1..whole.counts.products {
            let ended = run(&program, &start, products, Kind::Cancelled, &mut Diary::default()).unwrap();
            assert_eq!((&ended.verdict, ended.counts.products), (&Verdict::Cancelled, products));
            let residuals = program.residuals(&ended.x, &ended.alpha);
            assert!(residuals.lowest >= 0.0 && residuals.equality <= 1e-11 * residuals.equality_size);
            let next = program.value(&ended.x);
            assert!(
                next <= value + 1e-12 * value.abs(),
                "seed {seed}, product {products}: {value} to {next}"
            );
            value = next;
        }
    }
}

#[test]
fn the_kind_of_a_refusal_decides_how_the_run_ends() {
    let (program, start) = (program(3), [0.0; 24]);
    let after = |products, kind| run(&program, &start, products, kind, &mut Diary::default());
    assert_eq!(after(3, Kind::TimeOver).unwrap().verdict, Verdict::TimeLimit);
    assert_eq!(after(3, Kind::State).unwrap_err().kind, Kind::State);
    assert_eq!(after(0, Kind::Cancelled).unwrap_err().kind, Kind::Cancelled, "there is no point yet");
}

#[test]
fn the_observer_sees_every_step_with_a_functional_that_falls_and_may_end_the_run() {
    let (program, start) = (program(5), [0.0; 24]);
    let mut diary = Diary::default();
    let solution = run(&program, &start, usize::MAX, Kind::Cancelled, &mut diary).unwrap();
    let count = |kind| diary.steps.iter().filter(|step| step.0 == kind).count();
    assert_eq!(count(StepKind::ConjugateGradient), solution.counts.conjugate_gradient);
    assert_eq!(count(StepKind::Expansion), solution.counts.expansions);
    assert_eq!(count(StepKind::Proportioning), solution.counts.releases);
    assert!(diary.steps.iter().enumerate().all(|(k, step)| step.1 == k + 1));
    assert!(diary.steps.windows(2).all(|two| two[1].2 <= two[0].2 + 1e-12 * two[0].2.abs()));
    let last = diary.steps.last().unwrap().2;
    approx::assert_relative_eq!(last, program.value(&solution.x), max_relative = 1e-12);

    for (kind, verdict) in [(Kind::Cancelled, Verdict::Cancelled), (Kind::TimeOver, Verdict::TimeLimit)] {
        let mut diary = Diary { last: Some((2, kind)), ..Diary::default() };
        let ended = run(&program, &start, usize::MAX, Kind::State, &mut diary).unwrap();
        assert_eq!((ended.verdict, ended.counts.steps()), (verdict, 2));
    }
    let mut diary = Diary { last: Some((2, Kind::Callback)), ..Diary::default() };
    let failed = run(&program, &start, usize::MAX, Kind::State, &mut diary);
    assert_eq!(failed.unwrap_err().kind, Kind::Callback);
}

#[test]
fn a_run_ends_with_the_last_step_that_it_may_take() {
    let program = program(5);
    let g_transposed = program.g_transposed();
    let qp = Qp::plain(&program.a, &program.b, &g_transposed, &program.e, &program.bounded);
    for steps in [1, 2, 5] {
        let limits = Limits { tolerance: 1e-12, gamma: 1.0, steps };
        let ended = minimise(qp, &[0.0; 24], limits, &mut Content, &mut Diary::default()).unwrap();
        assert_eq!((ended.verdict, ended.counts.steps()), (Verdict::StepLimit, steps));
    }
}

/// The first point is what one product leaves.
fn first_point(program: &Program, start: &[f64]) -> Vec<f64> {
    run(program, start, 1, Kind::Cancelled, &mut Diary::default()).unwrap().x
}

#[test]
fn a_start_keeps_its_zeros_where_their_face_is_feasible() {
    let program = Program::new(Dense::diagonal(&[1.0; 4]), &[1.0, 5.0, -3.0, 2.0])
        .with_equalities(&[&[1.0, 1.0, 1.0, 0.0]], &[4.0]);
    let first = first_point(&program, &[1.0, 0.0, 2.0, 7.0]);
    for (found, expected) in first.iter().zip([1.5, 0.0, 2.5, 7.0]) {
        assert!((found - expected).abs() < 1e-14, "{first:?}");
    }
    // no point with x_0 = x_1 = x_2 = 0 satisfies the equality: the nearest one of all
    let first = first_point(&program, &[0.0, -1.0, 0.0, 7.0]);
    for (found, expected) in first.iter().zip([5.0 / 3.0, 2.0 / 3.0, 5.0 / 3.0, 7.0]) {
        assert!((found - expected).abs() < 1e-14, "{first:?}");
    }
}

#[test]
fn the_solution_is_its_own_best_start() {
    for seed in 0..10 {
        let program = program(seed);
        let cold = program.solved();
        let warm = program.minimise_from(&cold.x, 1e-12, 1e-9);
        assert_eq!(warm.verdict, Verdict::Solved);
        assert!(warm.counts.steps() <= 2, "seed {seed}: {:?}", warm.counts);
    }
}
