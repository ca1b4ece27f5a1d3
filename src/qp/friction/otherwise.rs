//! Alternatives if Newton's method does not end well, by cost: the smoothed laws, weak supports, sticking nodes, dense systems.
//! `make rungs` counts what each saves.

use crate::error::{Kind, Result};
use crate::numbers::friction::{PATH_LEFT, RHO};
use crate::qp::friction::direct::Dense;
use crate::qp::friction::face::{Face, State};
use crate::qp::friction::newton::{Point, Run};
use crate::qp::friction::path::{DIRECTIONS, LONG, SHORT};
use crate::qp::friction::slides::Shown;
use crate::qp::friction::FrictionLimits;
use crate::qp::Rung;

impl Run<'_, '_> {
    /// Called if Newton's method has not ended well: tries one alternative after the other until one succeeds. A slide that weak supports
    /// show spares what costs many products; rests beside it are sought by the others.
    pub fn otherwise(&mut self, limits: FrictionLimits, start: &Point, stalled: Point) -> Result<Point> {
        let mut now = stalled.clone();
        if !self.is_over(&now) && Rung::ShortPath.is_tried() {
            now = self.along_path(start, SHORT)?;
        }
        if self.is_over(&now) {
            return Ok(now);
        }
        let shown = match Rung::Supports.is_tried() {
            true => self.with_supports(limits.tolerance, None)?,
            false => Shown::Nothing,
        };
        now = self.shown(shown)?.unwrap_or(now);
        if self.is_over(&now) {
            return Ok(now);
        }
        if Rung::Sticking.is_tried() {
            now = self.sticking(start)?.unwrap_or(now);
        }
        if self.slide.is_none() && !self.is_over(&now) && Rung::LongPath.is_tried() {
            now = self.along_path(start, LONG)?;
        }
        if self.is_over(&now) {
            return Ok(now);
        }
        Ok(self.by_dense_systems(limits, start)?.unwrap_or(stalled))
    }

    /// Exactly solved systems, if rows and modes are within the limit and the memory.
    fn by_dense_systems(&mut self, limits: FrictionLimits, start: &Point) -> Result<Option<Point>> {
        let dense = limits.direct.map(|direct| Dense::new(&self.problem, direct)).transpose();
        let dense = dense.or_else(|error| if error.kind == Kind::Memory { Ok(None) } else { Err(error) })?;
        let Some(dense) = dense.flatten() else { return Ok(None) };
        let found = self.densely(&dense, start)?;
        if found.is_some() || self.slide.is_some() || !Rung::DenseSupports.is_tried() {
            return Ok(found);
        }
        let shown = self.with_supports(limits.tolerance, Some(&dense))?;
        self.shown(shown)
    }

    /// Keeps a slide; continues from a point close to a rest.
    fn shown(&mut self, shown: Shown) -> Result<Option<Point>> {
        self.slide = None;
        match shown {
            Shown::Rest(rest) => return self.newton_within(&rest),
            Shown::Slides(slide) => self.slide = Some(slide),
            Shown::Nothing => {}
        }
        Ok(None)
    }

    fn is_over(&self, now: &Point) -> bool {
        self.is_met(now) || self.counts.products >= self.limit
    }

    /// From the answer for which all nodes that are closed at the start stick.
    fn sticking(&mut self, start: &Point) -> Result<Option<Point>> {
        self.counts.starts += 1;
        let at = Face::at(self.problem.cones, &start.x, &start.r, RHO);
        let mut face = Face::empty(self.problem.cones, RHO);
        for (i, node) in self.problem.cones.nodes().iter().enumerate() {
            let carries = at.closed[i] || at.states[i] != State::Open;
            let state = if carries { State::Stick } else { State::Open };
            face.push_node(node, at.closed[i], state, ([1.0, 0.0], 0.0));
        }
        face.finish(self.problem.cones);
        let mut model = self.model(face)?;
        let step = self.enough(&mut model, start, (PATH_LEFT, DIRECTIONS))?;
        let (x, g) = step.from(&start.x, &start.g, 1.0);
        let alpha = self.turned(&model, &x, &g, &start.alpha)?;
        let found = self.point(x, g, alpha)?;
        self.newton_within(&found)
    }

    /// Newton's method from the nearest point within the cones.
    fn newton_within(&mut self, found: &Point) -> Result<Option<Point>> {
        let inside = self.projected(&found.x)?;
        if !inside.met {
            return Ok(None);
        }
        let g = self.gradient(&inside.point)?;
        let begun = self.begin(&inside.point, &g, &found.alpha)?;
        self.newton(begun).map(Some)
    }
}
