//! The forces within the cones that come closest to balancing a load if none balance it, `min |e - G l|`, and the
//! remainder:
//!
//! ```text
//! beta + G PI(G'beta / delta) = e,   delta -> 0,   beta = e - G l
//! ```
//!
//! `G'beta` is in the polar cone up to delta times the forces: no force within the cones resists this motion by more than
//! that. Coefficients are slightly increased, so that the actual friction does not resist the motion at all; the
//! remaining effect of delta is subtracted from the motion. G and e are weighted, mode by mode.

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm};
use crate::platform::interrupt;
use crate::qp::friction::cones::{Force, Node, Place};
use crate::qp::friction::motions::Motions;
use crate::qp::friction::nearest::derivative;
use crate::qp::friction::FrictionProblem;

/// delta relative to the largest diagonal entry of `G G'`: the first value, the factor, and the last value.
const FIRST: f64 = 1.0;
const LESS: f64 = 0.1;
const LAST: f64 = 1e-13;
const STEPS: usize = 30;
/// Relative increase of the coefficients.
const WIDER: f64 = 1e-6;
/// Residuals relative to |e|: of an accurate solution, and of an accepted one.
const ACCURACY: f64 = 1e-14;
const ACCEPTED: f64 = 1e-5;
/// Armijo's factor on the slope, and the shortest step.
const SLOPE: f64 = 1e-4;
const SHORTEST: f64 = 1e-6;
/// Rounds that remove the part of the motion that rows resist, and the shift of their matrices.
const ROUNDS: usize = 4;
const SHIFT: f64 = 1e-13;
/// Rows that open, and nodes that slip, by less than this multiple of the resistance of other rows are treated as closed
/// and sticking.
const NEAR: f64 = 10.0;

struct Trial {
    beta: Vec<f64>,
    forces: Vec<f64>,
    places: Vec<Place>,
    /// `beta + G l - e`, the gradient of phi.
    slope: Vec<f64>,
    phi: f64,
}

/// The forces for which `e - G l` is smallest in the norm of `weights`, one weight per mode; and `e - G l`.
pub fn unheld(problem: &FrictionProblem, weights: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut g_transposed = problem.g_transposed.clone();
    g_transposed.col.iter().zip(&mut g_transposed.val).for_each(|(&mode, v)| *v *= weights[mode]);
    let e: Vec<f64> = problem.e.iter().zip(weights).map(|(e, w)| w * e).collect();
    let wider = problem.cones.wider(1.0 + WIDER);
    let problem = &FrictionProblem { cones: &wider, g_transposed: &g_transposed, e: &e, ..*problem };
    let Some(motions) = Motions::of(problem)? else { return Ok((vec![0.0; problem.b.len()], e)) };
    let (mut shift, mut best) = (FIRST, trial(problem, vec![0.0; e.len()], motions.size()));
    let mut before = best.beta.clone();
    let is_solved = |now: &Trial| norm(&now.slope) <= ACCEPTED * norm(&e);
    while shift >= LAST {
        // while the states of the nodes do not change, beta is a linear function of delta
        let mut beta = best.beta.clone();
        beta.iter_mut().zip(&before).for_each(|(beta, before)| *beta += LESS * (*beta - before));
        let mut now = nearest(problem, &motions, beta, shift)?;
        if !is_solved(&now) {
            now = nearest(problem, &motions, best.beta.clone(), shift)?;
        }
        if !is_solved(&now) {
            break;
        }
        before = if shift < FIRST { best.beta } else { now.beta.clone() };
        best = now;
        shift *= LESS;
    }
    let left = settled(problem, &motions, best.beta)?;
    Ok((best.forces, left.iter().zip(weights).map(|(beta, w)| beta / w).collect()))
}

/// The resistance of a node to a motion.
struct Resisted {
    force: Force,
    /// Direction and size of the slip.
    along: [f64; 2],
    slip: f64,
    /// Resistance of its normal row together with friction, also that of nodes that share the row; below 0 the row opens.
    by: f64,
}

impl Resisted {
    fn of(nodes: &[Node], v: &[f64]) -> Vec<Self> {
        let slip = |node: &Node| norm(&node.of(v).tangential);
        let drawn = nodes.iter().map(|node| node.mu * slip(node));
        let by = nodes[0].normal.map_or(0.0, |row| drawn.fold(v[row], |by, drawn| by + drawn));
        let of = |node: &Node| {
            let (force, slip) = (node.of(v), slip(node));
            let along = if slip > 0.0 { force.tangential.map(|t| t / slip) } else { [1.0, 0.0] };
            Self { force, along, slip, by }
        };
        nodes.iter().map(of).collect()
    }
}

/// Newton's method for one delta, given relative to the largest diagonal entry of `G G'`.
fn nearest(problem: &FrictionProblem, motions: &Motions, beta: Vec<f64>, shift: f64) -> Result<Trial> {
    let delta = shift * motions.size();
    let mut now = trial(problem, beta, delta);
    for step in 0..STEPS {
        interrupt::reached("Newton steps of the nearest forces", step)?;
        if norm(&now.slope) <= ACCURACY * norm(problem.e) {
            break;
        }
        let (coordinates, weights) = derivative(problem.cones, &now.places);
        let Some(matrix) = motions.shifted(&coordinates, weights, shift)? else { break };
        let direction: Vec<f64> = matrix.solve(&now.slope)?.iter().map(|d| -delta * d).collect();
        let Some(next) = armijo(problem, &now, &direction, delta) else { break };
        now = next;
    }
    Ok(now)
}

/// Removes from the motion what normal rows with their friction, and free rows, resist: delta times their forces.
fn settled(problem: &FrictionProblem, motions: &Motions, mut beta: Vec<f64>) -> Result<Vec<f64>> {
    let mut near = None;
    for _ in 0..ROUNDS {
        let v: Vec<f64> = (0..problem.b.len()).map(|i| problem.g_transposed.row_dot(i, &beta)).collect();
        let nodes: Vec<Resisted> = problem.cones.groups().flat_map(|nodes| Resisted::of(nodes, &v)).collect();
        let near = *near.get_or_insert_with(|| NEAR * nodes.iter().map(|node| node.by).fold(0.0, f64::max));
        let (mut places, mut resists, mut normal) = (Vec::new(), Vec::new(), 0);
        for (node, now) in problem.cones.nodes().iter().zip(&nodes) {
            let Resisted { force, along, slip, by } = *now;
            let ratio = 0.0;
            let (place, of) = match by >= -near {
                true if slip <= near => {
                    (Place::Inside, [force.normal, force.tangential[0], force.tangential[1]])
                }
                true if node.normal.is_some() => {
                    (Place::Surface { along, ratio }, [force.normal + node.mu * slip, 0.0, 0.0])
                }
                _ => (Place::Rim { along, ratio }, [0.0; 3]),
            };
            places.push(place);
            if node.own_normal().is_some() {
                normal = resists.len();
                resists.push(of[0]);
            } else if matches!(place, Place::Surface { .. }) {
                resists[normal] += node.mu * slip;
            }
            resists.extend_from_slice(&of[1..=node.tangents().len()]);
        }
        let (coordinates, weights) = derivative(problem.cones, &places);
        resists.extend(coordinates[resists.len()..].iter().map(|free| v[free.rows[0]]));
        let Some(matrix) = motions.shifted(&coordinates, weights, SHIFT)? else { break };
        axpy(-1.0, &matrix.solve(&matrix.weighted_image(&resists))?, &mut beta);
    }
    Ok(beta)
}

/// `phi(beta) = |beta|^2/2 + delta |PI(G'beta / delta)|^2/2 - e'beta`, where PI projects on cones that include the
/// bounds: `delta (v'l - l'l/2)` replaces the second term.
fn trial(problem: &FrictionProblem, beta: Vec<f64>, delta: f64) -> Trial {
    let g_transposed = problem.g_transposed;
    let v: Vec<f64> = (0..problem.b.len()).map(|i| g_transposed.row_dot(i, &beta) / delta).collect();
    let (forces, places) = problem.cones.nearest(&v);
    let mut slope = beta.clone();
    axpy(-1.0, problem.e, &mut slope);
    g_transposed.mul_transposed_add(1.0, &forces, &mut slope);
    let of_cones = delta * (dot(&v, &forces) - 0.5 * dot(&forces, &forces));
    let phi = 0.5 * dot(&beta, &beta) + of_cones - dot(problem.e, &beta);
    Trial { beta, forces, places, slope, phi }
}

/// The first of the steps 1, 1/2, ... that reduces phi sufficiently.
fn armijo(problem: &FrictionProblem, now: &Trial, direction: &[f64], delta: f64) -> Option<Trial> {
    let (slope, mut t) = (dot(&now.slope, direction), 1.0);
    while t > SHORTEST {
        let mut beta = now.beta.clone();
        axpy(t, direction, &mut beta);
        let next = trial(problem, beta, delta);
        let rounding = 4.0 * f64::EPSILON * now.phi.abs();
        if next.phi <= now.phi + SLOPE * t * slope + rounding && norm(&next.slope).is_finite() {
            return Some(next);
        }
        t *= 0.5;
    }
    None
}
