//! What Algorithm 1 does where a conjugate gradient step leaves the bounds (end of Section 4): three variants.

use crate::error::Result;
use crate::linalg::vector::axpy;
use crate::qp::paper::bound::{projection, Face, Proportioning};

/// Trial steps of the extrapolating variant at most.
const TRIALS: usize = 20;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Feasible proportioning: stop at the first bound.
    Feasible,
    /// Monotone proportioning: go on while theta(Py) does not rise, many indices join at once.
    Monotone,
    /// Projected extrapolation, as in box-QUACAN: steps ever longer beyond the first bound, projected.
    Extrapolating,
}

impl Proportioning<'_, '_> {
    /// The step to `y = y^i - a p` from y^i leaves the bounds; `image` = H p.
    pub(super) fn beyond_a_bound(&mut self, face: Face, a: f64, y: Vec<f64>, image: Vec<f64>) -> Result<()> {
        match self.rule.variant {
            Variant::Feasible => {
                self.feasible_step(&face, &image);
                Ok(())
            }
            Variant::Extrapolating => self.extrapolate(&face, &image),
            Variant::Monotone => self.monotone_step(face, a, y, &image),
        }
    }

    /// `x^{k+1} = y^{i-1} - a~ p`, a~ the largest feasible step (corrected index): the active set grows. Gives a~.
    fn feasible_step(&mut self, face: &Face, image: &[f64]) -> f64 {
        let bounded = self.q.qp.bounded;
        let hits = |i: &usize| bounded[*i] && face.p[*i] > 0.0;
        let step =
            (0..face.y.len()).filter(hits).map(|i| face.y[i] / face.p[i]).fold(f64::INFINITY, f64::min);
        let (mut x, mut g) = (face.y.clone(), face.g.clone());
        for (i, x) in x.iter_mut().enumerate() {
            let reached = hits(&i) && *x <= step * face.p[i];
            *x = if reached { 0.0 } else { *x - step * face.p[i] };
        }
        axpy(-step, image, &mut g);
        self.point.move_to(x, g);
        step
    }

    /// From the first bound on, trials at `extrapolation`, `extrapolation^2`, ... times the step to it,
    /// projected, until theta rises; every trial takes a product.
    fn extrapolate(&mut self, face: &Face, image: &[f64]) -> Result<()> {
        let mut step = self.feasible_step(face, image);
        let mut lowest = self.q.value(&self.point.x, &self.point.g);
        for _ in 0..TRIALS {
            step *= self.rule.extrapolation;
            let mut y = face.y.clone();
            axpy(-step, &face.p, &mut y);
            let y = projection(self.q.qp.bounded, y);
            if y == self.point.x {
                break;
            }
            let g = self.q.gradient(&y)?;
            let value = self.q.value(&y, &g);
            if value.is_nan() || value >= lowest {
                break;
            }
            lowest = value;
            self.point.move_to(y, g);
        }
        Ok(())
    }

    /// `Py^{i+1}` while theta does not rise, and conjugate gradients go on from y^{i+1} outside the bounds. Where it
    /// rises, x^{k+1} = Py^i; at the very first step of a face, which would leave x^k as it is, the feasible step.
    fn monotone_step(&mut self, mut face: Face, a: f64, y: Vec<f64>, image: &[f64]) -> Result<()> {
        let projected = projection(self.q.qp.bounded, y.clone());
        let g = self.q.gradient(&projected)?;
        let before = self.q.value(&self.point.x, &self.point.g);
        if self.q.value(&projected, &g) <= before {
            self.point.move_to(projected, g);
            face.feasible = false;
            self.face = face.advance(a, y, image).then_some(face);
        } else if face.feasible {
            self.feasible_step(&face, image);
        }
        Ok(())
    }
}
