//! Proportioning on the dual polyhedron: Algorithm 1 kept on the true feasible set of (12) instead of behind
//! an augmented Lagrangian. No penalty, no estimate of a norm, no parameter with a unit.

use crate::error::Result;
use crate::linalg::vector::norm;
use crate::qp::coarse::Coarse;
use crate::qp::iterate::Iterate;
use crate::qp::nnls::nearest;
use crate::qp::projection::project;
use crate::qp::steps::Step;
use crate::qp::{Counts, Qp};

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// The projected gradient is small at `tolerance` x the scale of the judge.
    pub tolerance: f64,
    /// Gamma > 0 of the proportionality test, no unit.
    pub gamma: f64,
    pub steps: usize,
}

/// Knows what the numbers mean: gives the length the residual is measured against, and the last word.
pub trait Judge {
    /// Scale of the gaps at the point x with multiplier alpha.
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64>;
    /// Whether the answer recovered from (x, alpha) passes its certificate.
    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool>;
}

/// Sees every step; `Some(verdict)` ends the run (out of time).
pub trait Observer {
    fn step(&mut self, counts: &Counts, residual: f64, active: &[bool]) -> Option<Verdict>;
}

#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The judge accepted the answer.
    Solved,
    /// `G x = e` holds only up to a part of e below 1e-7: the load is not quite held.
    Marginal,
    StepLimit,
    TimeLimit,
    /// theta no longer decreases, and the judge does not accept.
    Stalled,
    /// The residual is as small as asked, six times over, and the judge does not accept.
    Inaccurate,
    /// No x >= 0 gives `G x = e`: `direction'(e - G x) = |direction|^2` for all of them.
    Infeasible {
        direction: Vec<f64>,
        margin: f64,
    },
    /// theta falls without end along `-p`.
    Unbounded {
        p: Vec<f64>,
    },
}

#[derive(Debug, Clone)]
pub struct Solution {
    pub x: Vec<f64>,
    pub alpha: Vec<f64>,
    /// Dimension of the part of alpha that the free rows leave undetermined.
    pub undetermined: usize,
    /// What the judge measured the residual against.
    pub scale: f64,
    pub verdict: Verdict,
    pub counts: Counts,
}

/// A part of e below this that no x balances is reported as marginal, not as a load that is not held.
const MARGINAL: f64 = 1e-7;
/// ... and a part this small is a rounding error.
const ROUNDING: f64 = 1e-12;
/// How often the tolerance is tightened when the judge does not accept.
const TIGHTENINGS: usize = 6;

pub fn minimise(
    qp: Qp,
    start: &[f64],
    limits: Limits,
    judge: &mut dyn Judge,
    observer: &mut dyn Observer,
) -> Result<Solution> {
    let mut coarse = Coarse::new(qp.g_transposed)?;
    let none = vec![false; start.len()];
    if let Some(first) = project(&qp, &mut coarse, start, &none)? {
        return proportioning(Iterate::new(qp, coarse, first.point)?, limits, judge, observer);
    }
    let found = nearest(&qp, &mut coarse)?;
    let margin = found.margin;
    if margin >= MARGINAL {
        let (coarse_solves, coarse_factorisations) = (coarse.solves, coarse.factorisations);
        let counts = Counts { coarse_solves, coarse_factorisations, ..Counts::default() };
        let verdict = Verdict::Infeasible { direction: found.residual, margin };
        let alpha = vec![0.0; qp.e.len()];
        return Ok(Solution { x: found.point, alpha, undetermined: 0, scale: 0.0, verdict, counts });
    }
    let held = coarse.image(&found.point);
    let qp = if margin > ROUNDING { Qp { e: &held, ..qp } } else { qp };
    let mut solution = proportioning(Iterate::new(qp, coarse, found.point)?, limits, judge, observer)?;
    if margin > ROUNDING && solution.verdict == Verdict::Solved {
        solution.verdict = Verdict::Marginal;
    }
    Ok(solution)
}

fn proportioning(
    mut it: Iterate,
    limits: Limits,
    judge: &mut dyn Judge,
    observer: &mut dyn Observer,
) -> Result<Solution> {
    let scale = judge.scale(&it.x, &it.alpha)?;
    let mut stop = Stop::new(limits.tolerance * scale);
    let verdict = loop {
        let small = stop.residual + stop.noise * it.noise();
        if it.residual() <= small || stop.plateau(&it) {
            it.refresh()?;
            if it.residual() <= small || stop.plateau(&it) {
                match stop.tighten(judge.accepts(&it.x, &it.alpha)?) {
                    Some(verdict) => break verdict,
                    None => continue,
                }
            }
        }
        let step = if it.is_proportional(limits.gamma) { it.explore()? } else { it.release(small)? };
        match step {
            Step::Vertex { alpha } => {
                if let Some(verdict) = stop.tighten(judge.accepts(&it.x, &alpha)?) {
                    it.alpha = alpha;
                    break verdict;
                }
            }
            Step::Unbounded { p } => break Verdict::Unbounded { p },
            Step::Stuck if judge.accepts(&it.x, &it.alpha)? => break Verdict::Solved,
            Step::Stuck => break Verdict::Stalled,
            Step::ConjugateGradient | Step::Expansion | Step::Release => {}
        }
        if let Some(verdict) = observer.step(&it.counts, it.residual(), &it.active) {
            break verdict;
        }
        if it.counts.steps() >= limits.steps {
            break Verdict::StepLimit;
        }
    };
    it.counts.coarse_solves = it.coarse.solves;
    it.counts.coarse_factorisations = it.coarse.factorisations;
    Ok(Solution {
        undetermined: it.coarse.deficiency(),
        scale,
        x: it.x,
        alpha: it.alpha,
        verdict,
        counts: it.counts,
    })
}

/// When the residual is small enough, or no longer worth reducing.
struct Stop {
    residual: f64,
    /// Share of the allowance for rounding that counts.
    noise: f64,
    tightenings: usize,
    /// Smallest residual of the current face, the count of steps when it was met, and that face.
    best: f64,
    met: usize,
    face: Vec<bool>,
}

impl Stop {
    fn new(residual: f64) -> Self {
        Self { residual, noise: 1.0, tightenings: 0, best: f64::INFINITY, met: 0, face: Vec::new() }
    }

    /// No conjugate gradient step has halved the residual of this face for longer than exact arithmetic
    /// would need to solve it: rounding errors have taken over.
    fn plateau(&mut self, it: &Iterate) -> bool {
        let (steps, residual) = (it.counts.steps(), norm(&it.free));
        if self.face != it.active || residual < 0.5 * self.best {
            (self.best, self.met) = (residual, steps);
            self.face.clone_from(&it.active);
        }
        let unknowns = it.active.iter().filter(|active| !**active).count();
        steps - self.met > 2 * unknowns + 20
    }

    fn tighten(&mut self, accepted: bool) -> Option<Verdict> {
        if accepted {
            return Some(Verdict::Solved);
        }
        if self.tightenings == TIGHTENINGS {
            return Some(Verdict::Inaccurate);
        }
        self.tightenings += 1;
        self.residual *= 0.1;
        self.noise *= 0.1;
        None
    }
}
