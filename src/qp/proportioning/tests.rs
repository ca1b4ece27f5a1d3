use super::*;
use crate::linalg::{Csr, Operator, Packed};
use crate::qp::acceptance::tests::Lenient;

/// Gradients by A, directions by A (1 + 1e-5 E), both symmetric and definite.
struct Near {
    own: Packed,
    near: Packed,
}

impl Operator for Near {
    fn order(&self) -> usize {
        self.own.order()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.own.apply(x, y);
    }

    fn approximate(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.near.apply(x, y);
        Ok(())
    }

    fn has_approximation(&self) -> bool {
        true
    }
}

const M: usize = 150;
const LIMITS: Limits = Limits { tolerance: 1e-11, gamma: 1.0, steps: 10_000 };

/// A tridiagonal.
fn matrix(error: f64) -> Packed {
    let mut a = Packed::zeros(M).unwrap();
    for i in 0..M {
        let wrong = |k: usize| 1.0 + error * (k as f64).sin();
        a.add(i, i, 2.05 * wrong(i));
        (1..=i).take(1).for_each(|_| a.add(i, i - 1, -wrong(3 * i)));
    }
    a
}

fn solve(a: &dyn Operator, b: &[f64], start: &[f64], kept: Option<&BetweenSolves>) -> Solution {
    let mut g_transposed = Csr::empty(2);
    (0..M).for_each(|i| g_transposed.push_row([(0, 1.0), (1, i as f64 / M as f64)]));
    let (e, bounded) = ([30.0, 14.0], (0..M).map(|i| i % 3 > 0).collect::<Vec<_>>());
    let qp = Qp { kept, ..Qp::plain(a, b, &g_transposed, &e, &bounded) };
    let (mut judge, mut observer) = (Lenient { allowed: 0 }, Lenient { allowed: LIMITS.steps });
    minimise(qp, start, LIMITS, &mut judge, &mut observer).unwrap()
}

fn loads(by: f64) -> Vec<f64> {
    (0..M).map(|i| by * (i as f64 * 0.7).sin() - 0.2).collect()
}

fn apart(a: &Solution, b: &Solution) -> f64 {
    let difference: Vec<f64> = a.x.iter().zip(&b.x).map(|(a, b)| a - b).collect();
    norm(&difference) / norm(&b.x)
}

#[test]
fn products_that_are_only_near_lead_to_the_answer_of_the_operator_itself_at_little_more_cost() {
    let cold = vec![0.0; M];
    let exact = solve(&matrix(0.0), &loads(1.0), &cold, None);
    let (near, other) =
        (Near { own: matrix(0.0), near: matrix(1e-5) }, solve(&matrix(1e-5), &loads(1.0), &cold, None));
    let found = solve(&near, &loads(1.0), &cold, None);
    assert!(apart(&other, &exact) > 1e-7, "{:e}", apart(&other, &exact));
    assert!(apart(&found, &exact) < 1e-10, "{:e}", apart(&found, &exact));
    let [found, exact] = [found, exact].map(|solution| solution.counts.products);
    assert!(10 * found <= 12 * exact + 30, "{found} products, {exact} with the operator itself");
}

#[test]
fn directions_of_the_solve_before_save_products_and_change_no_cold_start() {
    let (a, kept, cold) = (matrix(0.0), BetweenSolves::default(), vec![0.0; M]);
    let first = solve(&a, &loads(1.0), &cold, Some(&kept));
    let second = solve(&a, &loads(1.01), &first.x, Some(&kept));
    let without = solve(&a, &loads(1.01), &first.x, None);
    assert!(apart(&second, &without) < 1e-9, "{:e}", apart(&second, &without));
    let [with, without] = [&second, &without].map(|solution| solution.counts.products);
    assert!(4 * with <= 3 * without, "{with} products, {without} without directions");
    let again = solve(&a, &loads(1.0), &cold, Some(&kept));
    assert_eq!((again.x, again.counts), (first.x, first.counts));
}
