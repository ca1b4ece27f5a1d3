//! SMALBE-M, the semimonotonic augmented Lagrangian method for bounds and equalities (Dostal 2009, chapter 6),
//! on the projected and homogenised problem. With `Q = G'W+G`, `P = I - Q`, `W = G G'`, the violation
//! `s = W+(G x - e)` and `v = x - G's`, the nearest point to x on `G v = e`,
//!
//! ```text
//! L(x, m, rho) = theta(v) + m'(G x - e) + rho/2 |G's|^2 -> min over x_i >= 0,    then  m <- m + rho s
//! g = A v - b - G'alpha,   alpha = W+G (A v - b) - m - rho s,   H = P A P + rho Q
//! ```
//!
//! alpha tends to the multiplier of `G x = e`, also at a vertex where least squares on the face do not find it.

mod augmented;
mod mprgp;

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm};
use crate::platform::interrupt;
use crate::qp::coarse::Coarse;
use crate::qp::projection::project;
use crate::qp::proportioning::Stop;
use crate::qp::smalbe::augmented::{Augmented, Violation};
use crate::qp::smalbe::mprgp::{Bounded, Move, Rule};
use crate::qp::{AcceptanceTest, Counts, Limits, Observer, Qp, Solution, StepKind, StepReport, Verdict};

/// Step of gradient projection in units of 1 / |H|.
const GRADIENT_STEP: f64 = 1.5;
/// Divisor of M if L does not increase enough.
const BETA: f64 = 2.0;
/// The inner problem is solved at least to this part of `|P (A x - b)|` at the first point.
const ETA: f64 = 0.1;
/// Curvature counts as zero below this part of lambda_max.
const SINGULAR: f64 = 1e-11;
/// Limit of outer iterations.
const OUTER: usize = 2000;
/// rho is multiplied by ten, at most this many times, ...
const INCREASES: usize = 4;
/// ... if this number of outer iterations have not halved the violation.
const PATIENCE: usize = 30;
/// The acceptance test decides after this number of residuals that were small before, but not after, the gradient was
/// recomputed.
const RECOMPUTED: usize = 10;

pub fn smalbe(
    qp: Qp,
    start: &[f64],
    limits: Limits,
    judge: &mut dyn AcceptanceTest,
    observer: &mut dyn Observer,
) -> Result<Solution> {
    let mut al = Lagrangian::new(qp, start)?;
    let verdict = al.run(&limits, judge, observer).or_else(Verdict::of_refusal)?;
    al.solution(verdict)
}

struct Lagrangian<'a> {
    map: Augmented<'a>,
    /// x; its gradient is followed by alpha.
    point: Bounded<'a>,
    /// m
    multiplier: Vec<f64>,
    /// 64 eps (|b| + |A v| + |G'alpha|) on the rows not at rest when the gradient was last computed: its rounding.
    noise: f64,
    /// Violation of `G x = e` by x.
    violation: Violation,
    /// M of the inner precision `|g^P| <= M |G's|`.
    precision: f64,
    /// eta |P (A x - b)|
    enough: f64,
    /// The scale to which the acceptance test relates the residual.
    scale: f64,
    outer: usize,
    /// rho |G's|^2: the increase of L by the last update of the multiplier.
    raised: Option<f64>,
    halving: Halving,
}

impl<'a> Lagrangian<'a> {
    /// Starts at the feasible point nearest to `start`.
    fn new(qp: Qp<'a>, start: &[f64]) -> Result<Self> {
        let mut coarse = Coarse::of(&qp)?;
        let none = vec![false; start.len()];
        let first = interrupt::part("first feasible point", || project(&qp, &mut coarse, start, &none))?;
        let point = Bounded::new(qp.bounded, first.map_or_else(|| start.to_vec(), |first| first.point));
        let map = Augmented::new(qp, coarse)?;
        let mut al = Self {
            precision: map.rho,
            violation: Violation::default(),
            map,
            point,
            multiplier: vec![0.0; qp.e.len()],
            noise: 0.0,
            enough: 0.0,
            scale: 0.0,
            outer: 0,
            raised: None,
            halving: Halving::new(),
        };
        al.recompute()?;
        al.enough = ETA * norm(al.gradient());
        Ok(al)
    }

    fn run(
        &mut self,
        limits: &Limits,
        judge: &mut dyn AcceptanceTest,
        observer: &mut dyn Observer,
    ) -> Result<Verdict> {
        self.scale = judge.scale(&self.point.x, self.alpha())?;
        let mut stop = Stop::new(limits.tolerance * self.scale);
        let mut recomputed = 0;
        while self.outer < OUTER {
            let small = stop.residual + stop.noise * self.noise;
            let before = (self.point.x.clone(), self.point.g.clone());
            if let Some(verdict) = self.inner(small, limits, observer)? {
                return Ok(verdict);
            }
            if self.is_optimal(small) {
                self.recompute()?;
                recomputed += 1;
                if self.is_optimal(small) || recomputed > RECOMPUTED {
                    let x = self.on_equalities()?;
                    if let Some(verdict) = stop.tighten(judge.accepts(&x, self.alpha())?) {
                        return Ok(verdict);
                    }
                }
            }
            self.update(before);
        }
        Ok(Verdict::StepLimit)
    }

    /// Recomputes gradient and alpha at x, without the rounding of their updates.
    fn recompute(&mut self) -> Result<()> {
        self.violation = self.map.violation(&self.point.x)?;
        let mut v = self.point.x.clone();
        axpy(-1.0, &self.violation.way, &mut v);
        let mut g = self.map.image(&v)?;
        let size = g.clone();
        axpy(-1.0, self.map.qp.b, &mut g);
        let image = self.map.coarse.image(&g);
        let mut alpha = self.map.solve(&image)?;
        axpy(-1.0, &self.multiplier, &mut alpha);
        axpy(-self.map.rho, &self.violation.s, &mut alpha);
        let coarse = self.map.spread(&alpha);
        axpy(-1.0, &coarse, &mut g);
        let (x, qp) = (&self.point.x, &self.map.qp);
        let counts = |i: &usize| !qp.bounded[*i] || x[*i] > 0.0 || g[*i] < 0.0;
        let on = |v: &[f64]| (0..v.len()).filter(counts).map(|i| v[i] * v[i]).sum::<f64>().sqrt();
        self.noise = 64.0 * f64::EPSILON * (on(&size) + on(qp.b) + on(&coarse));
        g.extend(alpha);
        self.point.set_gradient(g);
        Ok(())
    }

    /// MPRGP until `|g^P| <= min(M |G's|, eta |P (A x - b)|)`, or below `small`.
    fn inner(&mut self, small: f64, limits: &Limits, observer: &mut dyn Observer) -> Result<Option<Verdict>> {
        let (largest, rho) = (self.map.largest, self.map.rho);
        let (step, flat) = (GRADIENT_STEP / largest.max(rho), SINGULAR * largest);
        let rule = Rule { gamma: limits.gamma, step, flat };
        loop {
            let wanted = (self.precision * self.violation.length).min(self.enough);
            if self.point.split.norm() <= wanted.max(small) {
                return Ok(None);
            }
            if self.map.counts.steps() >= limits.steps {
                return Ok(Some(Verdict::StepLimit));
            }
            let kind = match self.point.step(&mut self.map, &rule)? {
                Move::ConjugateGradient => StepKind::ConjugateGradient,
                Move::Expansion => StepKind::Expansion,
                Move::Proportioning => StepKind::Proportioning,
                Move::Unbounded { .. } if self.point.split.norm() <= self.noise => {
                    return Ok(Some(Verdict::Inaccurate));
                }
                Move::Unbounded { mut p } => {
                    self.map.project(&mut p)?;
                    return Ok(Some(Verdict::Unbounded { p }));
                }
            };
            self.violation = self.map.violation(&self.point.x)?;
            observer.step(&self.progress(kind, small))?;
        }
    }

    /// The projected gradient is small, and its change on the way to `G x = e` is also small.
    fn is_optimal(&self, small: f64) -> bool {
        self.point.split.norm() <= small
            && (self.is_balanced() || self.map.largest * self.violation.length <= small)
    }

    /// `G x = e` is satisfied up to rounding.
    fn is_balanced(&self) -> bool {
        self.violation.length <= 64.0 * f64::EPSILON * norm(&self.point.x)
    }

    /// Ends an outer iteration that began at `(x, g)`: adds the violation to the multiplier, and adapts M and rho. Values
    /// of L are compared through the gradients, which avoids the cancellation in their difference.
    fn update(&mut self, (x, g): (Vec<f64>, Vec<f64>)) {
        let (rho, length) = (self.map.rho, self.violation.length);
        let (y, mut g_y) = (&self.point.x, self.point.g.clone());
        if let Some(raised) = self.raised {
            let terms = y.iter().zip(&x).zip(g_y.iter().zip(&g));
            let change: f64 = terms.map(|((y, x), (g_y, g))| 0.5 * (y - x) * (g_y + g)).sum();
            if raised + change < 0.5 * rho * length * length {
                self.precision /= BETA;
            }
        }
        axpy(rho, &self.violation.s, &mut self.multiplier);
        self.add_violation(rho, &mut g_y);
        self.raised = Some(rho * length * length);
        if !self.is_balanced() && self.halving.stalls(length) {
            self.add_violation(9.0 * rho, &mut g_y);
            self.map.rho *= 10.0;
            self.raised = None;
        }
        self.point.set_gradient(g_y);
        self.outer += 1;
    }

    /// Adds the effect of an increase `rho` of the penalty, or of the multiplier, to the gradient and subtracts it from
    /// alpha.
    fn add_violation(&self, rho: f64, g: &mut [f64]) {
        let (g, alpha) = g.split_at_mut(self.point.x.len());
        axpy(rho, &self.violation.way, g);
        axpy(-rho, &self.violation.s, alpha);
    }

    fn gradient(&self) -> &[f64] {
        &self.point.g[..self.point.x.len()]
    }

    fn alpha(&self) -> &[f64] {
        &self.point.g[self.point.x.len()..]
    }

    /// theta(v): `v'(A v - b) = v'g + e'alpha`.
    fn theta(&self) -> f64 {
        let mut v = self.point.x.clone();
        axpy(-1.0, &self.violation.way, &mut v);
        let (b, e) = (self.map.qp.b, self.map.qp.e);
        0.5 * (dot(&v, self.gradient()) + dot(e, self.alpha()) - dot(b, &v))
    }

    /// Counts the step and describes the resulting point.
    fn progress(&mut self, kind: StepKind, small: f64) -> StepReport<'_> {
        let counts = &mut self.map.counts;
        match kind {
            StepKind::ConjugateGradient => counts.conjugate_gradient += 1,
            StepKind::Expansion => counts.expansions += 1,
            StepKind::Proportioning => counts.releases += 1,
            StepKind::Newton => counts.newton += 1,
        }
        StepReport::new(kind, &self.map.counts, &self.point.split, self.theta(), small)
    }

    /// The nearest point on `G x = e` with the active rows unchanged; x itself if there is none.
    fn on_equalities(&mut self) -> Result<Vec<f64>> {
        let found = project(&self.map.qp, &mut self.map.coarse, &self.point.x, &self.point.split.active)?;
        Ok(found.map_or_else(|| self.point.x.clone(), |found| found.point))
    }

    fn solution(mut self, verdict: Verdict) -> Result<Solution> {
        let nearest = self.on_equalities();
        let (x, verdict) = verdict.with(nearest, self.point.x.clone())?;
        let coarse = &mut self.map.coarse;
        let open = coarse.on(&self.point.split.active).map(|face| face.deficiency());
        let (undetermined, verdict) = verdict.with(open, 0)?;
        let (coarse_solves, coarse_factorisations) = (coarse.solves, coarse.factorisations);
        let counts = Counts { coarse_solves, coarse_factorisations, ..self.map.counts };
        let (scale, alpha) = (self.scale, self.alpha().to_vec());
        Ok(Solution { x, alpha, undetermined, scale, verdict, counts })
    }
}

/// Compares the violation of successive outer iterations.
struct Halving {
    to_halve: f64,
    since: usize,
    increases: usize,
}

impl Halving {
    fn new() -> Self {
        Self { to_halve: f64::INFINITY, since: 0, increases: 0 }
    }

    /// Whether the penalty must be increased.
    fn stalls(&mut self, violation: f64) -> bool {
        self.since += 1;
        if violation <= 0.5 * self.to_halve {
            (self.to_halve, self.since) = (violation, 0);
        }
        let stalled = self.since == PATIENCE && self.increases < INCREASES;
        if stalled {
            (self.since, self.increases) = (0, self.increases + 1);
        }
        stalled
    }
}

#[cfg(test)]
mod tests;
