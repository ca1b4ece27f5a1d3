//! The forces within the cones that come nearest to a load which none of them balances, `min |e - G l|`, and what they leave:
//!
//! ```text
//! beta + G PI(G'beta / delta) = e,   delta -> 0,   beta = e - G l
//! ```
//!
//! with `G'beta` in the polar cone but for delta times the forces: a motion that no force within the cones resists by more than that.
//! Coefficients are a little larger than they are, so that friction as it is does not resist the motion at all.

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm};
use crate::platform::interrupt;
use crate::qp::friction::cones::Place;
use crate::qp::friction::motions::Motions;
use crate::qp::friction::nearest::derivative;
use crate::qp::friction::FrictionProblem;

/// delta of the largest diagonal entry of `G G'`, at first, from one to the next, and at last.
const FIRST: f64 = 1.0;
const LESS: f64 = 0.1;
const LAST: f64 = 1e-13;
const STEPS: usize = 30;
/// What is added to coefficients, of them.
const WIDER: f64 = 1e-6;
/// Of |e|.
const ACCURACY: f64 = 1e-14;
/// Armijo's part of the slope, and the shortest step.
const SLOPE: f64 = 1e-4;
const SHORTEST: f64 = 1e-6;

pub struct Unheld {
    pub forces: Vec<f64>,
    /// beta, r entries.
    pub left: Vec<f64>,
}

struct Trial {
    beta: Vec<f64>,
    forces: Vec<f64>,
    places: Vec<Place>,
    /// `beta + G l - e`, the gradient of phi.
    slope: Vec<f64>,
    phi: f64,
}

pub fn unheld(problem: &FrictionProblem, motions: &Motions) -> Result<Unheld> {
    let wider = problem.cones.wider(1.0 + WIDER);
    let problem = &FrictionProblem { cones: &wider, ..*problem };
    let mut shift = FIRST;
    let mut now = trial(problem, vec![0.0; problem.e.len()], shift * motions.size());
    while shift >= LAST {
        let delta = shift * motions.size();
        now = trial(problem, now.beta, delta);
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
        shift *= LESS;
    }
    Ok(Unheld { forces: now.forces, left: now.beta })
}

/// `phi(beta) = |beta|^2/2 + delta |PI(G'beta / delta)|^2/2 - e'beta`, with PI on cones that hold their bounds as well:
/// `delta (v'l - l'l/2)` in place of the second term.
fn trial(problem: &FrictionProblem, beta: Vec<f64>, delta: f64) -> Trial {
    let g_transposed = problem.g_transposed;
    let v: Vec<f64> = (0..problem.b.len()).map(|i| g_transposed.row_dot(i, &beta) / delta).collect();
    let (mut forces, mut places) = (v.clone(), Vec::with_capacity(problem.cones.nodes().len()));
    for node in problem.cones.nodes() {
        let (force, place) = node.nearest(node.of(&v));
        node.put(force, &mut forces);
        places.push(place);
    }
    let mut slope = beta.clone();
    axpy(-1.0, problem.e, &mut slope);
    g_transposed.mul_transposed_add(1.0, &forces, &mut slope);
    let of_cones = delta * (dot(&v, &forces) - 0.5 * dot(&forces, &forces));
    let phi = 0.5 * dot(&beta, &beta) + of_cones - dot(problem.e, &beta);
    Trial { beta, forces, places, slope, phi }
}

/// The first of the steps 1, 1/2, ... after which phi has fallen.
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
