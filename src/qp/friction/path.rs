//! Newton's method along the smoothed laws, eps from large to small: used if Newton's method cycles with the laws
//! themselves.

use crate::error::Result;
use crate::linalg::vector::norm_max;
use crate::numbers::friction::{
    EPS_SHRINKS, EPS_SHRINKS_LESS, FIRST_EPS, PATH_FALLS, PATH_LEFT, RHO, SHORTEST_PATH_STEP, SHORT_PATH,
};
use crate::numbers::rounding;
use crate::qp::friction::direct::Dense;
use crate::qp::friction::face::Model;
use crate::qp::friction::newton::{Point, Run};
use crate::qp::friction::pairs::Step;
use crate::qp::friction::smooth::{face, Smoothing};

/// The path that ends when the states are known: most problems on which Newton's method cycles need no more.
pub const SHORT: Way = Way { relaxed: 0.0, last: SHORT_PATH, solves: Solves::Pairs { products: 40 } };
/// The path that continues close to sliding.
pub const LONG: Way = Way { relaxed: 1.0, last: rounding::SUM, solves: Solves::Pairs { products: 100 } };
/// Limit of systems solved.
const SYSTEMS: usize = 120;
/// Limit of directions per system, and the part of its residual that may remain.
pub const DIRECTIONS: usize = 10;

impl Run<'_, '_> {
    /// Newton's method from the end point of a path that begins at the start.
    pub fn along_path(&mut self, start: &Point, way: Way) -> Result<Point> {
        self.counts.starts += 1;
        let begun = self.point(start.x.clone(), start.g.clone(), start.alpha.clone())?;
        let end = self.path(begun, way)?;
        if self.is_met(&end) {
            return Ok(end);
        }
        self.newton(end)
    }

    /// Continues from `now` until the laws are satisfied or eps is at its end; with at most `products` further pairs, or
    /// with dense systems.
    pub fn path(&mut self, mut now: Point, way: Way) -> Result<Point> {
        let (cones, rho) = (self.problem.cones, RHO);
        let root = (now.x.len() as f64).sqrt();
        let end = match way.solves {
            Solves::Pairs { products } => self.limit.min(self.counts.products + products),
            Solves::Dense(_) => usize::MAX,
        };
        let first = FIRST_EPS * norm_max(&now.x).max(rho * self.scale / root);
        let mut eps = first;
        for _ in 0..SYSTEMS {
            if self.is_met(&now) || eps <= way.last * first || self.counts.products >= end {
                break;
            }
            let by = Smoothing { eps, relaxed: way.relaxed };
            let (face, before) = face(cones, &now.x, &now.r, rho, by);
            let mut model = self.model(face)?;
            let step = match way.solves {
                Solves::Pairs { .. } => self.enough(&mut model, &now, (PATH_LEFT, DIRECTIONS))?,
                Solves::Dense(dense) => {
                    self.counts.direct += 1;
                    dense.solved(&self.problem, &model.face, &now)?.0
                }
            };
            self.counts.newton += 1;
            let (next, t, left) = self.shortened(&model, &now, &step, (by, before))?;
            now = next;
            if left <= eps * root {
                eps *= if t == 1.0 { EPS_SHRINKS } else { EPS_SHRINKS_LESS };
            }
        }
        Ok(now)
    }

    /// Adds at most `most` directions to the pairs until no more than this part of the residual is left.
    pub fn enough(&mut self, model: &mut Model, now: &Point, (left, most): (f64, usize)) -> Result<Step> {
        let preconditioner = self.problem.preconditioner.map(|m| m.on(&model.face)).transpose()?;
        let mut step = self.pairs.minimise(model, (&now.x, &now.r))?;
        for _ in 0..most {
            if step.rest <= left || self.counts.products >= self.limit {
                break;
            }
            let (x, r) = step.from(&now.x, &now.r, 1.0);
            let v = self.direction(model, preconditioner.as_deref(), (&x, &r))?;
            if !self.keep(v, now, model)? {
                break;
            }
            step = self.pairs.minimise(model, (&now.x, &now.r))?;
        }
        Ok(step)
    }

    /// The first of the steps 1, 1/2, ... that reduces the residual sufficiently, or the shortest; with its length and
    /// residual.
    fn shortened(
        &mut self,
        model: &Model,
        now: &Point,
        step: &Step,
        (by, before): (Smoothing, f64),
    ) -> Result<(Point, f64, f64)> {
        let (cones, rho) = (self.problem.cones, RHO);
        let (x, g) = step.from(&now.x, &now.g, 1.0);
        let there = self.turned(model, &x, &g, &now.alpha)?;
        let mut t = 1.0;
        loop {
            let (x, g) = step.from(&now.x, &now.g, t);
            let alpha: Vec<f64> =
                now.alpha.iter().zip(&there).map(|(now, there)| now + t * (there - now)).collect();
            let left = face(cones, &x, &self.gaps(&g, &alpha), rho, by).1;
            if left <= (1.0 - PATH_FALLS * t) * before || t <= SHORTEST_PATH_STEP {
                let next = self.point(x, g, alpha)?;
                let next = if next.merit.is_finite() { next } else { now.clone() };
                return Ok((next, t, left));
            }
            t *= 0.5;
        }
    }
}

/// A path: the relaxation of bounds in units of eps, and the last eps relative to the first.
#[derive(Clone, Copy)]
pub struct Way<'d> {
    pub relaxed: f64,
    pub last: f64,
    pub solves: Solves<'d>,
}

/// How the systems of a path are solved.
#[derive(Clone, Copy)]
pub enum Solves<'d> {
    Pairs { products: usize },
    Dense(&'d Dense),
}
