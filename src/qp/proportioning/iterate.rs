//! The current point, its gradient and its parts on the face: Section 4 on the feasible set of (12).

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm, norm_max, ratio};
use crate::numbers::qp::FAR_AWAY;
use crate::qp::coarse::Coarse;
use crate::qp::conjugate::Conjugate;
use crate::qp::gradient::{feasible_step, Split};
use crate::qp::proportioning::drift::Drift;
use crate::qp::{Counts, Qp};

pub struct Iterate<'a> {
    pub qp: Qp<'a>,
    pub coarse: Coarse<'a>,
    /// x, feasible.
    pub x: Vec<f64>,
    /// `g = A x - b`
    pub g: Vec<f64>,
    /// Least-squares multiplier of `G x = e` on the face: `argmin |g_F - G_F'alpha|`.
    pub alpha: Vec<f64>,
    /// A multiplier of the last gradient projection, which gives the part of alpha along free motions.
    pub reference: Option<Vec<f64>>,
    /// Gradient projections so far.
    pub projections: usize,
    /// `r = g - G'alpha`
    pub r: Vec<f64>,
    /// (21), and r in its parts (22), (23).
    pub split: Split,
    /// Directions of the steps so far that lie on this face.
    pub kept: Conjugate,
    /// theta is minimal along the stored directions.
    pub settled: bool,
    /// Expected length of the next step along a preconditioned gradient: that of the previous step.
    pub expected: Option<f64>,
    /// The last projected step was cut short.
    pub cut: bool,
    /// L: running upper estimate of the curvature of theta.
    pub curvature: f64,
    /// `p'A p` and A p of the last product that was used for L.
    pub observed: Option<(f64, Vec<f64>)>,
    /// A point and its product with A, where products were approximate since.
    exact: Option<(Vec<f64>, Vec<f64>)>,
    /// Possible error of the updates of g relative to A x - b.
    pub drift: Drift,
    pub counts: Counts,
}

impl<'a> Iterate<'a> {
    pub fn new(qp: Qp<'a>, coarse: Coarse<'a>, x: Vec<f64>) -> Result<Self> {
        let m = x.len();
        let mut iterate = Self {
            g: vec![0.0; m],
            alpha: vec![0.0; qp.e.len()],
            reference: None,
            projections: 0,
            r: vec![0.0; m],
            split: Split::of(vec![false; m]),
            kept: Conjugate::default(),
            settled: true,
            expected: None,
            cut: false,
            curvature: 0.0,
            observed: None,
            exact: None,
            drift: Drift::default(),
            counts: Counts::default(),
            qp,
            coarse,
            x,
        };
        let x = std::mem::take(&mut iterate.x);
        let image = iterate.product(&x)?;
        iterate.drift.add(1.0, &image);
        (iterate.x, iterate.g) = (x, image);
        axpy(-1.0, qp.b, &mut iterate.g);
        iterate.update()?;
        Ok(iterate)
    }

    /// `A v`, or an approximation, counted. If A refuses the product, the iterate is unchanged: callers compute the
    /// product first.
    pub fn product(&mut self, v: &[f64]) -> Result<Vec<f64>> {
        let mut image = vec![0.0; v.len()];
        self.qp.a.approximate(v, &mut image)?;
        self.counts.products += 1;
        Ok(image)
    }

    /// Recomputes the gradient from x, without the errors of its updates. If products were approximate, theta is then not
    /// minimal along the stored directions, to which later directions are conjugate.
    pub fn refresh(&mut self) -> Result<()> {
        let mut g = vec![0.0; self.x.len()];
        match &self.exact {
            Some((from, image)) => {
                let step: Vec<f64> = self.x.iter().zip(from).map(|(x, from)| x - from).collect();
                let share = ratio(norm(&step), norm(&self.x)).clamp(f64::MIN_POSITIVE, 1.0);
                self.qp.a.apply_to_share(share, &step, &mut g)?;
                axpy(1.0, image, &mut g);
            }
            None => self.qp.a.try_apply(&self.x, &mut g)?,
        }
        self.counts.products += 1;
        if self.qp.a.has_approximation() {
            self.exact = Some((self.x.clone(), g.clone()));
        }
        axpy(-1.0, self.qp.b, &mut g);
        self.g = g;
        let before = self.r.clone();
        self.update()?;
        let errors = (0..before.len()).filter(|&i| !self.split.active[i]).map(|i| self.r[i] - before[i]);
        self.drift.measured(norm(&errors.collect::<Vec<_>>()), self.counts.steps());
        self.settled &= !self.qp.a.has_approximation();
        self.settle()
    }

    /// S6.3: the multiple of x with the least theta: forces of far larger loads leave their rounding.
    pub fn scale(&mut self) -> Result<()> {
        let image: Vec<f64> = self.g.iter().zip(self.qp.b).map(|(g, b)| g + b).collect();
        let t = ratio(dot(self.qp.b, &self.x), dot(&image, &self.x)).max(0.0);
        if !t.is_finite() {
            return Ok(());
        }
        self.drift = Drift::default();
        self.drift.add(t, &image);
        self.x.iter_mut().for_each(|x| *x *= t);
        self.g = image.iter().zip(self.qp.b).map(|(image, b)| t * image - b).collect();
        self.update()
    }

    /// Uses directions of an earlier solve on this face, if theta is not minimal along them.
    pub fn go_on_with(&mut self, mut directions: Conjugate) -> Result<()> {
        let held = (0..self.x.len()).filter(|&i| self.split.active[i] && directions.moves(i));
        held.collect::<Vec<_>>().into_iter().for_each(|i| directions.hold(i));
        (self.kept, self.settled) = (directions, false);
        self.settle()
    }

    /// P0: recomputes the gradient if the error of its updates by approximate products may matter.
    pub fn refresh_if_stale(&mut self, small: f64) -> Result<()> {
        let counts = self.split.norm().max(small);
        if self.qp.a.has_approximation() && self.drift.is_felt(counts, self.counts.steps()) {
            self.refresh()?;
        }
        Ok(())
    }

    /// Moves to the point `x` with its gradient; directions that leave the new face are dropped.
    pub fn move_to(&mut self, x: Vec<f64>, g: Vec<f64>) -> Result<()> {
        (self.x, self.g) = (x, g);
        let before = self.split.active.clone();
        self.update()?;
        for i in (0..before.len()).filter(|&i| self.split.active[i] && !before[i]) {
            self.kept.hold(i);
            self.settled = false;
        }
        Ok(())
    }

    /// Removes the accumulated rounding of `e - G x` on the free rows; the change is too small to affect the gradient.
    pub fn rebalance(&mut self) -> Result<()> {
        if self.alpha.is_empty() {
            return Ok(());
        }
        let left = self.coarse.left(self.qp.e, &self.x);
        let step = self.coarse.on(&self.split.active)?.solve(&left)?;
        let (mut x, rows) = (self.x.clone(), self.coarse.rows());
        rows.change_rows(&mut x, |i, x| {
            if !self.split.active[i] {
                *x += rows.row_dot(i, &step);
            }
        });
        if (0..x.len()).all(|i| self.split.active[i] || !self.qp.bounded[i] || x[i] > 0.0) {
            self.x = x;
        }
        Ok(())
    }

    /// Active set, multiplier and the two parts (22)-(23) of the projected gradient.
    fn update(&mut self) -> Result<()> {
        self.split.active = self.qp.at_bound(&self.x);
        self.update_on_face()
    }

    /// As `update`, for the present active set: rows at zero may count as free.
    pub fn update_on_face(&mut self) -> Result<()> {
        if self.alpha.is_empty() {
            self.r.copy_from_slice(&self.g);
        } else {
            // free rows do not depend on free motions, and must not get their rounding errors
            let (fitted, rest) = self.coarse.fitted(&self.split.active, &self.g)?;
            (self.alpha, self.r) = (fitted.clone(), rest);
            if let Some(reference) = &self.reference {
                let mut free = vec![0.0; fitted.len()];
                self.coarse.on(&self.split.active)?.add_free_part(reference, &mut free);
                if norm(&free) <= FAR_AWAY * norm(&fitted) {
                    axpy(1.0, &free, &mut self.alpha);
                }
            }
            for i in (0..self.x.len()).filter(|&i| self.split.active[i]) {
                self.r[i] = self.g[i] - self.coarse.rows().row_dot(i, &self.alpha);
            }
        }
        self.split.update_on_face(&self.r);
        Ok(())
    }

    /// `v <- P_F v`
    pub fn project_on_face(&mut self, v: &mut [f64]) -> Result<()> {
        self.coarse.project(&self.split.active, v)
    }

    /// Rounding of the residual: 64 eps (|b| + |A x| + |G'alpha|) on the rows that it includes. Open rows are not
    /// included, however large their gaps are.
    pub fn noise(&self) -> f64 {
        let counts = |i: &usize| !self.split.active[*i] || self.split.chopped[*i] < 0.0;
        let (mut given, mut image, mut coarse) = (0.0, 0.0, 0.0);
        for i in (0..self.g.len()).filter(counts) {
            given += self.qp.b[i] * self.qp.b[i];
            image += (self.g[i] + self.qp.b[i]) * (self.g[i] + self.qp.b[i]);
            coarse += (self.g[i] - self.r[i]) * (self.g[i] - self.r[i]);
        }
        64.0 * f64::EPSILON * (given.sqrt() + f64::sqrt(image) + f64::sqrt(coarse))
    }

    /// `(x'A x)^1/2`, the energy norm
    pub fn energy(&self) -> f64 {
        let image = self.g.iter().zip(self.qp.b).map(|(g, b)| g + b);
        self.x.iter().zip(image).map(|(x, image)| x * image).sum::<f64>().max(0.0).sqrt()
    }

    /// `theta(x) = 1/2 x'A x - b'x`
    pub fn theta(&self) -> f64 {
        0.5 * self.x.iter().zip(self.g.iter().zip(self.qp.b)).map(|(x, (g, b))| x * (g - b)).sum::<f64>()
    }

    /// Largest t with `x - t p` feasible in the bounds; entries of p up to `rounding` |p| count as zero.
    pub fn feasible_step(&self, p: &[f64], rounding: f64) -> f64 {
        let zero = rounding * norm_max(p);
        feasible_step(&self.x, p, |i| self.qp.bounded[i] && !self.split.active[i] && p[i] > zero)
    }
}
