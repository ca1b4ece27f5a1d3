//! The stop: P1 of docs/method.md.

use crate::linalg::vector::norm;
use crate::numbers::qp::{BY_MISSED, MISSED, STAYS, TIGHTER};
use crate::qp::proportioning::iterate::Iterate;
use crate::qp::{Rung, Verdict};

/// How many times the tolerance is tightened if the point is not accepted, first by the violation.
const TIGHTENINGS: usize = 8;
const BY_VIOLATION: usize = 2;
/// Limit of steps without gain: a solve that goes on without is not ended by more of them.
const PLATEAU: usize = 50;

/// Decides whether the residual is small enough, or cannot be reduced further.
pub struct Stop {
    residual: f64,
    /// Part of the energy norm of x that the residual may have, no unit.
    share: f64,
    /// Factor on the allowance for rounding.
    noise: f64,
    tightenings: usize,
    /// Violation reported by the last refusal.
    missed: Option<f64>,
    /// Smallest residual on the current face, the number of steps at that time, and the face.
    best: f64,
    met: usize,
    face: Vec<bool>,
}

impl Stop {
    pub fn new(residual: f64, share: f64) -> Self {
        Self {
            residual,
            share,
            noise: 1.0,
            tightenings: 0,
            missed: None,
            best: f64::INFINITY,
            met: 0,
            face: Vec::new(),
        }
    }

    /// P1: eps_x.
    pub fn small(&self, it: &Iterate) -> f64 {
        self.residual.max(self.share * it.energy()) + self.noise * it.noise()
    }

    /// P1, the plateau: the residual of this face has not been halved during more conjugate gradient steps than exact
    /// arithmetic would need to solve it, so rounding dominates.
    pub fn plateau(&mut self, it: &Iterate) -> bool {
        let (steps, residual) = (it.counts.steps(), norm(&it.split.free));
        if self.face != it.split.active || residual < 0.5 * self.best {
            (self.best, self.met) = (residual, steps);
            self.face.clone_from(&it.split.active);
        }
        let unknowns = it.split.active.iter().filter(|active| !**active).count();
        steps - self.met > (2 * unknowns + 20).min(PLATEAU) && Rung::Plateau.is_tried()
    }

    /// P1.2: the violation is about as large as at the previous refusal, when the residual was larger.
    pub fn stays(&mut self, missed: Option<f64>) -> bool {
        let before = std::mem::replace(&mut self.missed, missed);
        missed.zip(before).is_some_and(|(now, before)| now > STAYS * before)
    }

    /// P1.3: tightens by the reported violation; false if steps cannot correct a violation of this size.
    pub fn tighten_by(&mut self, missed: Option<f64>, it: &Iterate) -> bool {
        // the energy of all bodies may be far above that of the one that was refused
        let by_energy = self.share * it.energy() > self.residual;
        let can = |missed: &f64| by_energy || *missed < MISSED && self.tightenings < BY_VIOLATION;
        let missed = missed.filter(can).filter(|_| Rung::TightenBy.is_tried());
        if let Some(missed) = missed {
            let part = (BY_MISSED / missed).min(BY_MISSED);
            self.share *= part;
            if !by_energy {
                self.tightenings += 1;
                self.residual *= part;
            }
        }
        missed.is_some()
    }

    /// P1.4: the verdict; none if the target and the allowance for rounding were reduced to a tenth and the run
    /// continues.
    pub fn tighten(&mut self, accepted: bool) -> Option<Verdict> {
        if accepted {
            return Some(Verdict::Solved);
        }
        if self.tightenings == TIGHTENINGS || !Rung::Tighten.is_tried() {
            return Some(Verdict::Inaccurate);
        }
        self.tightenings += 1;
        self.residual *= TIGHTER;
        self.share *= TIGHTER;
        self.noise *= TIGHTER;
        None
    }
}
