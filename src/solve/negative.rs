//! Motions with negative stiffness, S = S+ - S-: geometric stiffness of compressed bodies, rounding of K. The dual
//! problem of K is not concave. The dual problem of K + S-, with `e + S- a` in place of e, is concave, and its answer has
//! the amplitudes a of the next round. On one face F the map from a to the next a is affine,
//!
//! ```text
//! b -> P b + p,   b = S-^1/2 a,   P = S-^1/2 (S+ + G_F F_FF^-1 G_F')^-1 S-^1/2
//! ```
//!
//! over the motions with negative stiffness alone, so that one Newton step finds its fixed point: `b + (I - P)^-1 (P b +
//! p - b)`. The largest eigenvalue rho of P is below 1 exactly if K is positive definite along the rows F. Otherwise the
//! energy falls along a motion that keeps F closed: the next round begins where another row stops that motion; if no row
//! stops it, the energy has no minimum. The energy of the answers falls from round to round, except in the Newton step,
//! which ignores open rows; if the energy has risen, the previous answer moves along that step only as far as open rows
//! allow. If the face is too large for dense factors, the rounds continue without Newton steps and converge at the rate
//! rho.

use crate::error::{Error, Kind, Proof, Result};
use crate::linalg::vector::{axpy, dot, norm_max, NOISE};
use crate::model::Settings;
use crate::progress::Steps;
use crate::qp::{AcceptanceTest, Counts, Qp, Solution, Verdict};
use crate::solve::case::Case;
use crate::solve::certifier::Certifier;
use crate::solve::fallback::MethodOptions;
use crate::solve::feedback::{Feedback, NegativeMotions};
use crate::solve::near::{or_last, solve_near};
use crate::solve::recovery::Recovery;
use crate::solve::sliding::Sliding;

/// Limit of rounds.
const ROUNDS: usize = 60;
/// `tolerance` of the first round, which only has to find the active rows: another round follows.
const ROUGH: f64 = 1e-5;
/// After this number of rounds on one face, an answer that passes the certificate is accepted although its amplitudes
/// still change.
const STRICT: usize = 2;
/// This limit applies to all rounds if there are no Newton steps.
const STRICT_ALONE: usize = 20;
/// After this number of Newton rounds on one face, only rounding is left between the rounds.
const MENDED: usize = 4;
/// Two energies are equal if they differ by less than this part of their terms.
const SAME: f64 = 1e-9;

/// Where a round begins.
struct Step {
    b: Vec<f64>,
    x: Vec<f64>,
    /// The step has ignored open rows: its answer may have more energy.
    is_trial: bool,
}

/// An answer of a round.
struct Round<'a> {
    x: Vec<f64>,
    alpha: Vec<f64>,
    held: Vec<bool>,
    /// `S-^1/2 a`, and its difference from b of the round.
    next: Vec<f64>,
    change: Vec<f64>,
    /// `1/2 u'K u - f'u` up to a constant, and the size of its terms.
    energy: f64,
    terms: f64,
    is_rough: bool,
    /// None if the face is too large for dense factors.
    feedback: Option<Feedback<'a>>,
}

/// What the rounds so far have found.
#[derive(Default)]
struct Known<'a> {
    rounds: usize,
    /// Successive rounds on one face.
    same: usize,
    /// The last round, not counting trials whose energy has risen.
    last: Option<Round<'a>>,
}

/// What follows a round.
enum Next {
    Step(Step),
    /// Only rounding is left between rounds: the answer is corrected by the data of the host; if that fails, this step
    /// follows.
    Mend(Step),
    End(Verdict),
}

/// What the rounds are judged with.
struct Search<'a, 'b> {
    case: Case<'a>,
    means: &'b MethodOptions<'a>,
    qp: Qp<'a>,
    negative: &'b NegativeMotions,
    recovery: &'b Recovery<'a>,
}

/// Solves the dual of (10)-(11), with rounds if there are motions with negative stiffness.
pub fn solve_with_negative_motions<'a>(
    case: Case<'a>,
    means: &MethodOptions<'a>,
    qp: Qp<'a>,
    start: &[f64],
    judge: &mut Certifier<'a>,
    steps: &mut Steps,
) -> Result<Solution> {
    let negative = NegativeMotions::of(case.ready);
    if negative.modes.is_empty() {
        return solve_near(means, qp, start, judge, steps);
    }
    let rough = Settings { tolerance: means.settings.tolerance.max(ROUGH), ..means.settings.clone() };
    let (mut step, mut counts) = (Step::first(&negative, start.to_vec()), Counts::default());
    let (mut known, mut before) = (Known::default(), None);
    loop {
        judge.is_rough = known.rounds == 0 && means.direct.limit > 0;
        judge.is_strict = known.is_strict();
        judge.assumed = negative.amplitudes(&step.b);
        let settings = if judge.is_rough { &rough } else { means.settings };
        let e = negative.resultants(qp.e, &step.b);
        let with = MethodOptions { settings, ..*means };
        let found = solve_near(&with, Qp { e: &e, ..qp }, &step.x, judge, steps);
        let mut solution = or_last(found, before.take())?;
        counts = counts + solution.counts;
        solution.counts = counts;
        if let Verdict::StepLimit | Verdict::TimeLimit | Verdict::Cancelled = solution.verdict {
            return Ok(solution);
        }
        let search = Search { case, means, qp, negative: &negative, recovery: &judge.recovery };
        let next = match &solution.verdict {
            Verdict::Solved => search.after(&mut known, &step, &solution, (judge.unsettled, judge.is_rough)),
            _ => search.without_answer(&mut known, &step, &solution),
        };
        match next {
            Ok(Next::Step(next)) => step = next,
            Ok(Next::Mend(next)) => match judge.mended(&solution) {
                Ok(Some(mended)) => return Ok(mended),
                Ok(None) => step = next,
                Err(error) => return Ok(Solution { verdict: Verdict::of_refusal(error)?, ..solution }),
            },
            Ok(Next::End(verdict)) => return Ok(Solution { verdict, ..solution }),
            Err(error) => return Ok(Solution { verdict: Verdict::of_refusal(error)?, ..solution }),
        }
        before = Some(solution);
    }
}

impl Step {
    /// a = 0
    fn first(negative: &NegativeMotions, x: Vec<f64>) -> Self {
        Self { b: vec![0.0; negative.modes.len()], x, is_trial: false }
    }
}

impl Known<'_> {
    /// An accepted answer must also have settled amplitudes.
    fn is_strict(&self) -> bool {
        match &self.last {
            Some(Round { feedback: None, .. }) => self.rounds < STRICT_ALONE,
            _ => self.same < STRICT,
        }
    }
}

impl Round<'_> {
    /// The energy of this round is above that of `other`.
    fn is_above(&self, other: &Round) -> bool {
        !other.is_rough && self.energy > other.energy + SAME * (self.terms + other.terms)
    }
}

impl<'a> Search<'a, '_> {
    /// What follows a round with an answer; an error is the proof that there is no minimum.
    fn after(
        &self,
        known: &mut Known<'a>,
        step: &Step,
        solution: &Solution,
        (unsettled, is_rough): (bool, bool),
    ) -> Result<Next> {
        let round = Round { is_rough, ..self.round(step, solution)? };
        known.rounds += 1;
        let is_same = known.last.as_ref().is_some_and(|last| last.held == round.held);
        known.same = if is_same { known.same + 1 } else { 0 };
        let falling = self.falling(&round, known.last.as_ref().filter(|_| is_same))?;
        match &falling {
            Some((motion, rate)) if !unsettled => return Err(indefinite(self.case, &motion.v, *rate)),
            _ if !unsettled => return Ok(Next::End(Verdict::Solved)),
            None if known.same > MENDED && round.feedback.is_some() => {
                return Ok(Next::End(Verdict::Stalled))
            }
            _ if known.rounds >= ROUNDS => return Ok(Next::End(Verdict::Stalled)),
            _ => {}
        }
        if let Some(last) = known.last.as_ref().filter(|last| step.is_trial && round.is_above(last)) {
            return Ok(Next::Step(self.back(last)?));
        }
        let next = match falling {
            Some((motion, rate)) => self.along(&round, &motion, rate)?,
            None => self.settled(&round)?,
        };
        let is_to_mend = next.is_trial && known.same == MENDED;
        known.last = Some(round);
        Ok(if is_to_mend { Next::Mend(next) } else { Next::Step(next) })
    }

    /// What follows a round without an answer: no forces balance its load if the energy falls without end.
    fn without_answer(&self, known: &mut Known<'a>, step: &Step, solution: &Solution) -> Result<Next> {
        if known.rounds == 0 {
            return Ok(Next::End(solution.verdict.clone()));
        }
        known.rounds += 1;
        if let Verdict::Infeasible { .. } = solution.verdict {
            let e = self.negative.resultants(self.qp.e, &step.b);
            let left = Qp { e: &e, ..self.qp }.left(&solution.x);
            let motion = Sliding::of(self.recovery, vec![0.0; solution.x.len()], left)?;
            let bounded = self.qp.bounded;
            let u = vec![0.0; motion.v.len()];
            if motion.falls(self.recovery, bounded)? && motion.reach(self.recovery, &u, bounded).is_infinite()
            {
                return Err(indefinite(self.case, &motion.v, f64::INFINITY));
            }
        }
        match &known.last {
            _ if known.rounds >= ROUNDS || !step.is_trial => Ok(Next::End(Verdict::Stalled)),
            Some(last) if !last.is_rough => Ok(Next::Step(self.back(last)?)),
            _ => Ok(Next::Step(Step::first(self.negative, solution.x.clone()))),
        }
    }

    fn round(&self, step: &Step, solution: &Solution) -> Result<Round<'a>> {
        let Solution { x, alpha, .. } = solution;
        let held = self.qp.at_bound(x);
        let next = self.negative.forced(alpha);
        let change = next.iter().zip(&step.b).map(|(next, b)| next - b).collect();
        let parts = [0.5 * dot(self.qp.b, x), -0.5 * dot(self.qp.e, alpha), 0.5 * dot(&next, &step.b)];
        let negative = -0.5 * dot(&next, &next);
        let energy = parts.iter().sum::<f64>() + negative;
        let terms = parts.iter().map(|part| part.abs()).sum::<f64>() - negative;
        let feedback = Feedback::of(self.means.direct, self.qp, &held, self.negative)?;
        Ok(Round {
            x: x.clone(),
            alpha: alpha.clone(),
            held,
            next,
            change,
            energy,
            terms,
            is_rough: false,
            feedback,
        })
    }

    /// A motion along which the energy falls while the rows of the face stay closed, and its rate; `last` had the same
    /// face.
    fn falling(&self, round: &Round, last: Option<&Round>) -> Result<Option<(Sliding, f64)>> {
        let found = match self.negative.free(self.qp, &round.held)? {
            Some(alpha) => Some((vec![0.0; round.x.len()], alpha, f64::INFINITY)),
            None => match (&round.feedback, last) {
                (Some(feedback), _) => {
                    (1.0 - feedback.rate() < NOISE).then(|| feedback.motion(round.x.len()))
                }
                (None, Some(last)) => {
                    let minus = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x - y).collect();
                    let rate = (dot(&round.change, &round.change) / dot(&last.change, &last.change)).sqrt();
                    (rate >= 1.0).then(|| (minus(&round.x, &last.x), minus(&round.alpha, &last.alpha), rate))
                }
                (None, None) => None,
            },
        };
        let Some((x, alpha, rate)) = found else { return Ok(None) };
        let mut motion = Sliding::of(self.recovery, x, alpha)?;
        if dot(&round.change, &self.negative.forced(&motion.alpha)) < 0.0 {
            motion.turn();
        }
        Ok(motion.falls(self.recovery, &round.held)?.then_some((motion, rate)))
    }

    /// The next step: along a motion on which the energy falls, up to the row that stops it.
    fn along(&self, round: &Round, motion: &Sliding, rate: f64) -> Result<Step> {
        let reach = motion.reach(self.recovery, &self.displacements(round)?, &round.held);
        if reach.is_infinite() {
            return Err(indefinite(self.case, &motion.v, rate));
        }
        Ok(self.moved(round, motion, reach))
    }

    /// The next step: the Newton step to the fixed point of the face.
    fn settled(&self, round: &Round) -> Result<Step> {
        let Some(feedback) = round.feedback.as_ref().filter(|feedback| feedback.rate() < 1.0) else {
            return Ok(Step { b: round.next.clone(), x: round.x.clone(), is_trial: false });
        };
        let b = feedback.settled(&round.next, &round.change);
        let (x, _) = feedback.point(self.qp, &self.negative.resultants(self.qp.e, &b))?;
        let x = (0..x.len()).map(|i| if self.qp.bounded[i] { x[i].max(0.0) } else { x[i] }).collect();
        Ok(Step { b, x, is_trial: true })
    }

    /// The Newton step of [`settled`](Self::settled), shortened so that open rows stay open.
    fn back(&self, round: &Round) -> Result<Step> {
        let plain = Step { b: round.next.clone(), x: round.x.clone(), is_trial: false };
        let Some(feedback) = &round.feedback else { return Ok(plain) };
        let b = feedback.settled(&round.next, &round.change);
        let (mut x, mut alpha) = feedback.point(self.qp, &self.negative.resultants(self.qp.e, &b))?;
        axpy(-1.0, &round.x, &mut x);
        axpy(-1.0, &round.alpha, &mut alpha);
        let motion = Sliding::of(self.recovery, x, alpha)?;
        let reach = motion.reach(self.recovery, &self.displacements(round)?, &round.held);
        Ok(self.moved(round, &motion, reach.min(1.0)))
    }

    fn moved(&self, round: &Round, motion: &Sliding, by: f64) -> Step {
        let mut b = round.next.clone();
        axpy(by, &self.negative.forced(&motion.alpha), &mut b);
        Step { b, x: round.x.clone(), is_trial: false }
    }

    fn displacements(&self, round: &Round) -> Result<Vec<f64>> {
        Ok(self.recovery.recover(&self.recovery.deformed(&round.x)?, &round.x, &round.alpha).u)
    }
}

/// The error for a motion along which the energy falls while closed rows stay closed, with the body that moves most.
fn indefinite(case: Case, own: &[f64], rate: f64) -> Error {
    let (ready, model) = (case.ready, case.model);
    let mut v = vec![0.0; model.sizes().dofs];
    ready.island.scatter(model, own, &mut v);
    let largest = norm_max(&v);
    v.iter_mut().for_each(|v| *v /= largest);
    let fastest = (0..v.len()).fold(0, |best, i| if v[i].abs() > v[best].abs() { i } else { best });
    let body = model.offsets[1..].partition_point(|end| *end <= fastest);
    let what = format!(
        "the answer is no minimum: K has negative stiffness along this motion, fastest at this dof, {rate:.1e} times the \
         resistance of closed rows"
    );
    let error = Error::new(Kind::Indefinite, what).body(body).dof(fastest - model.offsets[body]);
    error.value(rate).limit(1.0).proved_by(Proof::Motion { margin: 1.0 - 1.0 / rate, v })
}
