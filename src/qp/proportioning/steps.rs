//! The three steps: conjugate gradients on the face, expansion of the active set, the proportioning step: P3 to P12 of docs/method.md.

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm};
use crate::numbers::linalg::SINGULAR;
use crate::numbers::qp::{
    CURVATURE_MARGIN, CUT_SHORT, FLAT_ENTRY, GRADIENT_STEP, LOST, NO_FORCE, SHORT_STEP,
};
use crate::qp::gradient::feasible_step;
use crate::qp::projection::project;
use crate::qp::proportioning::iterate::Iterate;
use crate::qp::Rung;

/// After this number of gradient projections, free motions are those of the last projection: otherwise projections alone
/// would continue.
const PROJECTIONS: usize = 3;

/// The result of a step.
pub enum Step {
    ConjugateGradient,
    Expansion,
    Proportioning,
    /// The point is optimal with this multiplier of `G x = e`, although it is not with the least-squares multiplier.
    Vertex {
        alpha: Vec<f64>,
    },
    /// theta decreases without end along `-p`: no x satisfies the constraints of the primal problem.
    Unbounded {
        p: Vec<f64>,
    },
    /// No step decreases theta.
    Stuck,
}

impl Iterate<'_> {
    /// P3 to P8 of docs/method.md: explores the current face by a conjugate gradient step if it is feasible, otherwise by
    /// an expansion. A step expected to leave the bounds is projected before its product, which then determines its
    /// length.
    pub fn explore(&mut self) -> Result<Step> {
        let p = self.direction()?;
        // P4: projection before the product
        let beyond = |t: &f64| self.feasible_step(&p, 0.0) < *t && Rung::ProjectedFirst.is_tried();
        let step = match self.expected.filter(beyond) {
            Some(t) if self.expand(&p, t)? => Step::Expansion,
            _ => self.step_along(p)?,
        };
        self.counts.conjugate_gradient += usize::from(matches!(step, Step::ConjugateGradient));
        self.counts.expansions += usize::from(matches!(step, Step::Expansion));
        self.settle()?;
        Ok(step)
    }

    /// P8: minimises theta over the stored directions, without a product: rows that meet their bound join the active set
    /// one by one.
    pub fn settle(&mut self) -> Result<()> {
        while !self.settled {
            let Some((d, image)) = self.kept.minimiser(&self.r) else { break };
            let bound = self.feasible_step(&d, 0.0);
            self.go_along(&d, &image, bound.min(1.0))?;
            self.settled = bound >= 1.0;
        }
        Ok(())
    }

    /// P3: `z = P_F M_F P_F phi`, conjugate to the stored directions; if only rounding is left, z itself, without stored
    /// directions.
    fn direction(&mut self) -> Result<Vec<f64>> {
        let mut z = self.split.free.clone();
        self.precondition(&mut z)?;
        self.project_on_face(&mut z)?;
        if !self.kept.is_empty() {
            let mut p = z.clone();
            self.kept.make_conjugate(&mut p);
            if norm(&p) > LOST * norm(&z) && dot(&self.r, &p) > 0.0 {
                return Ok(p);
            }
            self.kept.forget();
        }
        self.project_on_face(&mut z)?;
        Ok(z)
    }

    /// P5 and P6: the exact step `x - t p` if the bounds allow it. Otherwise an expansion: projected if the bounds leave
    /// too little of the step, or up to the bound.
    fn step_along(&mut self, p: Vec<f64>) -> Result<Step> {
        if norm(&p) == 0.0 {
            return Ok(Step::Stuck);
        }
        let image = self.product(&p)?;
        let curvature = dot(&p, &image);
        self.observe_curvature(&p, &image);
        // P5: no curvature
        let singular =
            norm(&self.split.free) > self.noise() && curvature <= SINGULAR * self.curvature * dot(&p, &p);
        let t = if singular { f64::INFINITY } else { dot(&self.r, &p) / curvature };
        let bound = self.feasible_step(&p, if singular { FLAT_ENTRY } else { 0.0 });
        if bound.is_infinite() && !t.is_finite() {
            return Ok(if singular { Step::Unbounded { p } } else { Step::Stuck });
        }
        let mut far = bound < CUT_SHORT * t;
        if t.is_finite() {
            far |= self.expected.replace(t).is_none();
            self.kept.push(&p, &image);
        }
        // P6
        if t <= bound {
            self.go_along(&p, &image, t)?;
            return Ok(Step::ConjugateGradient);
        }
        if far && t.is_finite() && self.expand(&p, t)? {
            return Ok(Step::Expansion);
        }
        self.go_along(&p, &image, bound)?;
        Ok(Step::Expansion)
    }

    /// P7: the projected step towards `y = PROJ_face(x - t p)`, with one product: the full step if theta falls that far,
    /// otherwise the part that minimises theta. Returns false without a change if it does not lead downwards.
    fn expand(&mut self, p: &[f64], t: f64) -> Result<bool> {
        let mut y = self.x.clone();
        axpy(-t, p, &mut y);
        let Some(projected) = project(&self.qp, &mut self.coarse, &y, &self.split.active)? else {
            return Ok(false);
        };
        let s = difference(&projected.point, &self.x);
        let slope = dot(&self.r, &s);
        if slope >= 0.0 {
            return Ok(false);
        }
        let image = self.product(&s)?;
        self.observe_curvature(&s, &image);
        let curvature = dot(&s, &image);
        let flat = curvature <= SINGULAR * self.curvature * dot(&s, &s);
        let best = if flat { f64::INFINITY } else { -slope / curvature };
        let cut = best <= 0.5;
        self.cut = cut;
        let length = if cut { best } else { 1.0 };
        self.expected = Some(t * if cut { best } else { best.clamp(1.0, 2.0) });
        let (mut x, mut g) = (projected.point, self.g.clone());
        if cut {
            x.clone_from(&self.x);
            axpy(best, &s, &mut x);
        }
        axpy(length, &image, &mut g);
        self.drift.add(length, &image);
        self.keep(&s, &image);
        self.settled = false;
        self.move_to(x, g)?;
        Ok(true)
    }

    /// P7.3: stores the direction of a projected step, unless the step is so short that rounding has moved it out of the
    /// kernel of G.
    fn keep(&mut self, s: &[f64], image: &[f64]) {
        if norm(s) > SHORT_STEP * norm(&self.x) {
            self.kept.push(s, image);
        }
    }

    /// P3: `p <- M_F p`, if that is a descent direction.
    fn precondition(&mut self, p: &mut [f64]) -> Result<()> {
        let Some(preconditioner) = self.qp.preconditioner else { return Ok(()) };
        let mut z = vec![0.0; p.len()];
        preconditioner.apply(&self.split.active, p, &mut z)?;
        self.counts.preconditioned += 1;
        if dot(&z, p) > 0.0 {
            p.copy_from_slice(&z);
        }
        Ok(())
    }

    /// `L = max(L, 1.1 p'A p / p'p)`, p in the kernel of G, while the gradient is above rounding.
    fn observe_curvature(&mut self, p: &[f64], image: &[f64]) {
        let energy = dot(p, image);
        if self.split.norm() > self.noise() && energy > 0.0 {
            self.curvature = self.curvature.max(CURVATURE_MARGIN * energy / dot(p, p));
            self.observed = Some((energy, image.to_vec()));
        }
    }

    /// `L = max(L, 1.1 |P A p|^2 / p'A p)` for the last p observed: closer to the largest curvature, at the cost of one
    /// coarse solve.
    fn sharpen_curvature(&mut self) -> Result<()> {
        if let Some((energy, mut image)) = self.observed.take().filter(|(energy, _)| *energy > 0.0) {
            self.coarse.project(&vec![false; image.len()], &mut image)?;
            self.curvature = self.curvature.max(CURVATURE_MARGIN * dot(&image, &image) / energy);
        }
        Ok(())
    }

    /// P6, P8: `x - t p`; rows that meet their bound there are set to exactly 0.
    fn go_along(&mut self, p: &[f64], image: &[f64], t: f64) -> Result<()> {
        let (mut x, mut g) = (std::mem::take(&mut self.x), std::mem::take(&mut self.g));
        for i in 0..x.len() {
            let y = x[i] - t * p[i];
            let hits =
                self.qp.bounded[i] && !self.split.active[i] && p[i] > 0.0 && y <= 256.0 * f64::EPSILON * x[i];
            x[i] = if hits { 0.0 } else { y };
        }
        axpy(-t, image, &mut g);
        self.drift.add(t, image);
        self.move_to(x, g)
    }

    /// P9, and P10 after a cut or if P9 does not lead downwards: active rows with a negative multiplier leave the active
    /// set. `small`: length below which a projected gradient counts as zero.
    pub fn proportion(&mut self, small: f64) -> Result<Step> {
        let step = if std::mem::take(&mut self.cut) || !Rung::PullAll.is_tried() {
            None
        } else {
            self.free_pulling(small)?
        };
        let step = step.map_or_else(|| self.project_gradient(small), Ok)?;
        self.counts.releases += usize::from(matches!(step, Step::Proportioning));
        self.settle()?;
        Ok(step)
    }

    /// P9: all rows with a negative multiplier leave the active set, and the face is explored with them: if the direction
    /// presses some of them against the bound, it is projected. `None` without a change if it does not lead downwards,
    /// which is always so if `G x = e` permits no motion on that face, whose gradient is then `small`.
    fn free_pulling(&mut self, small: f64) -> Result<Option<Step>> {
        let before = (self.split.clone(), self.alpha.clone(), self.r.clone());
        (0..self.x.len()).for_each(|i| self.split.active[i] &= self.split.chopped[i] == 0.0);
        self.update_on_face()?;
        if norm(&self.split.free) <= small {
            (self.split, self.alpha, self.r) = before;
            return Ok(None);
        }
        let p = self.direction()?;
        let pressed = (0..p.len()).any(|i| before.0.active[i] && !self.split.active[i] && p[i] > 0.0);
        let length = self.expected.filter(|t| pressed || self.feasible_step(&p, 0.0) < *t);
        // a preconditioned direction has a natural length; any other length must have been measured
        let own = (pressed && self.qp.preconditioner.is_some()).then_some(1.0);
        let step = match length.or(own) {
            Some(t) if self.expand(&p, t)? => Step::Proportioning,
            None if !pressed => self.step_along(p)?,
            _ => Step::Stuck,
        };
        match step {
            Step::Stuck => {
                (self.split, self.alpha, self.r) = before;
                Ok(None)
            }
            Step::Unbounded { .. } => Ok(Some(step)),
            _ => Ok(Some(Step::Proportioning)),
        }
    }

    /// P10: gradient projection on the whole feasible set, with an exact line search.
    fn project_gradient(&mut self, small: f64) -> Result<Step> {
        if self.curvature == 0.0 {
            // r of an open row is its gap and says nothing about A
            let projected: Vec<f64> =
                self.split.free.iter().zip(&self.split.chopped).map(|(f, c)| f + c).collect();
            let image = self.product(&projected)?;
            self.observed = Some((dot(&projected, &image), image));
        }
        self.sharpen_curvature()?;
        // without curvature the length is arbitrary
        let step = if self.curvature > 0.0 { GRADIENT_STEP / self.curvature } else { 1.0 };
        let mut y = self.x.clone();
        axpy(-step, &self.r, &mut y);
        let none = vec![false; y.len()];
        let Some(projected) = project(&self.qp, &mut self.coarse, &y, &none)? else { return Ok(Step::Stuck) };
        let s = difference(&projected.point, &self.x);
        let mut alpha = self.alpha.clone();
        axpy(1.0 / step, &projected.multiplier, &mut alpha);
        self.projections += 1;
        if self.projections > PROJECTIONS && Rung::Reference.is_tried() {
            self.reference = Some(alpha.clone());
        }
        if norm(&s) <= small * step {
            let g = std::mem::take(&mut self.g);
            self.move_to(projected.point, g)?; // rows that are zero up to rounding become active
            return Ok(Step::Vertex { alpha });
        }
        self.search_along(s)
    }

    /// P11: exact minimum of theta over `x + t s`, t in [0, max(1, first bound)].
    fn search_along(&mut self, s: Vec<f64>) -> Result<Step> {
        let image = self.product(&s)?;
        self.observe_curvature(&s, &image);
        let (slope, curvature) = (dot(&self.r, &s), dot(&s, &image));
        if slope >= 0.0 {
            return Ok(Step::Stuck);
        }
        let p: Vec<f64> = s.iter().map(|s| -s).collect();
        let bound = feasible_step(&self.x, &p, |i| self.qp.bounded[i]);
        let flat = curvature <= SINGULAR * self.curvature * dot(&s, &s);
        if flat && bound.is_infinite() {
            return Ok(Step::Unbounded { p });
        }
        let minimum = if flat { f64::INFINITY } else { -slope / curvature };
        // the full step if theta falls that far and projections continue: rows then reach their bound
        let t = if self.reference.is_some() && (0.5..1.0).contains(&minimum) {
            1.0
        } else {
            minimum.min(bound.max(1.0))
        };
        let (mut x, mut g) = (std::mem::take(&mut self.x), std::mem::take(&mut self.g));
        axpy(t, &s, &mut x);
        axpy(t, &image, &mut g);
        self.drift.add(t, &image);
        let smallest = NO_FORCE * crate::linalg::vector::norm_max(&x);
        for (x, bounded) in x.iter_mut().zip(self.qp.bounded) {
            if *bounded && *x <= smallest {
                *x = 0.0;
            }
        }
        self.keep(&s, &image);
        self.settled = false;
        self.move_to(x, g)?;
        Ok(Step::Proportioning)
    }
}

/// `a - b`
fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
