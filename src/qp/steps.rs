//! The three steps: conjugate gradients on the face, expansion of the active set, release from it.

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm};
use crate::qp::iterate::Iterate;
use crate::qp::projection::project;

/// Curvature below this fraction of L counts as none.
const SINGULAR: f64 = 1e-11;
/// An entry of a direction without curvature below this fraction of the largest is rounding: without it, such
/// a direction would always seem to end somewhere far away.
const ROUNDING: f64 = 1e-10;
/// Step of gradient projection in units of 1 / L.
const GRADIENT_STEP: f64 = 1.5;

/// What a step came to.
pub enum Step {
    ConjugateGradient,
    Expansion,
    Release,
    /// The point is optimal with this multiplier of `G x = e`, where the least-squares one is not.
    Vertex {
        alpha: Vec<f64>,
    },
    /// theta falls without end along `-p`: no x satisfies the constraints of the primal problem.
    Unbounded {
        p: Vec<f64>,
    },
    /// No step decreases theta.
    Stuck,
}

impl Iterate<'_> {
    /// Explores the current face: a conjugate gradient step where it stays feasible, else an expansion.
    pub fn explore(&mut self) -> Result<Step> {
        let (p, image) = self.direction()?;
        let curvature = dot(&p, &image);
        self.observe_curvature(&p, &image)?;
        let singular =
            norm(&self.free) > self.noise() && curvature <= SINGULAR * self.curvature * dot(&p, &p);
        let t = if singular { f64::INFINITY } else { dot(&self.g, &p) / curvature };
        let bound = self.feasible_step(&p, if singular { ROUNDING } else { 0.0 });
        if t <= bound && t.is_finite() {
            let (mut x, mut g) = (std::mem::take(&mut self.x), std::mem::take(&mut self.g));
            axpy(-t, &p, &mut x);
            axpy(-t, &image, &mut g);
            self.conjugate = Some((p, image));
            self.move_to(x, g)?;
            self.counts.conjugate_gradient += 1;
            return Ok(Step::ConjugateGradient);
        }
        if bound.is_infinite() {
            return Ok(if singular { Step::Unbounded { p } } else { Step::Stuck });
        }
        self.conjugate = None;
        self.counts.expansions += 1;
        if t.is_finite() && self.accept_projected(&p, t, false)? {
            return Ok(Step::Expansion);
        }
        self.stop_at_bound(&p, &image, bound)?;
        if self.curvature > 0.0 {
            let free = self.free.clone();
            self.accept_projected(&free, GRADIENT_STEP / self.curvature, true)?;
        }
        Ok(Step::Expansion)
    }

    /// `p = z - (z'A p_old / p_old'A p_old) p_old` with `z = P_F M_F P_F phi`, and A p.
    fn direction(&mut self) -> Result<(Vec<f64>, Vec<f64>)> {
        let mut p = self.free.clone();
        self.precondition(&mut p)?;
        self.project_on_face(&mut p)?;
        if let Some((old, image)) = self.conjugate.take() {
            let beta = dot(&p, &image) / dot(&old, &image);
            axpy(-beta, &old, &mut p);
        }
        let image = self.product(&p)?;
        Ok((p, image))
    }

    /// `p <- M_F p`, as long as that is a direction of descent.
    fn precondition(&mut self, p: &mut [f64]) -> Result<()> {
        let Some(preconditioner) = self.qp.preconditioner else { return Ok(()) };
        let mut z = vec![0.0; p.len()];
        preconditioner.apply(&self.active, p, &mut z)?;
        self.counts.preconditioned += 1;
        if dot(&z, p) > 0.0 {
            p.copy_from_slice(&z);
        }
        Ok(())
    }

    /// `L = max(L, 1.1 |P A p|^2 / p'A p)`, while the gradient is more than rounding.
    fn observe_curvature(&mut self, p: &[f64], image: &[f64]) -> Result<()> {
        let energy = dot(p, image);
        if self.residual() > self.noise() && energy > 0.0 {
            let mut projected = image.to_vec();
            let none = vec![false; p.len()];
            self.coarse.project(&none, &mut projected)?;
            self.curvature = self.curvature.max(1.1 * dot(&projected, &projected) / energy);
        }
        Ok(())
    }

    /// Moves to `y = PROJ_face(x - t p)` when theta falls (or, `or_equal`, does not rise).
    fn accept_projected(&mut self, p: &[f64], t: f64, or_equal: bool) -> Result<bool> {
        let mut y = self.x.clone();
        axpy(-t, p, &mut y);
        let Some(projected) = project(&self.qp, &mut self.coarse, &y, &self.active)? else {
            return Ok(false);
        };
        let y = projected.point;
        let mut g = self.product(&y)?;
        axpy(-1.0, self.qp.b, &mut g);
        // accepted or not, the trial tells how curved theta is
        self.observe_curvature(&difference(&y, &self.x), &difference(&g, &self.g))?;
        let increase = self.increase(&y, &g);
        let accepted = increase < 0.0 || (or_equal && increase == 0.0);
        if accepted {
            self.move_to(y, g)?;
        }
        Ok(accepted)
    }

    /// `x - t p` for the largest feasible t; the rows that meet their bound there are set to exactly 0.
    fn stop_at_bound(&mut self, p: &[f64], image: &[f64], t: f64) -> Result<()> {
        let (mut x, mut g) = (std::mem::take(&mut self.x), std::mem::take(&mut self.g));
        for i in 0..x.len() {
            let hits = self.qp.bounded[i] && !self.active[i] && p[i] > 0.0 && x[i] <= t * p[i];
            x[i] = if hits { 0.0 } else { x[i] - t * p[i] };
        }
        axpy(-t, image, &mut g);
        self.move_to(x, g)
    }

    /// Gradient projection on the whole feasible set, with an exact line search: rows leave the active set.
    /// `small` is the length of a projected gradient that counts as zero.
    pub fn release(&mut self, small: f64) -> Result<Step> {
        if self.curvature == 0.0 {
            let r = self.r.clone();
            let image = self.product(&r)?;
            self.observe_curvature(&r, &image)?;
        }
        // without curvature any length will do
        let step = if self.curvature > 0.0 { GRADIENT_STEP / self.curvature } else { 1.0 };
        let mut y = self.x.clone();
        axpy(-step, &self.r, &mut y);
        let none = vec![false; y.len()];
        let Some(projected) = project(&self.qp, &mut self.coarse, &y, &none)? else { return Ok(Step::Stuck) };
        let s: Vec<f64> = projected.point.iter().zip(&self.x).map(|(y, x)| y - x).collect();
        if norm(&s) <= small * step {
            let mut alpha = self.alpha.clone();
            axpy(1.0 / step, &projected.multiplier, &mut alpha);
            let g = std::mem::take(&mut self.g);
            self.move_to(projected.point, g)?; // rows that are zero but for rounding become active
            return Ok(Step::Vertex { alpha });
        }
        self.search_along(s)
    }

    /// Exact minimum of theta over `x + t s`, t in [0, max(1, first bound)].
    fn search_along(&mut self, s: Vec<f64>) -> Result<Step> {
        let image = self.product(&s)?;
        self.observe_curvature(&s, &image)?;
        let (slope, curvature) = (dot(&self.g, &s), dot(&s, &image));
        if slope >= 0.0 {
            return Ok(Step::Stuck);
        }
        let bound = (0..s.len())
            .filter(|&i| self.qp.bounded[i] && s[i] < 0.0)
            .map(|i| -self.x[i] / s[i])
            .fold(f64::INFINITY, f64::min);
        let flat = curvature <= SINGULAR * self.curvature * dot(&s, &s);
        if flat && bound.is_infinite() {
            return Ok(Step::Unbounded { p: s.into_iter().map(|s| -s).collect() });
        }
        let minimum = if flat { f64::INFINITY } else { -slope / curvature };
        let t = minimum.min(bound.max(1.0));
        let (mut x, mut g) = (std::mem::take(&mut self.x), std::mem::take(&mut self.g));
        axpy(t, &s, &mut x);
        axpy(t, &image, &mut g);
        let smallest = 1e-15 * crate::linalg::vector::norm_max(&x);
        for (x, bounded) in x.iter_mut().zip(self.qp.bounded) {
            if *bounded && *x <= smallest {
                *x = 0.0;
            }
        }
        self.conjugate = None;
        self.counts.releases += 1;
        self.move_to(x, g)?;
        Ok(Step::Release)
    }
}

/// `a - b`
fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
