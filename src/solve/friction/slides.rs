//! Loads that friction does not hold, although forces within the cones balance them: weak elastic supports of all motions detect them. The
//! forces of the supports fall with their stiffness kappa if there is a state of rest, and remain if the bodies slide.

use crate::error::{Error, Kind, Proof, Result};
use crate::linalg::vector::{axpy, dot, norm, norm_max};
use crate::platform::memory::zeros;
use crate::progress::Steps;
use crate::qp::friction::{friction, FrictionLimits, FrictionProblem, FrictionStart, Supported};
use crate::qp::{AcceptanceTest, Counts, Verdict};
use crate::solve::case::Case;

/// Stiffness of the supports, no unit: rows have the compliance 1, the modes of a body `|G_p| = 1`.
const WEAK: [f64; 2] = [1e-3, 1e-5];
/// The forces of the supports are constant if they differ by less than this part.
const STAYS: f64 = 0.05;
/// Parts of the load below this are zero.
const NOTHING: f64 = 1e-6;
/// A slide is steady if the gap rates of rows with forces, and forces not along the slip, are below this part of the
/// largest.
const STEADY: f64 = 1e-2;

/// The result of the weak supports.
pub enum Shown {
    Slides(Slide),
    /// Forces and amplitudes close to a state of rest.
    Rest {
        x: Vec<f64>,
        alpha: Vec<f64>,
    },
    Nothing,
}

/// A steady slide: the forces at their bounds hold only a part of the load.
pub struct Slide {
    /// Amplitudes of its motion.
    alpha: Vec<f64>,
    /// Part of the load along the motion that friction holds, no unit.
    capacity: f64,
}

/// The result of weak supports for a problem without an answer of the method; their work is added to `counts`.
pub fn shown(
    problem: FrictionProblem,
    limits: FrictionLimits,
    steps: &mut Steps,
    counts: &mut Counts,
) -> Result<Shown> {
    let (rows, modes) = (problem.b.len(), problem.e.len());
    if modes == 0 {
        return Ok(Shown::Nothing);
    }
    let mut start: Option<Vec<f64>> = None;
    let mut carried: Vec<Vec<f64>> = Vec::new();
    for kappa in WEAK {
        let supported = Supported::new(problem, kappa)?;
        let begin = FrictionStart { x: start.as_deref(), ..FrictionStart::default() };
        let limits = FrictionLimits { direct: None, ..limits };
        let found = friction(supported.problem(), limits, begin, &mut Content, steps)?;
        *counts = *counts + found.counts;
        if found.verdict != Verdict::Solved {
            return match found.verdict {
                Verdict::Cancelled => Err(Error::new(Kind::Cancelled, "cancelled by the host")),
                Verdict::TimeLimit => Err(Error::new(Kind::TimeOver, "the time limit is reached")),
                _ => Ok(Shown::Nothing),
            };
        }
        carried.push(supported.unheld(&found.x).to_vec());
        start = Some(found.x);
    }
    let (Some(x), [first, last]) = (start, &carried[..]) else { return Ok(Shown::Nothing) };
    let mut change = last.clone();
    axpy(-1.0, first, &mut change);
    let stays = norm(&change) <= STAYS * norm(last) && norm(last) > NOTHING * norm(problem.e);
    let x = x[..rows].to_vec();
    if !stays {
        let alpha = last.iter().map(|left| left / WEAK[1]).collect();
        return Ok(Shown::Rest { x, alpha });
    }
    // relative to the slide, the deformation of the bodies is of order kappa
    let mut motion = last.clone();
    axpy(WEAK[1] / (WEAK[0] - WEAK[1]), &change, &mut motion);
    if !is_steady(&problem, &x, &motion) {
        return Ok(Shown::Nothing);
    }
    let capacity = 1.0 - dot(&motion, &motion) / dot(problem.e, &motion);
    // forces that drive the motion are not friction at its bound
    if !(0.0..1.0).contains(&capacity) {
        return Ok(Shown::Nothing);
    }
    Ok(Shown::Slides(Slide { alpha: motion, capacity }))
}

/// Nodes that carry forces do not open, and their tangential forces are at their bounds along the slip.
fn is_steady(problem: &FrictionProblem, x: &[f64], alpha: &[f64]) -> bool {
    let rate = |row: usize| problem.g_transposed.row_dot(row, alpha);
    let rates: Vec<f64> = (0..x.len()).map(rate).collect();
    let small = STEADY * norm_max(&rates);
    let nodes = problem.cones.nodes();
    let largest = nodes.iter().map(|node| node.limit(node.of(x).normal)).fold(0.0, f64::max);
    small > 0.0
        && nodes.iter().all(|node| {
            let (force, rate) = (node.of(x), node.of(&rates));
            let limit = node.limit(force.normal);
            let slip = rate.tangential[0].hypot(rate.tangential[1]);
            let parts_well = force.normal <= STEADY * largest || rate.normal.abs() <= small;
            let is_along = (0..2).all(|k| {
                let along = limit * rate.tangential[k] / slip;
                (force.tangential[k] - along).abs() <= STEADY * largest
            });
            parts_well && (slip <= small || is_along)
        })
        && problem.cones.free().iter().all(|&row| rates[row].abs() <= small)
}

impl Slide {
    /// The error with the body that slides fastest, its motion, and the part that friction holds.
    pub fn named(&self, case: Case, starts: usize) -> Result<Error> {
        let (ready, island) = (case.ready, case.island());
        let own = ready.dual.rigid_motion(&self.alpha, island.unknowns());
        let mut v = zeros(case.model.sizes().dofs, "a motion")?;
        island.scatter(case.model, &own, &mut v);
        let fastest = (0..v.len()).fold(0, |best, i| if v[i].abs() > v[best].abs() { i } else { best });
        let body = case.model.offsets[1..].partition_point(|end| *end <= fastest);
        let dof = fastest - case.model.offsets[body];
        let sense = if v[fastest] > 0.0 { "positive" } else { "negative" };
        let largest = v[fastest].abs();
        v.iter_mut().for_each(|v| *v /= largest);
        let what = format!(
            "the body slides: friction holds {:.6} of the load along this motion, fastest at this dof, in the {sense} direction; \
             no rest was found from {starts} starts",
            self.capacity
        );
        let error = Error::new(Kind::Slides, what).body(body).dof(dof).value(self.capacity).limit(1.0);
        Ok(error.proved_by(Proof::Motion { margin: 1.0 - self.capacity, v }))
    }
}

/// Accepts every point: only the laws judge the supported problem.
struct Content;

impl AcceptanceTest for Content {
    fn scale(&mut self, _: &[f64], _: &[f64]) -> Result<f64> {
        Ok(1.0)
    }

    fn accepts(&mut self, _: &[f64], _: &[f64]) -> Result<bool> {
        Ok(true)
    }
}
