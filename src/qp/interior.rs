//! A primal-dual interior point method (Mehrotra 1992) for `min delta/2 |l - y|^2 + rho/2 |a|^2` over `l_i >= 0 (i bounded)`,
//! `G l + rho a = e`: about twenty factorisations of `G D G' + rho I`, D > 0 a diagonal matrix, for any number of rows.
//! Its a shows which rows have a force; other methods then compute the last digits of the answer.

use crate::error::Result;
use crate::linalg::vector::{axpy, norm};
use crate::platform::interrupt;
use crate::qp::coarse::{Coarse, Weighted};
use crate::qp::Qp;

const STEPS: usize = 40;
/// Accuracy of the equations, and of products of forces and their multipliers relative to squared forces.
const ACCURACY: f64 = 1e-7;
const COMPLEMENTARITY: f64 = 1e-12;
/// Part of the step to the next bound.
const CLOSE: f64 = 0.995;

/// The problem: rows in `held` have no force.
#[derive(Clone, Copy)]
pub struct Interior<'a> {
    pub qp: &'a Qp<'a>,
    pub y: &'a [f64],
    pub held: &'a [bool],
    pub delta: f64,
    pub rho: f64,
}

/// `delta (l - y) - G'a - s = 0`, s = 0 on rows without a bound.
pub struct Point {
    /// a, the multiplier of `G l + rho a = e`.
    pub multiplier: Vec<f64>,
    /// l
    pub force: Vec<f64>,
    /// s >= 0, the multiplier of l >= 0.
    pub slack: Vec<f64>,
}

impl Interior<'_> {
    /// A point close to the minimum, within the limits of steps and rounding.
    pub fn minimise(&self, coarse: &mut Coarse, multiplier: Vec<f64>) -> Result<Point> {
        let mut at = self.start(multiplier);
        for step in 0..STEPS {
            interrupt::reached("steps into the interior", step)?;
            let (mean, left) = (self.mean(&at.force, &at.slack), self.left(&at));
            let mut terms = vec![0.0; left.len()];
            self.qp.g_transposed.mul_transposed_abs_add(&at.force, &mut terms);
            let met = norm(&left) <= ACCURACY * (norm(self.qp.e) + norm(&terms));
            if met && mean <= COMPLEMENTARITY * self.mean(&at.force, &at.force) {
                break;
            }
            let weight = |i: usize| {
                let Point { force, slack, .. } = &at;
                let weight = if self.is_inside(i) {
                    force[i] / (self.delta * force[i] + slack[i])
                } else {
                    1.0 / self.delta
                };
                if self.held[i] {
                    0.0
                } else {
                    weight
                }
            };
            let weights: Vec<f64> = (0..self.y.len()).map(weight).collect();
            let Some(factor) = coarse.weighted(&weights, self.rho)? else { break };
            coarse.solves += 2;
            let newton = Newton { of: self, at: &at, left: &left, weights: &weights, factor: &factor };
            let predictor = newton.step(|i| -at.force[i] * at.slack[i])?;
            let t = self.longest(&at, &predictor).min(1.0);
            let ahead = self.mean(&sum(&at.force, t, &predictor.force), &sum(&at.slack, t, &predictor.slack));
            let centre = mean * (ahead / mean).powi(3);
            let product = |i: usize| at.force[i] * at.slack[i] + predictor.force[i] * predictor.slack[i];
            let step = newton.step(|i| centre - product(i))?;
            let t = (CLOSE * self.longest(&at, &step)).min(1.0);
            axpy(t, &step.multiplier, &mut at.multiplier);
            axpy(t, &step.force, &mut at.force);
            axpy(t, &step.slack, &mut at.slack);
        }
        Ok(at)
    }

    /// Whether row i may have a force and has a bound.
    fn is_inside(&self, i: usize) -> bool {
        self.qp.bounded[i] && !self.held[i]
    }

    /// The point on the central path for this multiplier, with forces as large as v = delta y + G'a or e causes.
    fn start(&self, multiplier: Vec<f64>) -> Point {
        let m = self.y.len();
        let v: Vec<f64> =
            (0..m).map(|i| self.delta * self.y[i] + self.qp.g_transposed.row_dot(i, &multiplier)).collect();
        let (mut force, mut slack) = (vec![0.0; m], vec![0.0; m]);
        let mean = self.mean(&v, &v).max(self.rho * norm(self.qp.e).powi(2) / self.qp.e.len() as f64);
        for i in (0..m).filter(|&i| !self.held[i]) {
            if !self.is_inside(i) {
                force[i] = v[i] / self.delta;
            } else {
                // delta l - s = v, l s = mean / delta
                let root = v[i].hypot(2.0 * mean.sqrt());
                (force[i], slack[i]) = if v[i] > 0.0 {
                    let upper = 0.5 * (v[i] + root);
                    (upper / self.delta, mean / upper)
                } else {
                    let upper = 0.5 * (root - v[i]);
                    (mean / upper / self.delta, upper)
                };
            }
        }
        Point { multiplier, force, slack }
    }

    /// Mean of `a_i b_i` over the rows with a bound.
    fn mean(&self, a: &[f64], b: &[f64]) -> f64 {
        let inside = || (0..a.len()).filter(|&i| self.is_inside(i));
        inside().map(|i| a[i] * b[i]).sum::<f64>() / inside().count().max(1) as f64
    }

    /// `e - G l - rho a`
    fn left(&self, at: &Point) -> Vec<f64> {
        let mut left = self.qp.left(&at.force);
        axpy(-self.rho, &at.multiplier, &mut left);
        left
    }

    /// The largest step for which forces and slacks stay >= 0.
    fn longest(&self, at: &Point, step: &Point) -> f64 {
        let bound = |x: f64, dx: f64| if dx < 0.0 { -x / dx } else { f64::INFINITY };
        (0..self.y.len()).filter(|&i| self.is_inside(i)).fold(f64::INFINITY, |t, i| {
            t.min(bound(at.force[i], step.force[i])).min(bound(at.slack[i], step.slack[i]))
        })
    }
}

/// Newton's method at one point, where `delta (l - y) - G'a - s` is 0 and remains 0.
struct Newton<'a> {
    of: &'a Interior<'a>,
    at: &'a Point,
    /// `e - G l - rho a`
    left: &'a [f64],
    /// `D = l / (delta l + s)`
    weights: &'a [f64],
    /// `G D G' + rho I`
    factor: &'a Weighted,
}

impl Newton<'_> {
    /// The step that changes `l_i s_i` by `change`.
    fn step(&self, change: impl Fn(usize) -> f64) -> Result<Point> {
        let (Self { of, at, weights, .. }, g_transposed) = (self, self.of.qp.g_transposed);
        let inside = |i: usize| of.is_inside(i);
        let m = weights.len();
        let centring: Vec<f64> =
            (0..m).map(|i| if inside(i) { change(i) / at.force[i] } else { 0.0 }).collect();
        let mut rhs = self.left.to_vec();
        let known: Vec<f64> = weights.iter().zip(&centring).map(|(w, c)| w * c).collect();
        axpy(-1.0, &g_transposed.mul_transposed(&known), &mut rhs);
        let multiplier = self.factor.solve(&rhs)?;
        let force: Vec<f64> =
            (0..m).map(|i| weights[i] * (g_transposed.row_dot(i, &multiplier) + centring[i])).collect();
        let slack =
            |i: usize| if inside(i) { centring[i] - at.slack[i] / at.force[i] * force[i] } else { 0.0 };
        Ok(Point { slack: (0..m).map(slack).collect(), multiplier, force })
    }
}

/// `a + t b`
fn sum(a: &[f64], t: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + t * b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Csr, Packed};

    /// Close to the answers known by hand: on the simplex, and for a cone that does not contain e.
    #[test]
    fn the_minimum_is_the_known_one_with_and_without_a_rest() {
        let mut g_transposed = Csr::empty(2);
        [[1.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
            .iter()
            .for_each(|g| g_transposed.push_row([(0, g[0]), (1, g[1])]));
        let a = Packed::zeros(3).unwrap();
        let qp = Qp {
            a: &a,
            b: &[0.0; 3],
            g_transposed: &g_transposed,
            blocks: &[],
            rounding: 1e-14,
            e: &[1.0, 0.0],
            bounded: &[true; 3],
            preconditioner: None,
            kept: None,
        };
        let mut coarse = Coarse::of(&qp).unwrap();
        let near = |found: &[f64], known: &[f64]| found.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-5);
        let simplex = Interior { qp: &qp, y: &[0.8, 0.6, -1.0], held: &[false; 3], delta: 1.0, rho: 0.0 };
        let found = simplex.minimise(&mut coarse, vec![0.0; 2]).unwrap();
        assert!(near(&found.force, &[0.6, 0.4, 0.0]), "{:?}", found.force);
        let outside = Qp { e: &[1.0, -2.0], ..qp };
        let cone = Interior { qp: &outside, y: &[0.0; 3], held: &[false; 3], delta: 1e-8, rho: 1.0 };
        let found = cone.minimise(&mut coarse, vec![0.0; 2]).unwrap();
        assert!(near(&found.multiplier, &[0.0, -2.0]), "{:?}", found.multiplier);
    }
}
