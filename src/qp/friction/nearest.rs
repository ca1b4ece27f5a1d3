//! PROJ_C, the nearest point of the cones with `G x = e`: Newton's method for beta in
//!
//! ```text
//! G PI(y + G'beta) = e,   the gradient of   phi(beta) = v'l - l'l/2 - e'beta,   v = y + G'beta,   l = PI(v)
//! ```

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm};
use crate::platform::interrupt;
use crate::qp::friction::cones::{Cones, Place};
use crate::qp::friction::coordinates::{Coordinate, Law};
use crate::qp::friction::face::Face;
use crate::qp::friction::motions::Motions;
use crate::qp::friction::FrictionProblem;

/// Limit of `|e - G l|` relative to `|e| + |G||y|`, and the limit that is accepted if the method ends earlier.
const ACCURACY: f64 = 1e-12;
const ACCEPTED: f64 = 1e-8;
const STEPS: usize = 100;
/// Shift relative to the largest diagonal entry of `G G'`, since the part of the matrix left by the cones may be
/// singular: the first value, reduced after every full step and increased after short ones.
const SHIFT: f64 = 1e-6;
const LESS: f64 = 0.1;
const MORE: f64 = 10.0;
const SHORT: f64 = 0.1;
const SHIFTS: (f64, f64) = (1e-14, 1e-2);
/// The shift of the last steps.
const ROUNDING: f64 = 1e-13;
const POLISHES: usize = 2;
/// Armijo's factor on the slope, and the shortest step.
const SLOPE: f64 = 1e-4;
const SHORTEST: f64 = 1e-10;
/// Bound of the multipliers relative to the data: beyond it phi decreases without end.
const ENDLESS: f64 = 1e14;

pub struct Projected {
    pub point: Vec<f64>,
    /// `e - G point`
    pub left: Vec<f64>,
    /// `G x = e` is satisfied.
    pub met: bool,
}

struct Trial {
    beta: Vec<f64>,
    point: Vec<f64>,
    places: Vec<Place>,
    left: Vec<f64>,
    phi: f64,
}

pub fn project(
    problem: &FrictionProblem,
    cones: &Cones,
    motions: Option<&Motions>,
    y: &[f64],
) -> Result<Projected> {
    let problem = &FrictionProblem { cones, ..*problem };
    let first = trial(problem, y, vec![0.0; problem.e.len()]);
    let Some(motions) = motions else { return Ok(first.done(true)) };
    let mut terms = vec![0.0; problem.e.len()];
    problem.g_transposed.mul_transposed_abs_add(y, &mut terms);
    let scale = norm(problem.e) + norm(&terms);
    if !scale.is_finite() {
        return Ok(first.done(false));
    }
    let (end, nearest) = descended(problem, motions, y, first, scale)?;
    let error = norm(&end.left);
    if error <= ACCURACY * scale {
        return Ok(polished(problem, motions, y, end)?.done(true));
    }
    Ok(if error <= ACCEPTED * scale { end.done(true) } else { nearest })
}

/// The end point of Newton's method, and the point closest to `G x = e`: if no point satisfies it, phi decreases without
/// end.
fn descended(
    problem: &FrictionProblem,
    motions: &Motions,
    y: &[f64],
    first: Trial,
    scale: f64,
) -> Result<(Trial, Projected)> {
    let (mut now, mut shift) = (first, SHIFT);
    let mut nearest = Projected { point: now.point.clone(), left: now.left.clone(), met: false };
    for step in 0..STEPS {
        interrupt::reached("Newton steps of a projection on cones", step)?;
        let endless = norm(&now.beta) > ENDLESS * (norm(y) + norm(problem.e));
        if norm(&now.left) <= ACCURACY * scale || endless || !now.phi.is_finite() {
            break;
        }
        let Some(direction) = direction(problem, motions, &now, shift)? else { break };
        let Some((next, t)) = armijo(problem, y, &now, &direction) else { break };
        let by = match t {
            1.0 => LESS,
            t if t < SHORT => MORE,
            _ => 1.0,
        };
        shift = (by * shift).clamp(SHIFTS.0, SHIFTS.1);
        now = next;
        if norm(&now.left) < norm(&nearest.left) {
            (nearest.point, nearest.left) = (now.point.clone(), now.left.clone());
        }
    }
    Ok((now, nearest))
}

fn direction(
    problem: &FrictionProblem,
    motions: &Motions,
    now: &Trial,
    shift: f64,
) -> Result<Option<Vec<f64>>> {
    let (coordinates, weights) = derivative(problem.cones, &now.places);
    let matrix = motions.shifted(&coordinates, weights, shift)?;
    matrix.map(|matrix| matrix.solve(&now.left)).transpose()
}

/// Removes the rounding in `e - G l`, which weakly resisted motions would amplify.
fn polished(problem: &FrictionProblem, motions: &Motions, y: &[f64], mut now: Trial) -> Result<Trial> {
    for _ in 0..POLISHES {
        let error = norm(&now.left);
        if error == 0.0 {
            break;
        }
        let Some(direction) = direction(problem, motions, &now, ROUNDING)? else { break };
        let mut beta = now.beta.clone();
        axpy(1.0, &direction, &mut beta);
        let next = trial(problem, y, beta);
        if !(norm(&next.left) < 0.5 * error) {
            break;
        }
        now = next;
    }
    Ok(now)
}

fn trial(problem: &FrictionProblem, y: &[f64], beta: Vec<f64>) -> Trial {
    let g_transposed = problem.g_transposed;
    let mut v = y.to_vec();
    v.iter_mut().enumerate().for_each(|(i, v)| *v += g_transposed.row_dot(i, &beta));
    let (point, places) = problem.cones.nearest(&v);
    let mut left = problem.e.to_vec();
    g_transposed.mul_transposed_add(-1.0, &point, &mut left);
    let phi = dot(&v, &point) - 0.5 * dot(&point, &point) - dot(problem.e, &beta);
    Trial { beta, point, places, left, phi }
}

/// The first of the steps 1, 1/2, ... that reduces phi sufficiently.
fn armijo(problem: &FrictionProblem, y: &[f64], now: &Trial, direction: &[f64]) -> Option<(Trial, f64)> {
    let (slope, mut t) = (-dot(&now.left, direction), 1.0);
    while t > SHORTEST {
        let mut beta = now.beta.clone();
        axpy(t, direction, &mut beta);
        let next = trial(problem, y, beta);
        if next.phi <= now.phi + SLOPE * t * slope + 4.0 * f64::EPSILON * now.phi.abs() {
            return Some((next, t));
        }
        t *= 0.5;
    }
    None
}

/// PI' as a sum of `weight^2 v v'`: v is a coordinate; on the surface of a cone, the normal coordinate includes the one
/// along the forces of its nodes.
pub fn derivative(cones: &Cones, places: &[Place]) -> (Vec<Coordinate>, Vec<f64>) {
    let held = Law::Held { value: 0.0 };
    let (mut face, mut weights) = (Face::empty(cones, 1.0), Vec::with_capacity(cones.order()));
    let mut places = places.iter();
    for nodes in cones.groups() {
        let normal = weights.len();
        face.coordinates.extend(nodes[0].normal.map(|row| Coordinate::row(row, held)));
        weights.extend(nodes[0].normal.map(|_| 0.0));
        let mut size = 1.0f64;
        for (node, place) in nodes.iter().zip(&mut places) {
            let (along, coupling, own) = match *place {
                Place::Inside | Place::Open => ([1.0, 0.0], None, [1.0, 1.0]),
                Place::Rim { along, ratio } => (along, None, [0.0, ratio.sqrt()]),
                Place::Surface { along, ratio } => {
                    size = size.hypot(node.mu);
                    (along, Some((node.behind, node.mu)), [0.0, ratio.sqrt()])
                }
            };
            face.push_tangents(node.tangents(), along, coupling, [held, held]);
            weights.extend_from_slice(&own[..node.tangents().len()]);
            if node.normal.is_some() && matches!(place, Place::Inside | Place::Surface { .. }) {
                weights[normal] = 1.0 / size;
            }
        }
    }
    face.finish(cones);
    weights.resize(cones.order(), 1.0);
    (face.coordinates, weights)
}

impl Trial {
    fn done(self, met: bool) -> Projected {
        Projected { point: self.point, left: self.left, met }
    }
}
