//! Algorithm 1, the general proportioning scheme, for (19): theta(x) -> min subject to x_i >= 0 (i bounded).

use super::face::PaperFace;
use super::variants::{extrapolate, feasible, monotone, Moved};
use super::{Quadratic, Variant};
use feti_contact::error::Result;
use feti_contact::linalg::vector::{axpy, dot};
use feti_contact::qp::{at_bound, Split};
use feti_contact::qp::{Counts, StepKind};

/// Curvature counts as zero below this part of the largest curvature so far.
const FLAT: f64 = 1e-15;

/// A point x >= 0 with its gradient and the two parts (22) and (23).
pub struct Point<'a> {
    bounded: &'a [bool],
    pub x: Vec<f64>,
    /// g(x)
    pub g: Vec<f64>,
    /// A(x), g^I and g^C, the unbalanced contact gradient.
    pub split: Split,
}

impl<'a> Point<'a> {
    fn new(bounded: &'a [bool], x: Vec<f64>, g: Vec<f64>) -> Self {
        let mut split = Split::of(at_bound(bounded, &x));
        split.update_on_face(&g);
        Self { bounded, x, g, split }
    }

    fn is_feasible(&self, y: &[f64]) -> bool {
        y.iter().zip(self.bounded).all(|(y, bounded)| !bounded || *y >= 0.0)
    }

    fn move_to(&mut self, x: Vec<f64>, g: Vec<f64>) {
        (self.x, self.g) = (x, g);
        self.split.update(at_bound(self.bounded, &self.x), &self.g);
    }

    /// Conjugate gradients from this point, on the face I = A(x).
    fn face(&self) -> PaperFace {
        PaperFace::new(self.x.clone(), self.g.clone(), self.split.active.clone(), self.split.free.clone())
    }
}

/// Parameters of Algorithm 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperRule {
    /// Gamma > 0 of the proportionality test.
    pub gamma: f64,
    pub variant: Variant,
    /// Factor > 1 between successive trial steps of the extrapolating variant.
    pub extrapolation: f64,
}

/// The result of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BoundStep {
    /// A conjugate gradient step, a step that met a bound, or a proportioning step.
    Done(StepKind),
    /// theta has no curvature along the direction.
    Flat,
}

/// A run of Algorithm 1.
pub struct Proportioning<'a, 'q> {
    pub q: &'q mut Quadratic<'a>,
    pub point: Point<'a>,
    pub rule: PaperRule,
    pub counts: Counts,
    /// The step that led to the point.
    pub last: StepKind,
    face: Option<PaperFace>,
    largest_curvature: f64,
}

impl<'a, 'q> Proportioning<'a, 'q> {
    /// Starts at the feasible point nearest to `start`, with one product for its gradient.
    pub fn new(q: &'q mut Quadratic<'a>, start: Vec<f64>, rule: PaperRule) -> Result<Self> {
        let x = q.projection(start);
        let g = q.gradient(&x)?;
        let point = Point::new(q.qp.bounded, x, g);
        let (counts, last) = (Counts::default(), StepKind::Proportioning);
        Ok(Self { q, point, rule, counts, last, face: None, largest_curvature: 0.0 })
    }

    /// Algorithm 1 on (19) until `enough` returns true: (i) proportioning if the point is not proportional, (ii)
    /// otherwise a step towards the minimum on the face. False if it ended because theta has no curvature.
    pub fn run(&mut self, enough: &mut dyn FnMut(&Self) -> Result<bool>) -> Result<bool> {
        while !enough(self)? {
            let step = if self.explores() { self.explore()? } else { self.proportion()? };
            match step {
                BoundStep::Flat => return Ok(false),
                BoundStep::Done(kind) => self.count(kind),
            }
        }
        Ok(true)
    }

    /// Infeasible conjugate gradients of the monotone variant continue until theta(Py) rises.
    fn explores(&self) -> bool {
        self.face.as_ref().is_some_and(|face| !face.feasible)
            || self.point.split.is_proportional(self.rule.gamma)
    }

    /// Proportioning: the exact minimum along `d = -g^C` removes indices from the active set.
    fn proportion(&mut self) -> Result<BoundStep> {
        self.face = None;
        let image = self.q.product(&self.point.split.chopped)?;
        let Some(a) = self.minimum_along(&self.point.split.chopped.clone(), &image) else {
            return Ok(BoundStep::Flat);
        };
        let (mut x, mut g) = (self.point.x.clone(), self.point.g.clone());
        axpy(-a, &self.point.split.chopped, &mut x);
        axpy(-a, &image, &mut g);
        self.point.move_to(x, g);
        Ok(BoundStep::Done(StepKind::Proportioning))
    }

    /// One conjugate gradient step on the face; the variant determines what happens at its bounds.
    fn explore(&mut self) -> Result<BoundStep> {
        let mut face = self.face.take().unwrap_or_else(|| self.point.face());
        let image = self.q.product(&face.p)?;
        let curvature = self.curvature(&face.p, &image);
        let Some(curvature) = curvature else { return Ok(BoundStep::Flat) };
        let a = face.square / curvature;
        let mut y = face.y.clone();
        axpy(-a, &face.p, &mut y);
        if !self.point.is_feasible(&y) {
            return self.beyond_a_bound(face, a, y, &image).map(|()| BoundStep::Done(StepKind::Expansion));
        }
        let left = face.advance(a, y, &image);
        face.feasible = true;
        self.point.move_to(face.y.clone(), face.g.clone());
        self.face = Some(face).filter(|face| left && face.held == self.point.split.active);
        Ok(BoundStep::Done(StepKind::ConjugateGradient))
    }

    /// Handles a step from y^i to `y = y^i - a p` that leaves the bounds; `image` = H p.
    fn beyond_a_bound(&mut self, face: PaperFace, a: f64, y: Vec<f64>, image: &[f64]) -> Result<()> {
        let bounded = self.q.qp.bounded;
        match self.rule.variant {
            Variant::Feasible => self.take(feasible(bounded, &face, image).0),
            Variant::Extrapolating => {
                let (mut moved, step) = feasible(bounded, &face, image);
                let outcome = extrapolate(self.q, &face, step, self.rule.extrapolation, &mut moved);
                // if a product fails, the points before it remain valid
                self.take(moved);
                outcome?;
            }
            Variant::Monotone => {
                let at = (self.point.x.as_slice(), self.point.g.as_slice());
                if let Some(moved) = monotone(self.q, at, face, (a, y), image)? {
                    self.take(moved);
                }
            }
        }
        Ok(())
    }

    fn take(&mut self, Moved { x, g, face }: Moved) {
        self.point.move_to(x, g);
        self.face = face;
    }

    fn minimum_along(&mut self, p: &[f64], image: &[f64]) -> Option<f64> {
        self.curvature(p, image).map(|curvature| dot(&self.point.g, p) / curvature)
    }

    /// `p'H p`, none if it counts as zero.
    fn curvature(&mut self, p: &[f64], image: &[f64]) -> Option<f64> {
        let (curvature, square) = (dot(p, image), dot(p, p));
        let relative = curvature / square;
        self.largest_curvature = self.largest_curvature.max(relative);
        (relative > FLAT * self.largest_curvature).then_some(curvature)
    }

    fn count(&mut self, kind: StepKind) {
        self.last = kind;
        self.counts.products = self.q.products;
        match kind {
            StepKind::ConjugateGradient => self.counts.conjugate_gradient += 1,
            StepKind::Expansion => self.counts.expansions += 1,
            StepKind::Proportioning => self.counts.releases += 1,
            StepKind::Newton => self.counts.newton += 1,
        }
    }
}
