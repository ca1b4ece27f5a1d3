//! Alternatives if Newton's method does not end well: other rho, the smoothed laws, other starts, dense systems.

use crate::error::{Kind, Result};
use crate::linalg::vector::axpy;
use crate::qp::friction::coordinates::Law;
use crate::qp::friction::direct::Dense;
use crate::qp::friction::face::{Face, State};
use crate::qp::friction::nearest::project;
use crate::qp::friction::newton::{Laws, Point, Run, RHO};
use crate::qp::friction::path::{Solves, Way};
use crate::qp::Direct;

/// Multiples of rho tried if the merit falls too slowly; the first two are combined with a path along smoothed laws,
/// which comes first if the merit is far from zero.
const MULTIPLES: [f64; 5] = [5.0, 0.2, 25.0, 0.04, 1.0];
/// A merit above this part of the scale is no better than that of the start.
const FAR: f64 = 1e-3;
/// The first path ends when the states are known, the second continues close to sliding.
const PATHS: [Way; 2] = [
    Way { relaxed: 0.0, last: 1e-3, solves: Solves::Pairs { products: 60 } },
    Way { relaxed: 1.0, last: LAST, solves: Solves::Pairs { products: 100 } },
];
/// Smallest eps relative to the first eps: rounding.
const LAST: f64 = 1e-14;
/// rho of the paths with dense matrices, and the relaxation of bounds.
const DENSE: [(f64, f64); 4] = [(RHO, 0.0), (RHO, 1.0), (5.0 * RHO, 1.0), (RHO, 3.0)];

impl Run<'_, '_> {
    /// Called if Newton's method has not ended well: tries other rho, the smoothed laws, other starts, dense systems,
    /// until one succeeds.
    pub fn otherwise(&mut self, direct: Option<Direct>, start: &Point, stalled: Point) -> Result<Point> {
        let mut now = stalled;
        for (count, multiple) in MULTIPLES.into_iter().enumerate() {
            let (way, far) = (PATHS.get(count), now.merit > FAR * self.scale);
            for by_path in [far, !far] {
                now = match way.filter(|_| by_path) {
                    Some(&way) => self.along_path(start, RHO, way)?,
                    None if by_path => now,
                    None => self.again(start, now, multiple * RHO)?,
                };
                if self.is_over(&now) {
                    return Ok(now);
                }
            }
        }
        for second in [Self::without_friction, Self::sticking] {
            if let Some(second) = second(self, start)? {
                now = self.newton(Laws { cones: self.problem.cones, rho: RHO }, second)?;
            }
            if self.is_over(&now) {
                return Ok(now);
            }
        }
        self.by_dense_systems(direct, start, now)
    }

    /// Paths with exactly solved systems, if rows and modes are within the limit and the memory.
    fn by_dense_systems(&mut self, direct: Option<Direct>, start: &Point, stalled: Point) -> Result<Point> {
        let dense = direct.map(|direct| Dense::new(&self.problem, direct)).transpose();
        let dense = dense.or_else(|error| if error.kind == Kind::Memory { Ok(None) } else { Err(error) })?;
        let (Some(dense), mut now) = (dense.flatten(), stalled.clone()) else { return Ok(stalled) };
        for (rho, relaxed) in DENSE {
            now = self.along_path(start, rho, Way { relaxed, last: LAST, solves: Solves::Dense(&dense) })?;
            if self.is_over(&now) {
                break;
            }
        }
        Ok(now)
    }

    fn is_over(&self, now: &Point) -> bool {
        self.is_met(now) || self.counts.products >= self.limit
    }

    /// Another rho, from the present point or, if this is far from an answer, from the start.
    fn again(&mut self, start: &Point, now: Point, rho: f64) -> Result<Point> {
        self.tried.restarts += 1;
        let laws = Laws { cones: self.problem.cones, rho };
        let near = now.merit <= FAR * self.scale;
        let from = if near { &now } else { start };
        let begun = self.begin(laws, &from.x, &from.g, &from.alpha)?;
        self.newton(laws, begun)
    }

    /// Newton's method from the end point of a path that begins at the start.
    fn along_path(&mut self, start: &Point, rho: f64, way: Way) -> Result<Point> {
        match way.solves {
            Solves::Pairs { .. } => self.tried.paths += 1,
            Solves::Dense(_) => self.tried.dense_paths += 1,
        }
        let laws = Laws { cones: self.problem.cones, rho };
        let begun = self.point(laws, start.x.clone(), start.g.clone(), start.alpha.clone())?;
        let end = self.path(laws, begun, way)?;
        if self.is_met(&end) {
            return Ok(end);
        }
        self.newton(laws, end)
    }

    /// The answer without friction as a start, if there is one.
    fn without_friction(&mut self, start: &Point) -> Result<Option<Point>> {
        self.tried.frictionless = true;
        let cones = self.problem.cones.frictionless();
        let first = project(&self.problem, &cones, self.motions.as_ref(), &start.x)?;
        if !first.met {
            return Ok(None);
        }
        let laws = Laws { cones: &cones, rho: RHO };
        let g = self.gradient(&first.point)?;
        let begun = self.begin(laws, &first.point, &g, &start.alpha)?;
        // it is not an answer for the laws with friction
        let best = std::mem::take(&mut self.last);
        let found = self.newton(laws, begun);
        self.last = best;
        self.within(&found?)
    }

    /// As a start, the answer for which all nodes that are closed at the start stick.
    fn sticking(&mut self, start: &Point) -> Result<Option<Point>> {
        self.tried.sticking = true;
        let mut face = Face::at(self.problem.cones, &start.x, &start.r, RHO);
        let sticks = Law::Free { damping: 0.0, shift: 0.0 };
        let mut k = 0;
        for (i, node) in self.problem.cones.nodes().iter().enumerate() {
            k += usize::from(node.own_normal().is_some());
            let carries = face.closed[i] || face.states[i] != State::Open;
            for at in &mut face.coordinates[k..k + node.tangents().len()] {
                at.coupling = None;
                at.law = if carries { sticks } else { Law::Held { value: 0.0 } };
            }
            k += node.tangents().len();
        }
        let model = self.model(face)?;
        let step = self.enough(&model, start)?;
        let (mut x, mut g) = (start.x.clone(), start.g.clone());
        axpy(1.0, &step.dx, &mut x);
        axpy(1.0, &step.dg, &mut g);
        let alpha = self.turned(&model, &x, &g, &start.alpha)?;
        let laws = Laws { cones: self.problem.cones, rho: RHO };
        let found = self.point(laws, x, g, alpha)?;
        self.within(&found)
    }

    /// The nearest point within the cones, and its product.
    fn within(&mut self, found: &Point) -> Result<Option<Point>> {
        let laws = Laws { cones: self.problem.cones, rho: RHO };
        let inside = project(&self.problem, laws.cones, self.motions.as_ref(), &found.x)?;
        if !inside.met {
            return Ok(None);
        }
        let g = self.gradient(&inside.point)?;
        self.begin(laws, &inside.point, &g, &found.alpha).map(Some)
    }
}
