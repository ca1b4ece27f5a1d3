//! The forces within the cones that come closest to balancing a load if none balance it, `min |e - G l|`, and the
//! remainder `rest = e - G l`:
//!
//! ```text
//! delta beta + G PI(G'beta) = e,   delta -> 0,   delta beta -> rest
//! ```
//!
//! `G'rest` is in the polar cone up to delta times the forces: no force within the cones resists this motion by more than
//! that. Coefficients are slightly increased, so that the actual friction does not resist the motion at all; the
//! remaining effect of delta is subtracted from the motion. G and e are weighted, mode by mode.

use crate::error::Result;
use crate::linalg::vector::norm;
use crate::qp::friction::cones::Cones;
use crate::qp::friction::motions::Motions;
use crate::qp::friction::nearest::{Projected, Target};
use crate::qp::Qp;

/// delta relative to the largest diagonal entry of `G G'`: the first value, the factor, and the last value.
const FIRST: f64 = 1.0;
const LESS: f64 = 0.1;
const LAST: f64 = 1e-13;
/// Relative increase of the coefficients.
const WIDER: f64 = 1e-6;
/// Residual of an accepted solution, relative to |e|.
const ACCEPTED: f64 = 1e-5;

/// The forces for which `e - G l` is smallest in the norm of `weights`, one weight per mode; and `e - G l`.
pub fn unheld(qp: &Qp, cones: &Cones, weights: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut g_transposed = qp.g_transposed.clone();
    g_transposed.col.iter().zip(&mut g_transposed.val).for_each(|(&mode, v)| *v *= weights[mode]);
    let e: Vec<f64> = qp.e.iter().zip(weights).map(|(e, w)| w * e).collect();
    let (qp, cones) = (&Qp { g_transposed: &g_transposed, e: &e, ..*qp }, &cones.wider(1.0 + WIDER));
    let (motions, y) = (&Motions::of(qp, cones)?, &vec![0.0; qp.b.len()]);
    let target = |delta: f64| Target { qp, cones, motions, y, delta };
    let is_solved = |now: &Projected| norm(&now.left) <= ACCEPTED * norm(&e);
    let (mut shift, mut last, mut rest) = (FIRST, target(0.0).at(vec![0.0; e.len()]), vec![0.0; e.len()]);
    let mut before = rest.clone();
    while shift >= LAST {
        let delta = shift * motions.size();
        // while the states of the nodes do not change, the remainder is a linear function of delta
        let from = |by: f64| {
            let beta = rest.iter().zip(&before).map(|(rest, before)| (rest + by * (rest - before)) / delta);
            target(delta).projected(beta.collect())
        };
        let mut now = from(LESS)?;
        if !is_solved(&now) {
            now = from(0.0)?;
        }
        if !is_solved(&now) {
            break;
        }
        let next: Vec<f64> = now.beta.iter().map(|beta| delta * beta).collect();
        before = if shift < FIRST { rest } else { next.clone() };
        (last, rest) = (now, next);
        shift *= LESS;
    }
    target(0.0).settle(&last, &mut rest)?;
    Ok((last.point, rest.iter().zip(weights).map(|(rest, w)| rest / w).collect()))
}
