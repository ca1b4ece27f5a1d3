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
//! which ignores open rows: if the energy has risen, the previous answer is followed without it. If the face is too large
//! for dense factors, the rounds continue without Newton steps and converge at the rate rho.

use crate::body::Kept;
use crate::error::{Error, Kind, Proof, Result};
use crate::linalg::vector::{axpy, dot, NOISE};
use crate::numbers::solve::SAME_ENERGY;
use crate::qp::friction::unheld;
use crate::qp::{Qp, Rung, Solution, Verdict};
use crate::solve::case::Case;
use crate::solve::fallback::MethodOptions;
use crate::solve::feedback::{Feedback, NegativeMotions};
use crate::solve::friction::cones;
use crate::solve::recovery::{Recovered, Recovery};
use crate::solve::sliding::Sliding;

/// Limit of rounds.
const ROUNDS: usize = 60;
/// After this number of rounds on one face, an answer that passes the certificate is accepted although its amplitudes
/// still change.
const STRICT: usize = 2;
/// This limit applies to all rounds if there are no Newton steps.
const STRICT_ALONE: usize = 20;
/// After this number of Newton rounds on one face, or of rounds that do not lower the energy, only rounding is left between the rounds.
const MENDED: usize = 4;

/// Where a round begins.
pub struct Step {
    pub b: Vec<f64>,
    pub x: Vec<f64>,
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
    energy: Energy,
    /// None if the face is too large for dense factors.
    feedback: Option<Feedback<'a>>,
}

/// What falls from round to round without friction: `1/2 u'K u - f'u` up to a constant, and the size of its terms.
#[derive(Clone, Copy)]
struct Energy {
    value: f64,
    terms: f64,
}

/// What the rounds so far have found.
#[derive(Default)]
pub struct Known<'a> {
    pub rounds: usize,
    /// Successive rounds on one face.
    same: usize,
    /// The lowest energy, and the successive rounds that have left neither their face nor this energy.
    lowest: Option<Energy>,
    still: usize,
    /// The last round, not counting trials whose energy has risen.
    last: Option<Round<'a>>,
}

/// What follows a round.
pub enum Next {
    Step(Step),
    /// Only rounding is left between rounds: the answer is corrected by the data of the host; if that fails, this step
    /// follows.
    Mend(Step),
    End(Verdict),
}

/// What the rounds are judged with.
pub struct Search<'a, 'b> {
    pub case: Case<'a>,
    pub means: &'b MethodOptions<'a>,
    pub qp: Qp<'a>,
    pub negative: &'b NegativeMotions,
    pub recovery: &'b Recovery<'a>,
}

impl Step {
    /// a = 0
    pub fn first(negative: &NegativeMotions, x: Vec<f64>) -> Self {
        Self { b: vec![0.0; negative.modes.len()], x, is_trial: false }
    }
}

impl<'a> Known<'a> {
    /// Counts a round; the last one if it had the same face.
    fn count(&mut self, round: &Round) -> Option<&Round<'a>> {
        self.rounds += 1;
        let is_same = self.last.as_ref().is_some_and(|last| last.held == round.held);
        self.same = if is_same { self.same + 1 } else { 0 };
        let falls = self.lowest.is_none_or(|lowest| lowest.is_above(round.energy));
        if falls {
            self.lowest = Some(round.energy);
        }
        self.still = if is_same || !falls { self.still + 1 } else { 0 };
        self.last.as_ref().filter(|_| is_same)
    }

    /// An accepted answer must also have settled amplitudes.
    pub fn is_strict(&self) -> bool {
        match &self.last {
            Some(Round { feedback: Some(_), .. }) => self.same < STRICT,
            Some(_) => self.rounds < STRICT_ALONE,
            None => true,
        }
    }
}

impl Round<'_> {
    /// The next step without Newton's method.
    fn followed(&self) -> Step {
        Step { b: self.next.clone(), x: self.x.clone(), is_trial: false }
    }
}

impl Energy {
    fn is_above(self, other: Self) -> bool {
        self.value > other.value + SAME_ENERGY * (self.terms + other.terms)
    }
}

impl<'a> Search<'a, '_> {
    /// What follows a round with an answer; an error is the proof that there is no minimum.
    pub fn after(
        &self,
        known: &mut Known<'a>,
        step: &Step,
        found: (&Solution, Vec<bool>),
        unsettled: bool,
    ) -> Result<Next> {
        let round = self.round(step, found)?;
        let falling = self.falling(&round, known.count(&round), unsettled)?;
        match &falling {
            None if !unsettled => return Ok(Next::End(Verdict::Solved)),
            // with friction there is no way downhill
            Some((motion, rate)) if !unsettled && (self.recovery.friction || known.rounds >= ROUNDS) => {
                return Err(indefinite(self.case, &motion.v.of, *rate)?)
            }
            None if known.same > MENDED && round.feedback.is_some() && !self.recovery.friction => {
                return Ok(Next::End(Verdict::Stalled))
            }
            _ if known.rounds >= ROUNDS => return Ok(Next::End(Verdict::Stalled)),
            _ => {}
        }
        // with friction there is no energy
        let judges = step.is_trial && !self.recovery.friction;
        let before = known.last.as_ref().filter(|last| judges && round.energy.is_above(last.energy));
        let next = match (before, &falling) {
            (Some(last), _) => last.followed(),
            (None, Some((motion, rate))) => self.along(&round, (motion, *rate), !unsettled)?,
            (None, None) => self.settled(&round, known.same)?,
        };
        let rests = round.feedback.as_ref().is_some_and(|feedback| feedback.rate() < 1.0)
            && (known.same == MENDED || known.still == MENDED);
        let is_to_mend = falling.is_none() && (self.recovery.friction || rests);
        if before.is_none() {
            known.last = Some(round);
        }
        Ok(if is_to_mend { Next::Mend(next) } else { Next::Step(next) })
    }

    /// Whether the energy falls along no motion that keeps the closed rows of a corrected answer closed.
    pub fn is_minimum(&self, step: &Step, solution: &Solution) -> Result<bool> {
        let held = match self.recovery.friction {
            true => {
                let u = self.displacements(&solution.x, &solution.alpha)?.u;
                self.recovery.held_with_friction(&u.at_rows, &solution.x)?
            }
            false => self.qp.at_bound(&solution.x),
        };
        let round = self.round(step, (solution, held))?;
        Ok(self.falling(&round, None, false)?.is_none())
    }

    /// What follows a round without an answer: no forces balance its load if the energy falls without end.
    pub fn without_answer(&self, known: &mut Known<'a>, step: &Step, solution: &Solution) -> Result<Next> {
        known.rounds += 1;
        if matches!(solution.verdict, Verdict::Infeasible { .. }) && Rung::FirstProof.is_tried() {
            let e = self.negative.resultants(self.qp.e, &step.b);
            if let Some(motion) = self.unstopped(Qp { e: &e, ..self.qp }, &solution.x)? {
                return Err(indefinite(self.case, &motion.v.of, f64::INFINITY)?);
            }
        }
        match &known.last {
            _ if known.rounds == 1 => Ok(Next::End(solution.verdict.clone())),
            _ if known.rounds >= ROUNDS || !step.is_trial => Ok(Next::End(Verdict::Stalled)),
            Some(last) => Ok(Next::Step(last.followed())),
            None => Ok(Next::Step(Step::first(self.negative, solution.x.clone()))),
        }
    }

    /// The motion along which forces x leave a load that none hold, if the energy falls along it without end.
    fn unstopped(&self, qp: Qp, x: &[f64]) -> Result<Option<Sliding>> {
        let (ready, scaled) = (self.case.ready, self.recovery.scaled);
        let (rows, sizes) = ((0..x.len()).collect::<Vec<_>>(), ready.dual.sizes_of_modes());
        let (_, rest) = unheld(&qp, &cones(ready, &scaled.gaps, &rows)?, &sizes)?;
        let left = rest.iter().zip(&sizes).map(|(e, size)| size * size * e).collect();
        let motion = Sliding::of(self.recovery, vec![0.0; x.len()], left)?;
        Ok(motion.falls_beside_forces(self.recovery).then_some(motion))
    }

    fn round(&self, step: &Step, (solution, held): (&Solution, Vec<bool>)) -> Result<Round<'a>> {
        let Solution { x, alpha, .. } = solution;
        let next: Vec<f64> = self.negative.forced(alpha);
        let change = minus(&next, &step.b);
        let parts = [dot(self.qp.b, x), -dot(self.qp.e, alpha), dot(&next, &step.b), -dot(&next, &next)]
            .map(|part| 0.5 * part);
        let energy = Energy { value: parts.iter().sum(), terms: parts.iter().map(|part| part.abs()).sum() };
        let feedback = Feedback::of(self.means.direct, self.qp, &held, self.negative)?;
        Ok(Round { x: x.clone(), alpha: alpha.clone(), held, next, change, energy, feedback })
    }

    /// A motion along which the energy falls while the rows of the face stay closed, and its rate; `last` had the same
    /// face. While the amplitudes are `unsettled` only their change leads downhill: slips that allow only the other sense allow none.
    fn falling(
        &self,
        round: &Round,
        last: Option<&Round>,
        unsettled: bool,
    ) -> Result<Option<(Sliding, f64)>> {
        let found = match self.negative.free(self.qp, &round.held)? {
            Some(alpha) => Some((vec![0.0; round.x.len()], alpha, f64::INFINITY)),
            None => match (&round.feedback, last) {
                (Some(feedback), _) => {
                    (1.0 - feedback.rate() < NOISE).then(|| feedback.motion(round.x.len()))
                }
                (None, Some(last)) => {
                    let rate = (dot(&round.change, &round.change) / dot(&last.change, &last.change)).sqrt();
                    (rate >= 1.0).then(|| (minus(&round.x, &last.x), minus(&round.alpha, &last.alpha), rate))
                }
                (None, None) => None,
            },
        };
        let Some((x, alpha, rate)) = found else { return Ok(None) };
        let mut motion = Sliding::of(self.recovery, x, alpha)?;
        if dot(&round.change, &self.negative.forced(&motion.alpha)) < 0.0 {
            motion.turn(self.recovery)?;
        }
        if self.recovery.friction && !motion.slips_on(self.recovery, &round.x, &round.held) {
            motion.turn(self.recovery)?;
            if unsettled || !motion.slips_on(self.recovery, &round.x, &round.held) {
                return Ok(None);
            }
        }
        Ok(motion.falls(self.recovery, &round.held).then_some((motion, rate)))
    }

    /// The next step: along a motion on which the energy falls, up to the row that stops it. From an equilibrium it falls in both
    /// senses, and farther in that which rows stop later.
    fn along(&self, round: &Round, (motion, rate): (&Sliding, f64), is_equilibrium: bool) -> Result<Step> {
        let u = self.displacements(&round.x, &round.alpha)?.u;
        let mut reach = motion.reach(self.recovery, &u.at_rows, &round.held, 1.0);
        if is_equilibrium {
            let back = motion.reach(self.recovery, &u.at_rows, &round.held, -1.0);
            reach = if back > reach { -back } else { reach };
        }
        if reach.is_infinite() {
            return Err(indefinite(self.case, &motion.v.of, rate)?);
        }
        let mut next = round.followed();
        axpy(reach, &self.negative.forced(&motion.alpha), &mut next.b);
        Ok(next)
    }

    /// The next step: the Newton step to the fixed point of the face. If the answers move away from it, each of the steps of `same`
    /// rounds on one face is twice the last.
    fn settled(&self, round: &Round, same: usize) -> Result<Step> {
        let mut next = round.followed();
        let Some(feedback) = &round.feedback else { return Ok(next) };
        if feedback.rate() >= 1.0 {
            axpy(2f64.powi(same as i32) - 1.0, &round.change, &mut next.b);
            return Ok(next);
        }
        if !Rung::Trial.is_tried() {
            return Ok(next);
        }
        let b = feedback.settled(&round.next, &round.change);
        let (x, _) = feedback.point(self.qp, &self.negative.resultants(self.qp.e, &b))?;
        let x = (0..x.len()).map(|i| if self.qp.bounded[i] { x[i].max(0.0) } else { x[i] }).collect();
        Ok(Step { b, x, is_trial: true })
    }

    fn displacements(&self, x: &[f64], alpha: &[f64]) -> Result<Recovered> {
        self.recovery.recover(&self.recovery.deformed(x)?, x, alpha)
    }
}

/// The error for a motion along which the energy falls while closed rows stay closed, with the body that moves most.
fn indefinite(case: Case, own: &Kept, rate: f64) -> Result<Error> {
    let (v, body, dof) = case.fastest(case.locals()?.bring(own)?)?;
    let what = format!(
        "the answer is no minimum: K has negative stiffness along this motion, fastest at this dof, {rate:.1e} times the \
         resistance of closed rows"
    );
    let error = Error::new(Kind::Indefinite, what).body(body).dof(dof);
    Ok(error.value(rate).limit(1.0).proved_by(Proof::Motion { margin: 1.0 - 1.0 / rate, v }))
}

/// `x - y`
fn minus(x: &[f64], y: &[f64]) -> Vec<f64> {
    x.iter().zip(y).map(|(x, y)| x - y).collect()
}
