//! Proportioning on the dual polyhedron: Algorithm 1 kept on the true feasible set of (12) instead of behind
//! an augmented Lagrangian. No penalty, no estimate of a norm, no parameter with a unit. Step by step: docs/method.md, whose tags
//! the comments here and in `steps` name.

use crate::error::{Error, Kind, Result};
use crate::linalg::vector::norm;
use crate::qp::balance::{balance, Balance};
use crate::qp::coarse::Coarse;
use crate::qp::iterate::Iterate;
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
    /// How many times too large what the last point was refused for is; not known to one who does not ask.
    fn missed(&self) -> Option<f64> {
        None
    }
    /// A solution that was not accepted, mended by better data than A and b until it is; none where that fails.
    fn mended(&mut self, _: &Solution) -> Result<Option<Solution>> {
        Ok(None)
    }
    /// The scale without any travel, at the point accepted last; not known before, or to one who does not ask.
    fn length(&self) -> Option<f64> {
        None
    }
}

/// Sees every step; an error ends the run, with the point reached where it says `Cancelled` or `TimeOver`.
pub trait Observer {
    fn step(&mut self, now: &Progress) -> Result<()>;
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepKind {
    ConjugateGradient,
    Expansion,
    Release,
}

/// Where the method stands after a step.
pub struct Progress<'a> {
    pub kind: StepKind,
    pub counts: &'a Counts,
    pub active: &'a [bool],
    pub theta: f64,
    /// Norms of `g^P`, of its parts `g^I` (22) and `g^C` (23), and the norm that counts as zero.
    pub residual: f64,
    pub free: f64,
    pub chopped: f64,
    pub small: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The judge accepted the answer.
    Solved,
    StepLimit,
    TimeLimit,
    Cancelled,
    /// theta no longer decreases, and the judge does not accept.
    Stalled,
    /// The residual is as small as asked, eight times over, and the judge does not accept.
    Inaccurate,
    /// No x >= 0 was found with `G x = e`; that of the solution comes nearest, `direction = e - G x`. Where G resists it
    /// nowhere, `G_i'direction <= 0` (`= 0` where x_i is free), it proves that there is none; `margin = |direction| / |e|`.
    Infeasible {
        direction: Vec<f64>,
        margin: f64,
    },
    /// theta falls without end along `-p`.
    Unbounded {
        p: Vec<f64>,
    },
}

impl Verdict {
    /// How a run ends that observer or operator would not let go on.
    pub fn of_refusal(error: Error) -> Result<Self> {
        match error.kind {
            Kind::Cancelled => Ok(Self::Cancelled),
            Kind::TimeOver => Ok(Self::TimeLimit),
            _ => Err(error),
        }
    }
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

/// What no x balances of e is rounding of e where it is less than this part of it.
const ROUNDING: f64 = 1e-12;
/// Forces of a start that move so many times as far as loads and gaps are not worth while.
const FAR_OFF: f64 = 1e3;
/// A scale so many times the one without travel is travel.
const TRAVEL: f64 = 10.0;
/// A point refused for less than this much is mended by some more steps.
const MISSED: f64 = 1e3;
/// How often the tolerance is tightened when the judge does not accept.
const TIGHTENINGS: usize = 8;

pub fn minimise(
    qp: Qp,
    start: &[f64],
    limits: Limits,
    judge: &mut dyn Judge,
    observer: &mut dyn Observer,
) -> Result<Solution> {
    let mut coarse = Coarse::new(qp.g_transposed, qp.rounding)?;
    let first = match first_point(&qp, &mut coarse, start)? {
        Some(first) => first,
        // S6.2
        None => {
            let found = balance(&qp, &mut coarse)?;
            if found.margin > ROUNDING {
                return Ok(infeasible(&qp, &coarse, found));
            }
            found.point
        }
    };
    // S6.3
    let mut it = Iterate::new(qp, coarse, first)?;
    if start.iter().any(|x| *x != 0.0) && it.is_far_off() {
        if let Some(cold) = project(&qp, &mut it.coarse, &vec![0.0; start.len()], &vec![false; start.len()])?
        {
            it.x = cold.point;
            it.refresh()?;
        }
    }
    proportioning(it, limits, judge, observer)
}

/// The verdict where no x balances e, for a method that does not ask.
pub fn not_held(qp: &Qp, start: &[f64]) -> Result<Option<Solution>> {
    let mut coarse = Coarse::new(qp.g_transposed, qp.rounding)?;
    if first_point(qp, &mut coarse, start)?.is_some() {
        return Ok(None);
    }
    let found = balance(qp, &mut coarse)?;
    Ok((found.margin > ROUNDING).then(|| infeasible(qp, &coarse, found)))
}

fn infeasible(qp: &Qp, coarse: &Coarse, found: Balance) -> Solution {
    let (coarse_solves, coarse_factorisations) = (coarse.solves, coarse.factorisations);
    let counts = Counts { coarse_solves, coarse_factorisations, ..Counts::default() };
    let verdict = Verdict::Infeasible { direction: found.residual, margin: found.margin };
    Solution { x: found.point, alpha: vec![0.0; qp.e.len()], undetermined: 0, scale: 0.0, verdict, counts }
}

/// S6.1: the feasible point nearest to `start`: on the face of its zeros, the active set it brings along, where that
/// face has one.
fn first_point(qp: &Qp, coarse: &mut Coarse, start: &[f64]) -> Result<Option<Vec<f64>>> {
    if start.iter().any(|x| *x != 0.0) {
        let zeros = qp.at_bound(start);
        if let Some(first) = project(qp, coarse, start, &zeros)? {
            return Ok(Some(first.point));
        }
    }
    let none = vec![false; start.len()];
    Ok(project(qp, coarse, start, &none)?.map(|first| first.point))
}

fn proportioning(
    mut it: Iterate,
    limits: Limits,
    judge: &mut dyn Judge,
    observer: &mut dyn Observer,
) -> Result<Solution> {
    // S7
    let scale = judge.scale(&it.x, &it.alpha)?;
    let stop = Stop::new(limits.tolerance * scale);
    let verdict = run(&mut it, stop, limits, judge, observer).or_else(Verdict::of_refusal)?;
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

fn run(
    it: &mut Iterate,
    mut stop: Stop,
    limits: Limits,
    judge: &mut dyn Judge,
    observer: &mut dyn Observer,
) -> Result<Verdict> {
    loop {
        // P1 of docs/method.md: the stop
        let small = stop.residual + stop.noise * it.noise();
        if it.residual() <= small || stop.plateau(it) {
            it.rebalance()?;
            if judge.accepts(&it.x, &it.alpha)? {
                if !stop.refine(limits.tolerance, judge.length()) {
                    return Ok(Verdict::Solved);
                }
                continue;
            }
            if stop.tighten_by(judge.missed()) {
                continue;
            }
            it.refresh()?;
            if it.residual() <= small || stop.plateau(it) {
                match stop.tighten(judge.accepts(&it.x, &it.alpha)?) {
                    Some(verdict) => return Ok(verdict),
                    None => continue,
                }
            }
        }
        // P2: the face is explored (P3 to P8), or rows are released (P9 to P11)
        let step = if it.is_proportional(limits.gamma) { it.explore()? } else { it.release(small)? };
        // P12, and P10 at a degenerate vertex
        let kind = match step {
            Step::Vertex { alpha } => {
                if let Some(verdict) = stop.tighten(judge.accepts(&it.x, &alpha)?) {
                    it.alpha = alpha;
                    return Ok(verdict);
                }
                StepKind::Release
            }
            Step::Unbounded { .. } | Step::Stuck if judge.accepts(&it.x, &it.alpha)? => {
                return Ok(Verdict::Solved);
            }
            Step::Unbounded { p } => return Ok(Verdict::Unbounded { p }),
            Step::Stuck => return Ok(Verdict::Stalled),
            Step::ConjugateGradient => StepKind::ConjugateGradient,
            Step::Expansion => StepKind::Expansion,
            Step::Release => StepKind::Release,
        };
        observer.step(&it.progress(kind, small))?;
        if it.counts.steps() >= limits.steps {
            return Ok(Verdict::StepLimit);
        }
    }
}

impl Iterate<'_> {
    /// The forces move everything so much farther than loads and gaps do that they belong to other loads: what they would leave
    /// by rounding is much for these.
    fn is_far_off(&self) -> bool {
        let image: Vec<f64> = self.g.iter().zip(self.qp.b).map(|(g, b)| g + b).collect();
        norm(&image) > FAR_OFF * norm(self.qp.b)
    }

    fn progress(&self, kind: StepKind, small: f64) -> Progress<'_> {
        Progress {
            kind,
            counts: &self.counts,
            active: &self.active,
            theta: self.theta(),
            residual: self.residual(),
            free: norm(&self.free),
            chopped: norm(&self.chopped),
            small,
        }
    }
}

/// When the residual is small enough, or no longer worth reducing.
pub(super) struct Stop {
    pub residual: f64,
    /// Share of the allowance for rounding that counts.
    pub noise: f64,
    tightenings: usize,
    refined: bool,
    /// Smallest residual of the current face, the count of steps when it was met, and that face.
    best: f64,
    met: usize,
    face: Vec<bool>,
}

impl Stop {
    pub fn new(residual: f64) -> Self {
        Self {
            residual,
            noise: 1.0,
            tightenings: 0,
            refined: false,
            best: f64::INFINITY,
            met: 0,
            face: Vec::new(),
        }
    }

    /// P1, the plateau: no conjugate gradient step has halved the residual of this face for longer than exact arithmetic
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

    /// P1.2: once, where all that the residual was measured against is travel: from now on it is measured against the rest.
    fn refine(&mut self, tolerance: f64, length: Option<f64>) -> bool {
        let target = length.map_or(f64::INFINITY, |length| tolerance * length);
        let refines = !self.refined && TRAVEL * target < self.residual;
        if refines {
            self.residual = target;
        }
        self.refined |= refines;
        refines
    }

    /// P1.3: at the first two refusals, by as much as they tell; false where that is more than steps without rounding could mend.
    fn tighten_by(&mut self, missed: Option<f64>) -> bool {
        let missed = missed.filter(|missed| *missed < MISSED && self.tightenings < 2);
        if let Some(missed) = missed {
            self.tightenings += 1;
            self.residual *= (0.4 / missed).min(0.4);
        }
        missed.is_some()
    }

    /// P1.4: the verdict; none where target and allowance for rounding have become a tenth, and the run goes on.
    pub fn tighten(&mut self, accepted: bool) -> Option<Verdict> {
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
