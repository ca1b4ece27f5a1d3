//! The smoothed laws: `phi(z) = (z + sqrt(z^2 + 4 eps^2))/2` replaces z+. Every coordinate is then an equation with its
//! own damping, and no state is decided before eps is small.
//!
//! ```text
//! x_n = phi(xi_n),   x_t = c(|xi_t|) xi_t/|xi_t|,   c(s) = s + phi(-s - b) - phi(s - b),   b = bound + mu phi(xi_n) + relaxed eps
//! ```
//!
//! c < b: without the last term of b, a load close to sliding would require unlimited slip, or a larger force than b
//! allows.

use crate::linalg::vector::dot;
use crate::numbers::friction::SMALLEST_WEIGHT;
use crate::numbers::linalg::ROOT;
use crate::qp::friction::cones::{direction, length, Cones, Node};
use crate::qp::friction::coordinates::{Coordinate, Law};
use crate::qp::friction::face::{Face, State};

#[derive(Clone, Copy)]
pub struct Smoothing {
    /// A force.
    pub eps: f64,
    pub relaxed: f64,
}

/// `phi(z)`, positive, without cancellation.
fn phi(z: f64, eps: f64) -> f64 {
    let s = z.hypot(2.0 * eps);
    if z > 0.0 {
        0.5 * (z + s)
    } else {
        2.0 * eps * eps / (s - z)
    }
}

/// `phi'(z)`, in (0, 1); `1 - phi'(z) = phi'(-z)`.
fn slope(z: f64, eps: f64) -> f64 {
    phi(z, eps) / z.hypot(2.0 * eps)
}

/// c of a length s with the limit b, its derivatives, and their differences from 1, each without cancellation.
struct Disc {
    /// `c/s` and `1 - c/s`
    ratio: f64,
    rest: f64,
    /// `c'(s)` and `1 - c'(s)`
    slope: f64,
    drop: f64,
    /// `dc/db`; divided by `1 - c'(s)` and multiplied by mu it is the coupling of x_t with x_n.
    by_limit: f64,
}

impl Disc {
    fn of(s: f64, b: f64, eps: f64) -> Self {
        let (below, above) = (slope(-s - b, eps), slope(s - b, eps));
        let far = phi(-s - b, eps);
        let slope_ = if s < b { 1.0 - below - above } else { slope(b - s, eps) - below };
        let (drop, by_limit) = (below + above, above - below);
        let (ratio, rest) = if s <= ROOT * eps {
            (slope_, drop)
        } else if s < b {
            let lost = (phi(s - b, eps) - far) / s;
            (1.0 - lost, lost)
        } else {
            let ratio = (b + far - phi(b - s, eps)) / s;
            (ratio, 1.0 - ratio)
        };
        Self { ratio: ratio.max(SMALLEST_WEIGHT), rest, slope: slope_.max(SMALLEST_WEIGHT), drop, by_limit }
    }
}

/// The linear model of the smoothed laws at x and r, and `|x - smoothed NAT(xi)|` with rho r on free rows: a force.
pub fn face(cones: &Cones, x: &[f64], r: &[f64], rho: f64, by: Smoothing) -> (Face, f64) {
    let xi: Vec<f64> = x.iter().zip(r).map(|(x, r)| x - rho * r).collect();
    let mut face = Face::empty(cones, rho);
    let mut square: f64 = cones.free().iter().map(|&row| (rho * r[row]).powi(2)).sum();
    square += cones.nodes().iter().map(|node| push(&mut face, node, (x, r, &xi), by)).sum::<f64>();
    face.finish(cones);
    (face, square.sqrt())
}

/// Adds the coordinates of a node, and returns its part `|R|^2` of the square of what the laws miss:
/// `p dr_n + (1 - p)/rho dx_n = -R_n/rho`, `p = phi'(xi_n)`, and of the tangential ones
///
/// ```text
/// c' dr_u + (1 - c')/rho dx_u - mu dc/db (dx_n + R_n)/rho = -R_u/rho,   k dr_v + (1 - k)/rho dx_v = -R_v/rho,   k = c/|xi_t|
/// ```
fn push(face: &mut Face, node: &Node, (x, r, xi): (&[f64], &[f64], &[f64]), by: Smoothing) -> f64 {
    let eps = by.eps;
    let (rho, now, trial) = (face.rho, node.of(x), node.of(xi));
    let (mut normal, mut missed) = (0.0, 0.0);
    if let Some(row) = node.normal {
        normal = phi(trial.normal, eps);
        missed = now.normal - normal;
        let p = slope(trial.normal, eps).max(SMALLEST_WEIGHT);
        let damping = slope(-trial.normal, eps) / (rho * p);
        let shift = r[row] + damping * now.normal - missed / (rho * p);
        let coordinate = Coordinate::row(row, Law::Free { damping, shift });
        face.coordinates.extend(node.own_normal().map(|_| coordinate));
    }
    let limit = node.limit(normal) + by.relaxed * eps;
    let size = length(trial.tangential);
    let disc = Disc::of(size, limit, eps);
    let coupling = node.mu * disc.by_limit / disc.drop;
    let along = direction(trial.tangential);
    let damping = disc.drop / (rho * disc.slope);
    let missed_along = dot(&along, &now.tangential) - disc.ratio * size;
    let missed_along = missed_along - node.mu * disc.by_limit * missed;
    let slack = dot(&along, &now.tangential) - coupling * now.normal;
    let slip = dot(&along, &node.of(r).tangential);
    let shift = slip + damping * slack - missed_along / (rho * disc.slope);
    let first = Law::Free { damping, shift };
    let second = Law::Free { damping: disc.rest / (rho * disc.ratio), shift: 0.0 };
    let coupling = node.normal.map(|_| (node.behind, coupling));
    face.push_tangents(node.tangents(), along, coupling, [first, second]);
    face.closed.push(node.normal.is_some() && trial.normal > 0.0);
    face.states.push(if size > limit { State::Slip } else { State::Stick });
    let square = (0..2).map(|k| (now.tangential[k] - disc.ratio * trial.tangential[k]).powi(2)).sum::<f64>();
    square + node.own_normal().map_or(0.0, |_| missed.powi(2))
}
