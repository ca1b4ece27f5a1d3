//! `PROJ(y) = argmin |l - y|` over `l_i >= 0 (i bounded), G l = e`: a semismooth Newton method in the
//! coarse space, `l(beta) = clip(y + G'beta)`, on `phi(beta) = 1/2 |l|^2 - e'beta`.

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm};
use crate::qp::coarse::Coarse;
use crate::qp::Qp;

/// The nearest point and the multiplier beta of `G l = e`.
pub struct Projected {
    pub point: Vec<f64>,
    pub multiplier: Vec<f64>,
}

const NEWTON_STEPS: usize = 100;
/// `|e - G l| <= ACCURACY (|e| + |G||l|)` is accepted; `STAGNATED` where no step improves it any more.
const ACCURACY: f64 = 1e-12;
const STAGNATED: f64 = 1e-10;

struct Trial {
    beta: Vec<f64>,
    point: Vec<f64>,
    /// `e - G l`
    residual: Vec<f64>,
    phi: f64,
}

impl Trial {
    fn new(qp: &Qp, y: &[f64], held: &[bool], beta: Vec<f64>) -> Self {
        let point: Vec<f64> = (0..y.len())
            .map(|i| {
                let value = y[i] + qp.g_transposed.row_dot(i, &beta);
                if held[i] || (qp.bounded[i] && value < 0.0) { 0.0 } else { value }
            })
            .collect();
        let mut residual = qp.e.to_vec();
        qp.g_transposed.mul_transposed_add(-1.0, &point, &mut residual);
        let phi = 0.5 * dot(&point, &point) - dot(qp.e, &beta);
        Self { beta, point, residual, phi }
    }

    /// `|e - G l|` against `|e| + |G||l|`
    fn error(&self, qp: &Qp) -> f64 {
        let mut terms = vec![0.0; qp.e.len()];
        qp.g_transposed.mul_transposed_abs_add(&self.point, &mut terms);
        let size = norm(qp.e) + norm(&terms);
        if size > 0.0 { norm(&self.residual) / size } else { 0.0 }
    }

    fn done(self) -> Projected {
        Projected { point: self.point, multiplier: self.beta }
    }
}

/// `None`: no such point was found. Entries in `held` stay zero.
pub fn project(qp: &Qp, coarse: &mut Coarse, y: &[f64], held: &[bool]) -> Result<Option<Projected>> {
    let mut now = Trial::new(qp, y, held, vec![0.0; qp.e.len()]);
    if qp.e.is_empty() {
        return Ok(Some(now.done()));
    }
    let mut weight = 0.0;
    for _ in 0..NEWTON_STEPS {
        let error = now.error(qp);
        if error <= ACCURACY {
            return Ok(Some(now.done()));
        }
        let face: Vec<bool> =
            (0..y.len()).map(|i| held[i] || (qp.bounded[i] && now.point[i] <= 0.0)).collect();
        coarse.select(&face)?;
        let step = coarse.solve_regularised(&now.residual, weight)?;
        match line_search(qp, y, held, &now, &step) {
            Some((next, full)) => {
                weight = if full { 0.0 } else { weight };
                now = next;
            }
            None if error <= STAGNATED => return Ok(Some(now.done())),
            None if weight > 1e-2 => return Ok(None),
            None => weight = f64::max(1e-8, 100.0 * weight),
        }
    }
    Ok(None)
}

/// Armijo on phi; near the solution, where phi is flat to rounding, a smaller residual counts as well.
/// The second result tells whether the full step was taken.
fn line_search(qp: &Qp, y: &[f64], held: &[bool], now: &Trial, step: &[f64]) -> Option<(Trial, bool)> {
    let slope = -dot(&now.residual, step);
    let flat = 1e-12 * (now.phi.abs() + dot(qp.e, &now.beta).abs());
    let mut t = 1.0;
    while t > 1e-7 {
        let mut beta = now.beta.clone();
        axpy(t, step, &mut beta);
        let next = Trial::new(qp, y, held, beta);
        let descends = next.phi <= now.phi + 1e-4 * t * slope;
        let closer = norm(&next.residual) < 0.9 * norm(&now.residual) && (next.phi - now.phi).abs() <= flat;
        if descends || closer {
            return Some((next, t == 1.0));
        }
        t *= 0.5;
    }
    None
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
        let qp = Qp { a: &a, b: &[0.0; 3], g_transposed: &g_transposed, e: &[1.0], bounded: &[true; 3] };
        let mut coarse = Coarse::new(&g_transposed);
        let found = project(&qp, &mut coarse, &[0.8, 0.6, -1.0], &[false; 3]).unwrap().unwrap();
        for (value, expected) in found.point.iter().zip([0.6, 0.4, 0.0]) {
            assert!((value - expected).abs() < 1e-14);
        }
        let outside = Qp { e: &[-1.0], ..qp };
        assert!(project(&outside, &mut coarse, &[0.8, 0.6, -1.0], &[false; 3]).unwrap().is_none());
    }
}
