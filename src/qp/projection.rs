//! `PROJ(y) = argmin |l - y|` over `l_i >= 0 (i bounded), G l = e`: a semismooth Newton method in the
//! coarse space, `l(beta) = clip(y + G'beta)`, on the convex `phi(beta) = 1/2 |l|^2 - e'beta`, with an exact line search. If
//! its steps stop at one row after another, as with thousands of loose bodies, an interior point method finds the face.

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm, ratio};
use crate::numbers::qp::{BALANCED, CUT_STEP, PROJECTED, STAGNATED};
use crate::numbers::rounding;
use crate::platform::interrupt;
use crate::qp::coarse::Coarse;
use crate::qp::interior::inside;
use crate::qp::{Qp, Rung};

/// The nearest point and the multiplier beta of `G l = e`.
pub struct Projected {
    pub point: Vec<f64>,
    pub multiplier: Vec<f64>,
}

const NEWTON_STEPS: usize = 100;
const PATIENCE: usize = 4;
/// Newton steps after it, from a multiplier close to the solution if there is one.
const FURTHER_STEPS: usize = 30;
/// A sum is zero if it is below this part of its terms: if the bounds leave only one point, all rows must reach them.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The point y that is projected; entries in `held` stay zero.
#[derive(Clone, Copy)]
struct Target<'a> {
    qp: &'a Qp<'a>,
    y: &'a [f64],
    held: &'a [bool],
}

struct Trial {
    beta: Vec<f64>,
    point: Vec<f64>,
    /// `e - G l`
    residual: Vec<f64>,
}

impl Trial {
    fn new(Target { qp, y, held }: Target, coarse: &Coarse, beta: Vec<f64>) -> Self {
        let rows = coarse.rows();
        let point = rows.each_row(|i| {
            if held[i] {
                return 0.0;
            }
            let value = y[i] + rows.row_dot(i, &beta);
            let is_zero = || value <= ROUNDING * (y[i].abs() + rows.row_dot_abs(i, &beta));
            if qp.bounded[i] && is_zero() {
                0.0
            } else {
                value
            }
        });
        Self { beta, residual: coarse.left(qp.e, &point), point }
    }

    /// `|e - G l|` relative to `|e| + |G||l|`
    fn error(&self, qp: &Qp, coarse: &Coarse) -> f64 {
        ratio(norm(&self.residual), norm(qp.e) + norm(&coarse.terms(&self.point)))
    }

    /// `phi(beta) = 1/2 |l|^2 - e'beta`
    fn phi(&self, qp: &Qp) -> f64 {
        0.5 * dot(&self.point, &self.point) - dot(qp.e, &self.beta)
    }

    /// J4: removes the rounding in `e - G l` if the bounds permit it.
    fn done(self, qp: &Qp, coarse: &mut Coarse) -> Result<Projected> {
        let mut point = self.point.clone();
        let held: Vec<bool> = point.iter().map(|l| *l == 0.0).collect();
        let step = coarse.on(&held)?.solve(&self.residual)?;
        let rows = coarse.rows();
        rows.change_rows(&mut point, |i, l| {
            if !held[i] {
                *l += rows.row_dot(i, &step);
            }
        });
        let inside = (0..point.len()).all(|i| !qp.bounded[i] || point[i] >= 0.0);
        Ok(Projected { point: if inside { point } else { self.point }, multiplier: self.beta })
    }
}

/// J1 to J4 of docs/method.md. `None`: no such point was found. Entries in `held` stay zero.
pub fn project(qp: &Qp, coarse: &mut Coarse, y: &[f64], held: &[bool]) -> Result<Option<Projected>> {
    let target = Target { qp, y, held };
    let mut now = Trial::new(target, coarse, vec![0.0; qp.e.len()]);
    if qp.e.is_empty() {
        return Ok(Some(Projected { point: now.point, multiplier: now.beta }));
    }
    let mut error = now.error(qp, coarse);
    let given = norm(qp.e) + norm(&coarse.terms(y));
    let is_met = |now: &Trial| norm(&now.residual) <= BALANCED * given;
    let (mut cuts, mut step, mut end) = (0, 0, NEWTON_STEPS);
    while step < end {
        interrupt::reached("Newton steps of a projection", step)?;
        // J2
        if error <= PROJECTED && is_met(&now) {
            return now.done(qp, coarse).map(Some);
        }
        if cuts == PATIENCE && Rung::ProjectionInside.is_tried() {
            (cuts, end) = (cuts + 1, end.min(step + FURTHER_STEPS));
            let found = inside(qp, coarse, (y, held), now.beta.clone())?;
            let next = Trial::new(target, coarse, found.motion);
            if next.phi(qp) < now.phi(qp) {
                (error, now) = (next.error(qp, coarse), next);
            }
        }
        // J3: Newton; the first step on all rows that y does not put beyond their bound, since forces that add up over many
        // bodies would enter one row after the other from 0
        let leaves = |i: usize| now.point[i] <= 0.0 && (step > 0 || y[i] < 0.0);
        let face: Vec<bool> = (0..y.len()).map(|i| held[i] || (qp.bounded[i] && leaves(i))).collect();
        let mut free = vec![0.0; qp.e.len()];
        coarse.on(&face)?.add_free_part(qp.e, &mut free);
        if norm(&free) > BALANCED * given && target.is_endless_along(coarse, &free) {
            return Ok(None);
        }
        let mut on_face = coarse.on(&face)?;
        let direction = match face == held {
            true => on_face.solve(&now.residual)?,
            false => on_face.solve_regularised(&now.residual)?,
        };
        let Some(t) = target.minimum_along(coarse, &now, &direction) else {
            return if error <= STAGNATED && is_met(&now) {
                now.done(qp, coarse).map(Some)
            } else {
                Ok(None)
            };
        };
        cuts += usize::from(t < CUT_STEP);
        let mut beta = now.beta.clone();
        axpy(t, &direction, &mut beta);
        let next = Trial::new(target, coarse, beta);
        let next_error = next.error(qp, coarse);
        if error <= STAGNATED && next_error >= error {
            return if is_met(&now) { now.done(qp, coarse).map(Some) } else { Ok(None) };
        }
        (now, error, step) = (next, next_error, step + 1);
    }
    Ok(None)
}

impl Target<'_> {
    /// J3: no row resists this motion, along which phi then decreases without end: it is the part of e along free motions of a face.
    fn is_endless_along(&self, coarse: &Coarse, motion: &[f64]) -> bool {
        let Target { qp, held, .. } = self;
        let (rows, noise) = (coarse.rows(), qp.rounding * coarse.largest().sqrt() * norm(motion));
        (0..held.len()).filter(|&i| !held[i]).all(|i| {
            let q = rows.row_dot(i, motion);
            q <= noise && (qp.bounded[i] || q >= -noise)
        })
    }

    /// J3: exact minimum of phi over `beta + t step`, t > 0: phi' is piecewise linear and nondecreasing, with the slope
    /// `sum (G'step)_i^2` over the rows that are not at their bound. `None`: phi decreases without end.
    fn minimum_along(&self, coarse: &Coarse, now: &Trial, step: &[f64]) -> Option<f64> {
        let Target { qp, y, held } = self;
        let rows = coarse.rows();
        let images = rows.each_row(|i| if held[i] { 0.0 } else { rows.row_dot(i, step) });
        let (mut slope, mut whole, mut turns) = (0.0, 0.0, Vec::new());
        for i in (0..y.len()).filter(|&i| !held[i]) {
            let q = images[i];
            whole += q * q;
            if !qp.bounded[i] {
                slope += q * q;
                continue;
            }
            let v = y[i] + rows.row_dot(i, &now.beta);
            let inside = v > 0.0 || (v == 0.0 && q > 0.0);
            slope += if inside { q * q } else { 0.0 };
            let is_zero = || q.abs() <= ROUNDING * rows.row_dot_abs(i, step);
            if v != 0.0 && (v < 0.0) == (q > 0.0) && !is_zero() {
                turns.push((-v / q, if inside { -q * q } else { q * q }));
            }
        }
        turns.sort_by(|a, b| a.0.total_cmp(&b.0));
        let none = rounding::SUM * whole;
        let (mut at, mut derivative) = (0.0, -dot(&now.residual, step));
        let flat = rounding::METHOD * derivative;
        for (t, change) in turns {
            let there = derivative + slope * (t - at);
            if there >= 0.0 && slope > none {
                break;
            }
            (at, derivative, slope) = (t, there.min(0.0), slope + change);
        }
        if slope > none {
            Some(at - derivative / slope)
        } else {
            (at > 0.0 && derivative >= flat).then_some(at)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Csr, Packed};

    #[test]
    fn the_projection_on_the_simplex_is_the_known_one() {
        // sum l = 1, l >= 0, y = (0.8, 0.6, -1): l = (0.6, 0.4, 0)
        let mut g_transposed = Csr::empty(1);
        (0..3).for_each(|_| g_transposed.push_row([(0, 1.0)]));
        let a = Packed::zeros(3).unwrap();
        let qp = Qp::plain(&a, &[0.0; 3], &g_transposed, &[1.0], &[true; 3]);
        let mut coarse = Coarse::of(&qp).unwrap();
        let found = project(&qp, &mut coarse, &[0.8, 0.6, -1.0], &[false; 3]).unwrap().unwrap();
        for (value, expected) in found.point.iter().zip([0.6, 0.4, 0.0]) {
            assert!((value - expected).abs() < 1e-14);
        }
        let outside = Qp { e: &[-1.0], ..qp };
        assert!(project(&outside, &mut coarse, &[0.8, 0.6, -1.0], &[false; 3]).unwrap().is_none());
    }

    /// Rows resist the second mode by the rounding of their data alone.
    #[test]
    fn a_load_along_a_motion_that_no_row_resists_ends_after_one_face() {
        let mut g_transposed = Csr::empty(2);
        for tilt in [0.3, -0.2, 0.7, 0.1] {
            g_transposed.push_row([(0, 1.0), (1, 1e-17 * tilt)]);
        }
        let a = Packed::zeros(4).unwrap();
        let qp = Qp {
            blocks: &[0, 1],
            ..Qp::plain(&a, &[0.0; 4], &g_transposed, &[-1.0, 1.0], &[false, false, true, true])
        };
        let mut coarse = Coarse::of(&qp).unwrap();
        assert!(project(&qp, &mut coarse, &[0.0; 4], &[false; 4]).unwrap().is_none());
        assert_eq!(coarse.factorisations, 1);
    }

    /// phi still falls by rounding where the first row reaches its bound; the second row, whose image is 0.1 + 0.2 - 0.3, would reach its
    /// own after a way of 1e16.
    #[test]
    fn a_row_whose_image_is_rounding_stops_no_step() {
        let mut g_transposed = Csr::empty(3);
        g_transposed.push_row([(0, -1.0)]);
        g_transposed.push_row([(0, 0.1), (1, 0.2), (2, -0.3)]);
        let a = Packed::zeros(2).unwrap();
        let qp = Qp::plain(&a, &[0.0; 2], &g_transposed, &[0.0; 3], &[true; 2]);
        let coarse = Coarse::of(&qp).unwrap();
        let target = Target { qp: &qp, y: &[1.0, -1.0], held: &[false; 2] };
        let now =
            Trial { residual: vec![1.0 + 1e-13, 0.0, 0.0], ..Trial::new(target, &coarse, vec![0.0; 3]) };
        assert_eq!(target.minimum_along(&coarse, &now, &[1.0; 3]), Some(1.0));
    }
}
