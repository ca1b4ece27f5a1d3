//! The stop: P1 of docs/method.md.

use crate::linalg::vector::norm;
use crate::qp::proportioning::iterate::Iterate;
use crate::qp::Verdict;

/// A scale so many times the one without travel is travel.
const TRAVEL: f64 = 10.0;
/// A point refused for less than this much is mended by some more steps.
const MISSED: f64 = 1e3;
/// How often the tolerance is tightened when the judge does not accept.
const TIGHTENINGS: usize = 8;
/// A refusal that is still so large against the one before does not follow the residual.
const STAYS: f64 = 0.5;

/// When the residual is small enough, or no longer worth reducing.
pub struct Stop {
    pub residual: f64,
    /// Share of the allowance for rounding that counts.
    pub noise: f64,
    tightenings: usize,
    refined: bool,
    /// What the last refusal told.
    missed: Option<f64>,
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
            missed: None,
            best: f64::INFINITY,
            met: 0,
            face: Vec::new(),
        }
    }

    /// P1, the plateau: no conjugate gradient step has halved the residual of this face for longer than exact arithmetic
    /// would need to solve it: rounding errors have taken over.
    pub fn plateau(&mut self, it: &Iterate) -> bool {
        let (steps, residual) = (it.counts.steps(), norm(&it.split.free));
        if self.face != it.split.active || residual < 0.5 * self.best {
            (self.best, self.met) = (residual, steps);
            self.face.clone_from(&it.split.active);
        }
        let unknowns = it.split.active.iter().filter(|active| !**active).count();
        steps - self.met > 2 * unknowns + 20
    }

    /// P1.2: once, where all that the residual was measured against is travel: from now on it is measured against the rest.
    pub fn refine(&mut self, tolerance: f64, length: Option<f64>) -> bool {
        let target = length.map_or(f64::INFINITY, |length| tolerance * length);
        let refines = !self.refined && TRAVEL * target < self.residual;
        if refines {
            self.residual = target;
        }
        self.refined |= refines;
        refines
    }

    /// P1.3: what the point is refused for is about as large as at the refusal before, when the residual was larger.
    pub fn stays(&mut self, missed: Option<f64>) -> bool {
        let before = std::mem::replace(&mut self.missed, missed);
        missed.zip(before).is_some_and(|(now, before)| now > STAYS * before)
    }

    /// P1.4: at the first two refusals, by as much as they tell; false where that is more than steps without rounding could mend.
    pub fn tighten_by(&mut self, missed: Option<f64>) -> bool {
        let missed = missed.filter(|missed| *missed < MISSED && self.tightenings < 2);
        if let Some(missed) = missed {
            self.tightenings += 1;
            self.residual *= (0.4 / missed).min(0.4);
        }
        missed.is_some()
    }

    /// P1.5: the verdict; none where target and allowance for rounding have become a tenth, and the run goes on.
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
