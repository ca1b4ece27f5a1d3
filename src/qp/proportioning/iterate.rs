//! The current point, its gradient and its parts on the face: Section 4 on the feasible set of (12).

use crate::error::Result;
use crate::linalg::vector::{axpy, norm, norm_max};
use crate::qp::coarse::Coarse;
use crate::qp::conjugate::Conjugate;
use crate::qp::gradient::{feasible_step, Split};
use crate::qp::proportioning::drift::Drift;
use crate::qp::{Counts, Qp};

/// Free motions that go so many times as far as all others follow from a load that is all but not held.
const FAR_AWAY: f64 = 1e6;

pub struct Iterate<'a> {
    pub qp: Qp<'a>,
    pub coarse: Coarse<'a>,
    /// x, feasible.
    pub x: Vec<f64>,
    /// `g = A x - b`
    pub g: Vec<f64>,
    /// Least-squares multiplier of `G x = e` on the face: `argmin |g_F - G_F'alpha|`.
    pub alpha: Vec<f64>,
    /// A multiplier of the last gradient projection: alpha has its part along motions that the face leaves free.
    pub reference: Option<Vec<f64>>,
    /// Gradient projections so far.
    pub projections: usize,
    /// `r = g - G'alpha`
    pub r: Vec<f64>,
    /// (21), and r in its parts (22), (23).
    pub split: Split,
    /// Directions of the steps so far that lie on this face.
    pub kept: Conjugate,
    /// Nothing is left to gain along the kept directions.
    pub settled: bool,
    /// Length that the next step along a preconditioned gradient is expected to have: that of the last one.
    pub expected: Option<f64>,
    /// How many projected steps in a row had to be cut short.
    pub cuts: usize,
    /// L: running bound of the curvature of theta.
    pub curvature: f64,
    /// `p'A p` and A p of the last product that L has been taken from.
    pub observed: Option<(f64, Vec<f64>)>,
    /// How far the updates of g may have left A x - b.
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
            cuts: 0,
            curvature: 0.0,
            observed: None,
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

    /// `A v`, or what is near to it, counted. Where A refuses it, the iterate is as before: every caller asks for its product first.
    pub fn product(&mut self, v: &[f64]) -> Result<Vec<f64>> {
        let mut image = vec![0.0; v.len()];
        self.qp.a.approximate(v, &mut image)?;
        self.counts.products += 1;
        Ok(image)
    }

    /// Recomputes the gradient from x, without the errors of its updates. Where products are near to those with A only, these have left
    /// something to gain along the kept directions, which later directions have no part of.
    pub fn refresh(&mut self) -> Result<()> {
        let mut g = vec![0.0; self.x.len()];
        self.qp.a.try_apply(&self.x, &mut g)?;
        self.counts.products += 1;
        axpy(-1.0, self.qp.b, &mut g);
        self.g = g;
        let before = self.r.clone();
        self.update()?;
        let errors = (0..before.len()).filter(|&i| !self.split.active[i]).map(|i| self.r[i] - before[i]);
        self.drift.measured(norm(&errors.collect::<Vec<_>>()), self.counts.steps());
        self.settled &= !self.qp.a.has_approximation();
        self.settle()
    }

    /// Directions of an earlier solve on this face, along which there is something left to gain.
    pub fn go_on_with(&mut self, mut directions: Conjugate) -> Result<()> {
        let held = (0..self.x.len()).filter(|&i| self.split.active[i] && directions.moves(i));
        held.collect::<Vec<_>>().into_iter().for_each(|i| directions.hold(i));
        (self.kept, self.settled) = (directions, false);
        self.settle()
    }

    /// P0: the gradient anew, where its updates by products near to those with A may have left as much of it as counts.
    pub fn refresh_if_stale(&mut self, small: f64) -> Result<()> {
        let counts = self.split.norm().max(small);
        if self.qp.a.has_approximation() && self.drift.is_felt(counts, self.counts.steps()) {
            self.refresh()?;
        }
        Ok(())
    }

    /// Takes the point `x` with its gradient; directions that leave the new face are not kept.
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

    /// Takes out of x what rounding of many steps has left of `e - G x`, on the free rows; too little to change the gradient.
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

    /// The same on the active set as it stands: rows at zero may count as free.
    pub fn update_on_face(&mut self) -> Result<()> {
        if self.alpha.is_empty() {
            self.r.copy_from_slice(&self.g);
        } else {
            // free rows see nothing of free motions, and shall see nothing of their rounding errors
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

    /// What rounding alone leaves of the residual: 64 eps (|b| + |A x| + |G'alpha|) on the rows that it counts. An open row
    /// is not among them, however far its gap.
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

    /// `theta(x) = 1/2 x'A x - b'x`
    pub fn theta(&self) -> f64 {
        0.5 * self.x.iter().zip(self.g.iter().zip(self.qp.b)).map(|(x, (g, b))| x * (g - b)).sum::<f64>()
    }

    /// Largest t with `x - t p` feasible in the bounds, entries of p up to `rounding` |p| taken for zero.
    pub fn feasible_step(&self, p: &[f64], rounding: f64) -> f64 {
        let zero = rounding * norm_max(p);
        feasible_step(&self.x, p, |i| self.qp.bounded[i] && !self.split.active[i] && p[i] > zero)
    }
}
