//! Algorithm 3 for (24): theta(x) -> min subject to x_i >= 0 (i bounded) and D x = d, by augmented Lagrangians with
//! adaptive precision of the inner problems. The multiplier of the answer is alpha = -(mu + rho (D x - d)).

use super::bound::Proportioning;
use super::sizes::PaperSizes;
use super::{Parameters, Quadratic, StepOne};
use feti_contact::error::Result;
use feti_contact::linalg::vector::{axpy, norm};
use feti_contact::qp::Coarse;
use feti_contact::qp::{AcceptanceTest, Counts, Observer, Qp, Solution, StepReport, Verdict};

/// How many times Step 2 is tightened if the answer is not accepted.
const TIGHTENINGS: usize = 6;

/// Solves (24) from `start`.
pub fn algorithm_3(
    qp: Qp,
    start: &[f64],
    parameters: &Parameters,
    judge: &mut dyn AcceptanceTest,
    observer: &mut dyn Observer,
) -> Result<Solution> {
    let mut q = Quadratic::theta(qp);
    let sizes = PaperSizes::new(&mut q, parameters.units, judge)?;
    let mut outer = Outer::new(q, start, parameters, sizes);
    let verdict = outer.run(judge, observer).or_else(Verdict::of_refusal)?;
    let alpha = outer.alpha();
    let (scale, verdict) = verdict.with(judge.scale(&outer.x, &alpha), f64::NAN)?;
    let active: Vec<bool> =
        outer.x.iter().zip(qp.bounded).map(|(x, bounded)| *bounded && *x == 0.0).collect();
    let mut coarse = Coarse::of(&qp)?;
    let (undetermined, verdict) = verdict.with(coarse.on(&active).map(|face| face.deficiency()), 0)?;
    Ok(Solution { x: outer.x, alpha, undetermined, scale, verdict, counts: outer.counts })
}

/// x^k, mu^k, rho_k, eta_k, M of Algorithm 3.
struct Outer<'a> {
    q: Quadratic<'a>,
    parameters: Parameters,
    x: Vec<f64>,
    mu: Vec<f64>,
    rho: f64,
    /// For a larger rho, A is lost in A + rho D'D in double precision.
    largest_rho: f64,
    eta: f64,
    m: f64,
    /// Sufficiently small (Step 2): |g^P| and |D x - d|.
    small: f64,
    small_violation: f64,
    /// |g^P(x^k)|, and its rounding.
    gradient: f64,
    noise: f64,
    counts: Counts,
}

/// How Step 1 ended.
enum Inner {
    /// `|g^P| <= M |D x - d|`, or both are sufficiently small.
    Precise,
    StepLimit,
    Flat,
}

impl<'a> Outer<'a> {
    /// Step 0.
    fn new(q: Quadratic<'a>, start: &[f64], parameters: &Parameters, sizes: PaperSizes) -> Self {
        let rho = parameters.rho_0 * sizes.penalty;
        let m = parameters.m.unwrap_or(parameters.rho_0 / 100.0);
        Self {
            mu: vec![parameters.mu_0 * sizes.multiplier; q.qp.e.len()],
            q,
            parameters: *parameters,
            x: start.to_vec(),
            rho,
            largest_rho: rho / f64::EPSILON,
            eta: parameters.eta_0 * sizes.violation,
            m: m * sizes.balance,
            small: parameters.tolerance * sizes.gradient,
            small_violation: parameters.tolerance * sizes.equality,
            gradient: f64::INFINITY,
            noise: 0.0,
            counts: Counts::default(),
        }
    }

    /// Algorithm 3.
    fn run(&mut self, judge: &mut dyn AcceptanceTest, observer: &mut dyn Observer) -> Result<Verdict> {
        let mut tightenings = 0;
        for _ in 0..self.parameters.outer {
            // Step 1
            match self.inner(observer)? {
                Inner::Precise => {}
                Inner::StepLimit => return Ok(Verdict::StepLimit),
                Inner::Flat => return Ok(Verdict::Stalled),
            }
            // Step 2
            let h = self.q.violation(&self.x);
            if self.is_small(norm(&h)) {
                if judge.accepts(&self.x, &self.alpha())? {
                    return Ok(Verdict::Solved);
                }
                if tightenings == TIGHTENINGS {
                    return Ok(Verdict::Inaccurate);
                }
                tightenings += 1;
                self.small *= 0.1;
                self.small_violation *= 0.1;
            }
            // Step 3
            axpy(self.rho, &h, &mut self.mu);
            // Step 4
            if norm(&h) <= self.eta {
                self.eta *= self.parameters.alpha;
            } else {
                self.rho *= self.parameters.beta;
            }
            if self.rho > self.largest_rho {
                return Ok(Verdict::Stalled);
            }
        }
        Ok(Verdict::StepLimit)
    }

    /// Step 1, (25) inexactly: Algorithm 1 on `L(., mu^k, rho_k)` until `|g^P| <= M |D x - d|`, or both are sufficiently
    /// small. Corrected: the first condition counts only while `|D x - d|` is not yet small.
    fn inner(&mut self, observer: &mut dyn Observer) -> Result<Inner> {
        self.q.augment(&self.mu, self.rho);
        let (m, small, small_violation) = (self.m, self.small, self.small_violation);
        let (mut told, before, limit) = (self.counts.steps(), self.counts, self.parameters.steps);
        let mut run = Proportioning::new(&mut self.q, self.x.clone(), self.parameters.rule)?;
        run.counts = before;
        let noise = run.q.noise(&run.point.g);
        let (mut precise, as_printed) = (false, self.parameters.step_1 == StepOne::Printed);
        let end = run.run(&mut |run| {
            if run.counts.steps() > told {
                told = run.counts.steps();
                observer.step(&progress(run, small))?;
            }
            let (v, gradient) = (norm(&run.q.violation(&run.point.x)), run.point.split.norm());
            let both = v <= small_violation && gradient <= small;
            precise = both || gradient <= noise || ((v > small_violation || as_printed) && gradient <= m * v);
            Ok(precise || told >= limit)
        });
        (self.gradient, self.noise, self.counts) = (run.point.split.norm(), noise, run.counts);
        self.x = std::mem::take(&mut run.point.x);
        self.counts.products = self.q.products;
        self.counts.outer += 1;
        Ok(match end? {
            false => Inner::Flat,
            true if precise => Inner::Precise,
            true => Inner::StepLimit,
        })
    }

    /// Step 2; a violation that is rounding counts as zero.
    fn is_small(&self, violation: f64) -> bool {
        let mut terms = vec![0.0; self.mu.len()];
        self.q.qp.g_transposed.mul_transposed_abs_add(&self.x, &mut terms);
        let rounding = 64.0 * f64::EPSILON * (norm(&terms) + norm(self.q.qp.e));
        violation <= self.small_violation.max(rounding) && self.gradient <= self.small.max(self.noise)
    }

    /// alpha = -(mu + rho (D x - d)): equal to that of (18), without a threshold for nonzero lambda.
    fn alpha(&self) -> Vec<f64> {
        let h = self.q.violation(&self.x);
        self.mu.iter().zip(&h).map(|(mu, h)| -(mu + self.rho * h)).collect()
    }
}

fn progress<'a>(run: &'a Proportioning, small: f64) -> StepReport<'a> {
    let point = &run.point;
    StepReport::new(run.last, &run.counts, &point.split, run.q.energy(&point.x, &point.g), small)
}
