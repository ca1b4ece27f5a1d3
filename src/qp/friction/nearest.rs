//! The nearest point of the cones with `G x = e`, PROJ_C(y), and with `G x + delta beta = e`, by Newton's method for beta in
//!
//! ```text
//! G PI(y + G'beta) + delta beta = e,   the gradient of   phi(beta) = v'l - l'l/2 + delta |beta|^2/2 - e'beta,   v = y + G'beta,   l = PI(v)
//! ```

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm};
use crate::numbers::friction::{
    ARMIJO, ENDLESS, FIRST_SHIFT, PROJECTION_ACCEPTED, SHIFTS, SHIFT_LESS, SHIFT_MORE, SHIFT_SHORT,
    SHORTEST_PROJECTION_STEP,
};
use crate::numbers::qp::PROJECTED;
use crate::numbers::rounding;
use crate::platform::interrupt;
use crate::qp::friction::cones::{Cones, Place};
use crate::qp::friction::coordinates::{Coordinate, Law};
use crate::qp::friction::face::Face;
use crate::qp::friction::motions::Motions;
use crate::qp::Qp;

const STEPS: usize = 100;

/// What is projected. Without delta the multiplier has no bound if no point satisfies `G x = e`.
pub struct Target<'a> {
    pub qp: &'a Qp<'a>,
    pub cones: &'a Cones,
    pub motions: &'a Motions<'a>,
    pub y: &'a [f64],
    pub delta: f64,
}

#[derive(Clone)]
pub struct Projected {
    pub beta: Vec<f64>,
    pub point: Vec<f64>,
    pub places: Vec<Place>,
    /// `e - G point - delta beta`
    pub left: Vec<f64>,
    phi: f64,
    /// `left` is small enough.
    pub met: bool,
}

impl Target<'_> {
    /// The end point of Newton's method from beta; if it does not satisfy the equations, the point closest to that.
    pub fn projected(&self, beta: Vec<f64>) -> Result<Projected> {
        let mut terms = vec![0.0; self.qp.e.len()];
        self.qp.g_transposed.mul_transposed_abs_add(self.y, &mut terms);
        let scale = norm(self.qp.e) + norm(&terms);
        let (mut now, mut shift) = (self.at(beta), FIRST_SHIFT);
        let mut closest = now.clone();
        for step in 0..STEPS {
            interrupt::reached("Newton steps of a projection on cones", step)?;
            let (error, size) = (norm(&now.left), norm(self.y) + norm(self.qp.e));
            let endless = self.delta == 0.0 && norm(&now.beta) > ENDLESS * size;
            if error == 0.0 || endless || !now.phi.is_finite() {
                break;
            }
            let is_last = error <= (PROJECTED * scale).max(self.rounding(&now));
            // the last steps remove rounding in e - G l, which weakly resisted motions would amplify
            let Some(direction) = self.direction(&now, if is_last { rounding::SOLVE } else { shift })? else {
                break;
            };
            let Some((next, t)) = self.step(&now, &direction, is_last) else { break };
            let by = match t {
                1.0 => SHIFT_LESS,
                t if t < SHIFT_SHORT => SHIFT_MORE,
                _ => 1.0,
            };
            shift = (by * shift).clamp(SHIFTS.0, SHIFTS.1);
            now = next;
            if norm(&now.left) < norm(&closest.left) {
                closest.clone_from(&now);
            }
        }
        let met = scale.is_finite() && norm(&now.left) <= PROJECTION_ACCEPTED * scale;
        Ok(Projected { met, ..if met { now } else { closest } })
    }

    /// Of `G PI(v)` by that of `v = y + G'beta`, where delta makes beta large: the smaller delta, the larger is beta. Without delta many
    /// bodies on top of each other make beta large, too, but the residual still falls far below this bound.
    fn rounding(&self, now: &Projected) -> f64 {
        if self.delta == 0.0 {
            return 0.0;
        }
        let rows = self.qp.g_transposed;
        let of_row = |(i, x): (usize, &f64)| if *x == 0.0 { 0.0 } else { rows.row_dot_abs(i, &now.beta) };
        let sizes: Vec<f64> = now.point.iter().enumerate().map(of_row).collect();
        let mut terms = vec![0.0; self.qp.e.len()];
        rows.mul_transposed_abs_add(&sizes, &mut terms);
        f64::EPSILON * norm(&terms)
    }

    fn direction(&self, now: &Projected, shift: f64) -> Result<Option<Vec<f64>>> {
        let shift = if self.delta > 0.0 { self.delta / self.motions.size() } else { shift };
        let (coordinates, weights) = derivative(self.cones, &now.places);
        let matrix = self.motions.shifted(&coordinates, &weights, shift)?;
        matrix.map(|matrix| matrix.solve(&now.left)).transpose()
    }

    pub fn at(&self, beta: Vec<f64>) -> Projected {
        let Self { qp, cones, y, delta, .. } = self;
        let mut v = y.to_vec();
        v.iter_mut().enumerate().for_each(|(i, v)| *v += qp.g_transposed.row_dot(i, &beta));
        let (point, places) = cones.nearest(&v);
        let mut left = qp.left(&point);
        axpy(-delta, &beta, &mut left);
        let phi = dot(&v, &point) - 0.5 * dot(&point, &point) + 0.5 * delta * dot(&beta, &beta);
        Projected { phi: phi - dot(qp.e, &beta), beta, point, places, left, met: false }
    }

    /// The first of the steps 1, 1/2, ... that reduces phi sufficiently; of the last steps only 1, and only if it halves the residual.
    fn step(&self, now: &Projected, direction: &[f64], is_last: bool) -> Option<(Projected, f64)> {
        let (slope, mut t) = (-dot(&now.left, direction), 1.0);
        while t > SHORTEST_PROJECTION_STEP {
            let mut beta = now.beta.clone();
            axpy(t, direction, &mut beta);
            let next = self.at(beta);
            let falls = next.phi <= now.phi + ARMIJO * t * slope + 4.0 * f64::EPSILON * now.phi.abs();
            match is_last {
                true => return (norm(&next.left) < 0.5 * norm(&now.left)).then_some((next, t)),
                false if falls && norm(&next.left).is_finite() => return Some((next, t)),
                false => t *= 0.5,
            }
        }
        None
    }
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
