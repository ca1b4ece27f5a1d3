//! A primal-dual interior point method (Mehrotra 1992) for forces `l_i >= 0 (i bounded)` and motions a,
//!
//! ```text
//! G l + K a = e,   C l + c - G'a = s,   s = 0 (i free),   s_i >= 0, l_i s_i = 0 (i bounded)
//! ```
//!
//! C >= 0 diagonal: about twenty factorisations of `G D G' + K`, D > 0 diagonal, for any number of rows. It shows which rows have
//! a force; other methods then compute the last digits of the answer.

use crate::error::Result;
use crate::linalg::vector::{axpy, norm};
use crate::linalg::Csr;
use crate::numbers::qp::{CLOSE, COMPLEMENTARITY, INTERIOR_ACCURACY};
use crate::platform::interrupt;
use crate::qp::coarse::Coarse;
use crate::qp::space::CoarseInverse;
use crate::qp::Qp;

const STEPS: usize = 40;

/// `(K + G D G')^-1`
pub trait Inverse {
    fn solve(&self, load: &[f64]) -> Result<Vec<f64>>;
}

/// K.
pub trait Stiffness {
    /// `left -= K a`
    fn subtract(&self, a: &[f64], left: &mut [f64]) -> Result<()>;
    /// The size of loads, to which that of a residual is compared.
    fn size(&self, loads: &[f64]) -> f64 {
        norm(loads)
    }
    /// The inverse for these weights D >= 0 of the rows; none if some motion is resisted too little.
    fn with_rows(&mut self, weights: &[f64]) -> Result<Option<Box<dyn Inverse + '_>>>;
}

/// The problem: rows in `held` have no force.
#[derive(Clone, Copy)]
pub struct Interior<'a> {
    /// G', m x n
    pub rows: &'a Csr,
    pub e: &'a [f64],
    pub bounded: &'a [bool],
    pub held: &'a [bool],
    /// c
    pub gap: &'a [f64],
    /// C
    pub compliance: &'a [f64],
    /// At least C: forces that motions first cause are those of rows with this compliance.
    pub first: &'a [f64],
    /// At least C: rows that have closed yield as much in one step.
    pub least: &'a [f64],
    /// Products `l_i s_i C_i` begin at this mean or above.
    pub mean: f64,
}

pub struct Point {
    /// a
    pub motion: Vec<f64>,
    /// l
    pub force: Vec<f64>,
    /// s >= 0; 0 on rows without a bound.
    pub slack: Vec<f64>,
}

impl Interior<'_> {
    /// A point close to the solution, within the limits of steps and rounding.
    pub fn solve(&self, stiffness: &mut dyn Stiffness, motion: Vec<f64>) -> Result<Point> {
        let mut at = self.start(motion);
        for step in 0..STEPS {
            interrupt::reached("steps into the interior", step)?;
            let mean = self.mean(&at.force, &at.slack);
            let (left, apart) = (self.left(stiffness, &at)?, self.apart(&at));
            let mut terms = vec![0.0; left.len()];
            self.rows.mul_transposed_abs_add(&at.force, &mut terms);
            let met = stiffness.size(&left)
                <= INTERIOR_ACCURACY * (stiffness.size(self.e) + stiffness.size(&terms))
                && norm(&apart) <= INTERIOR_ACCURACY * self.lengths(&at);
            if met && mean <= COMPLEMENTARITY * self.mean(&at.force, &at.force) {
                break;
            }
            let weight = |i: usize| {
                let yields = if self.is_inside(i) { at.slack[i] / at.force[i] } else { 0.0 };
                let yields = (self.compliance[i] + yields).max(self.least[i]);
                if self.held[i] {
                    0.0
                } else {
                    1.0 / yields
                }
            };
            let weights: Vec<f64> = (0..self.gap.len()).map(weight).collect();
            let Some(inverse) = stiffness.with_rows(&weights)? else { break };
            let newton = Newton {
                of: self,
                at: &at,
                left: &left,
                apart: &apart,
                weights: &weights,
                inverse: &*inverse,
            };
            let predictor = newton.step(|i| -at.force[i] * at.slack[i])?;
            let t = self.longest(&at, &predictor).min(1.0);
            let ahead = self.mean(&sum(&at.force, t, &predictor.force), &sum(&at.slack, t, &predictor.slack));
            let centre = mean * (ahead / mean).powi(3);
            let product = |i: usize| at.force[i] * at.slack[i] + predictor.force[i] * predictor.slack[i];
            let step = newton.step(|i| centre - product(i))?;
            let t = (CLOSE * self.longest(&at, &step)).min(1.0);
            axpy(t, &step.motion, &mut at.motion);
            axpy(t, &step.force, &mut at.force);
            axpy(t, &step.slack, &mut at.slack);
        }
        Ok(at)
    }

    /// Whether row i may have a force and has a bound.
    fn is_inside(&self, i: usize) -> bool {
        self.bounded[i] && !self.held[i]
    }

    /// The point on the central path for this motion, with forces as large as v = G'a - c or e causes.
    fn start(&self, motion: Vec<f64>) -> Point {
        let m = self.gap.len();
        let v: Vec<f64> = (0..m).map(|i| self.rows.row_dot(i, &motion) - self.gap[i]).collect();
        let (mut force, mut slack) = (vec![0.0; m], vec![0.0; m]);
        let mean = self.mean(&v, &v).max(self.mean);
        for i in (0..m).filter(|&i| !self.held[i]) {
            if !self.is_inside(i) {
                force[i] = v[i] / self.first[i];
            } else {
                // first l - s = v, l s = mean / first
                let root = v[i].hypot(2.0 * mean.sqrt());
                (force[i], slack[i]) = if v[i] > 0.0 {
                    let upper = 0.5 * (v[i] + root);
                    (upper / self.first[i], mean / upper)
                } else {
                    let upper = 0.5 * (root - v[i]);
                    (mean / upper / self.first[i], upper)
                };
            }
        }
        Point { motion, force, slack }
    }

    /// Mean of `a_i b_i` over the rows with a bound.
    fn mean(&self, a: &[f64], b: &[f64]) -> f64 {
        let inside = || (0..a.len()).filter(|&i| self.is_inside(i));
        inside().map(|i| a[i] * b[i]).sum::<f64>() / inside().count().max(1) as f64
    }

    /// `e - G l - K a`
    fn left(&self, stiffness: &dyn Stiffness, at: &Point) -> Result<Vec<f64>> {
        let mut left = self.e.to_vec();
        self.rows.mul_transposed_add(-1.0, &at.force, &mut left);
        stiffness.subtract(&at.motion, &mut left)?;
        Ok(left)
    }

    /// `C l + c - G'a - s`, which is 0 from the start on if C is the compliance of the start.
    fn apart(&self, at: &Point) -> Vec<f64> {
        let of = |i: usize| {
            let by_motion = self.rows.row_dot(i, &at.motion);
            self.compliance[i] * at.force[i] + self.gap[i] - by_motion - at.slack[i]
        };
        let is_met = |i: usize| self.held[i] || self.first[i] == self.compliance[i];
        (0..self.gap.len()).map(|i| if is_met(i) { 0.0 } else { of(i) }).collect()
    }

    /// `|G'a| + |c|`
    fn lengths(&self, at: &Point) -> f64 {
        let moved: Vec<f64> = (0..self.gap.len()).map(|i| self.rows.row_dot(i, &at.motion)).collect();
        norm(&moved) + norm(self.gap)
    }

    /// The largest step for which forces and slacks stay >= 0.
    fn longest(&self, at: &Point, step: &Point) -> f64 {
        let bound = |x: f64, dx: f64| if dx < 0.0 { -x / dx } else { f64::INFINITY };
        (0..self.gap.len()).filter(|&i| self.is_inside(i)).fold(f64::INFINITY, |t, i| {
            t.min(bound(at.force[i], step.force[i])).min(bound(at.slack[i], step.slack[i]))
        })
    }
}

/// Newton's method at one point.
struct Newton<'a> {
    of: &'a Interior<'a>,
    at: &'a Point,
    /// `e - G l - K a` and `C l + c - G'a - s`
    left: &'a [f64],
    apart: &'a [f64],
    /// `D = l / (C l + s)`
    weights: &'a [f64],
    /// `(K + G D G')^-1`
    inverse: &'a dyn Inverse,
}

impl Newton<'_> {
    /// The step that changes `l_i s_i` by `change`.
    fn step(&self, change: impl Fn(usize) -> f64) -> Result<Point> {
        let Self { of, at, weights, .. } = self;
        let inside = |i: usize| of.is_inside(i);
        let m = weights.len();
        let centring: Vec<f64> =
            (0..m).map(|i| if inside(i) { change(i) / at.force[i] } else { 0.0 }).collect();
        let drawn: Vec<f64> = centring.iter().zip(self.apart).map(|(c, apart)| c - apart).collect();
        let mut load = self.left.to_vec();
        let known: Vec<f64> = weights.iter().zip(&drawn).map(|(w, c)| w * c).collect();
        axpy(-1.0, &of.rows.mul_transposed(&known), &mut load);
        let motion = self.inverse.solve(&load)?;
        let force: Vec<f64> = (0..m).map(|i| weights[i] * (of.rows.row_dot(i, &motion) + drawn[i])).collect();
        let slack =
            |i: usize| if inside(i) { centring[i] - at.slack[i] / at.force[i] * force[i] } else { 0.0 };
        Ok(Point { slack: (0..m).map(slack).collect(), motion, force })
    }
}

/// `argmin |l - y|` with `G l = e` and its multiplier, by the coarse space: K = 0, C = 1.
pub fn inside(qp: &Qp, coarse: &mut Coarse, (y, held): (&[f64], &[bool]), motion: Vec<f64>) -> Result<Point> {
    let (gap, unit) = (y.iter().map(|y| -y).collect::<Vec<f64>>(), &vec![1.0; y.len()]);
    let (rows, compliance, first, least) = (qp.g_transposed, unit, unit, unit);
    let Qp { e, bounded, .. } = *qp;
    Interior { rows, e, bounded, held, gap: &gap, compliance, first, least, mean: 0.0 }.solve(coarse, motion)
}

impl Stiffness for Coarse<'_> {
    fn subtract(&self, _: &[f64], _: &mut [f64]) -> Result<()> {
        Ok(())
    }

    fn with_rows(&mut self, weights: &[f64]) -> Result<Option<Box<dyn Inverse + '_>>> {
        let factor = self.weighted(weights, 0.0)?;
        self.solves += 2 * usize::from(factor.is_some());
        Ok(factor.map(|factor| Box::new(factor) as _))
    }
}

impl Inverse for CoarseInverse {
    fn solve(&self, load: &[f64]) -> Result<Vec<f64>> {
        Self::solve(self, load)
    }
}

/// `a + t b`
fn sum(a: &[f64], t: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + t * b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Packed;

    /// Close to the answer known by hand on the simplex.
    #[test]
    fn the_nearest_point_is_the_known_one() {
        let mut g_transposed = Csr::empty(2);
        [[1.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
            .iter()
            .for_each(|g| g_transposed.push_row([(0, g[0]), (1, g[1])]));
        let a = Packed::zeros(3).unwrap();
        let qp = Qp::plain(&a, &[0.0; 3], &g_transposed, &[1.0, 0.0], &[true; 3]);
        let mut coarse = Coarse::of(&qp).unwrap();
        let near = |found: &[f64], known: &[f64]| found.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-5);
        let found = inside(&qp, &mut coarse, (&[0.8, 0.6, -1.0], &[false; 3]), vec![0.0; 2]).unwrap();
        assert!(near(&found.force, &[0.6, 0.4, 0.0]), "{:?}", found.force);
    }
}
