//! Loads that friction does not hold, although forces within the cones balance them. With weak elastic supports of all
//! motions, of the stiffness kappa, the forces of the supports are
//!
//! ```text
//! x_s = L + kappa a
//! ```
//!
//! while the states do not change: L = 0 at a state of rest, and L is the part of the load that drives a slide.

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm, norm_max};
use crate::numbers::friction::{SLIDE_OR_REST, STEADY, STIFFEST, WEAKER, WEAKEST};
use crate::qp::friction::direct::Dense;
use crate::qp::friction::newton::{Point, Run};
use crate::qp::friction::path::SHORT;
use crate::qp::friction::supports::Supported;
use crate::qp::friction::{FrictionLimits, FrictionProblem, FrictionStart, Slide};
use crate::qp::{Counts, Rung};

/// What weak supports show.
pub enum Shown {
    Slides(Slide),
    /// A point close to a state of rest.
    Rest(Point),
    Nothing,
}

impl Run<'_, '_> {
    /// Follows the forces of the supports as these become weaker; pairs serve all stiffnesses. Where Newton's method fails a path continues,
    /// or dense systems.
    pub fn with_supports(&mut self, tolerance: f64, dense: Option<&Dense>) -> Result<Shown> {
        let (rows, modes) = (self.problem.qp.b.len(), self.problem.qp.e.len());
        if modes == 0 {
            return Ok(Shown::Nothing);
        }
        let mut pairs = self.pairs.extended(modes);
        let tolerance = tolerance.min(WEAKEST);
        let (mut kappa, mut before) = (STIFFEST, None::<Point>);
        let (mut slide, mut rests) = (None, 0);
        while kappa >= WEAKEST && self.counts.products < self.limit {
            let supported = Supported::new(self.problem, kappa)?;
            let limits =
                FrictionLimits { tolerance, products: self.limit - self.counts.products, direct: None };
            let begin = FrictionStart { x: before.as_ref().map(|before| &before.x[..]), alpha: None, pairs };
            let (mut run, first) = Run::new(supported.problem(), limits, begin, &mut *self.observer)?;
            let begun = run.begun(tolerance, &first, &vec![0.0; modes])?;
            let mut found = run.newton(begun.clone())?;
            if !run.is_met(&found) && Rung::SupportPath.is_tried() {
                found = match dense {
                    None => run.along_path(&begun, SHORT)?,
                    Some(dense) => run.densely(&dense.supported(modes, kappa)?, &begun)?.unwrap_or(found),
                };
            }
            let (met, small) = (run.is_met(&found), run.small);
            pairs = std::mem::take(&mut run.pairs);
            pairs.stiffen(rows, WEAKER);
            self.counts = self.counts + Counts { starts: 0, ..run.counts };
            kappa *= WEAKER;
            // after dense systems there is no answer for this stiffness, but perhaps for the next
            if !met && dense.is_none() {
                break;
            }
            if let Some(before) = before.filter(|_| met) {
                let carried = supported.unheld(&found.x);
                let driving = extrapolated(supported.unheld(&before.x), carried);
                let mut elastic = carried.to_vec();
                axpy(-1.0, &driving, &mut elastic);
                let is_rest = norm(&driving) <= SLIDE_OR_REST * norm(carried);
                rests = if is_rest { rests + 1 } else { 0 };
                let driven = (norm(&elastic) <= SLIDE_OR_REST * norm(&driving)).then_some(driving);
                let shown =
                    driven.and_then(|driving| steady(&self.problem, (&found.x[..rows], small), driving));
                let is_twice = slide.is_some() && shown.is_some();
                slide = shown;
                match (is_twice, slide.clone()) {
                    (true, Some(slide)) => return Ok(Shown::Slides(slide)),
                    _ if rests == 2 => return Ok(Shown::Rest(found.of_rows(rows))),
                    _ => {}
                }
            }
            before = met.then_some(found);
        }
        Ok(slide.map_or(Shown::Nothing, Shown::Slides))
    }
}

/// L of the forces of two supports, the second weaker: linear in kappa.
fn extrapolated(before: &[f64], carried: &[f64]) -> Vec<f64> {
    carried.iter().zip(before).map(|(now, before)| (now - WEAKER * before) / (1.0 - WEAKER)).collect()
}

impl Point {
    /// The part on the first rows.
    fn of_rows(&self, rows: usize) -> Self {
        let of = |v: &[f64]| v[..rows].to_vec();
        Self { x: of(&self.x), g: of(&self.g), r: of(&self.r), alpha: self.alpha.clone(), merit: self.merit }
    }
}

/// A slide along these amplitudes, with forces that are accurate to `nothing`, if nodes that carry forces do not open, tangential forces
/// are at their bounds along the slip, and the load drives it.
fn steady(problem: &FrictionProblem, (x, nothing): (&[f64], f64), alpha: Vec<f64>) -> Option<Slide> {
    let rate = |row: usize| problem.qp.g_transposed.row_dot(row, &alpha);
    let rates: Vec<f64> = (0..x.len()).map(rate).collect();
    let small = STEADY * norm_max(&rates);
    let nodes = problem.cones.nodes();
    let largest = nodes.iter().map(|node| node.limit(node.of(x).normal)).fold(0.0, f64::max);
    let weak = nothing.max(STEADY * largest);
    let is_steady = small > 0.0
        && nodes.iter().all(|node| {
            let (force, rate) = (node.of(x), node.of(&rates));
            let limit = node.limit(force.normal);
            let slip = rate.tangential[0].hypot(rate.tangential[1]);
            let parts_well = force.normal <= weak || rate.normal.abs() <= small;
            let is_along = (0..2).all(|k| {
                let along = limit * rate.tangential[k] / slip;
                (force.tangential[k] - along).abs() <= weak
            });
            parts_well && (slip <= small || is_along)
        })
        && problem.cones.free().iter().all(|&row| rates[row].abs() <= small);
    // forces that drive the motion are not friction at its bound
    let capacity = 1.0 - dot(&alpha, &alpha) / dot(problem.qp.e, &alpha);
    let is_driven = (-STEADY..1.0).contains(&capacity);
    (is_steady && is_driven).then_some(Slide { alpha, capacity: capacity.max(0.0) })
}
