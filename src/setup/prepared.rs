//! What has been computed from a model, and from which revisions of the model.

use std::collections::HashSet;
use std::sync::Arc;

use crate::body::{GeneralizedInverse, Symbolic};
use crate::dual::Kept;
use crate::error::{Error, Kind, Result};
use crate::linalg::Operator;
use crate::model::{BodyRevisions, Model, Revisions};
use crate::progress::{Phase, PhaseReport, Phases};
use crate::setup::operators::Operators;
use crate::setup::ready::Ready;

/// Factors of the bodies and dual problems of the islands. What does not belong to the model as it is now is not handed out.
#[derive(Default)]
pub struct Prepared {
    pub(super) bodies: Vec<PreparedBody>,
    pub(super) duals: Option<Duals>,
    pub work: Work,
    /// Number of times that the dual problems have been made.
    pub made: usize,
}

/// What has been computed of a body.
#[derive(Default)]
pub struct PreparedBody {
    of: BodyRevisions,
    pub inverse: Option<Inverse>,
    /// The last analysis of a matrix with the pattern of this one.
    pub symbolic: Option<Arc<Symbolic>>,
    /// Keys of pattern and values, once they have been asked for.
    pub keys: Option<[u64; 2]>,
}

/// `K_p+` of the matrix divided by `unit`, the power of two below its largest diagonal entry, and the bytes it takes;
/// equal bodies have one.
pub struct Inverse {
    pub unit: f64,
    pub kplus: Arc<GeneralizedInverse>,
    /// Unknowns of the matrix that the certificate measures by themselves, ascending.
    pub grounded: Arc<[u32]>,
    pub bytes: usize,
    /// `F_p` of the rows before the present ones, while there is no dual problem.
    pub operator: Option<Kept>,
}

/// The dual problems of all islands, ready for any load and gap.
pub struct Duals {
    pub(super) of: Revisions,
    pub islands: Vec<Ready>,
    /// Of all bodies.
    pub operators: Operators,
    /// Island of every body.
    pub island_of: Vec<usize>,
}

/// Work of all setups since the problem was created: what a change of the data costs shows in the difference.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Work {
    /// Symbolic analyses: ordering and pattern of a factor.
    pub analyses: usize,
    /// Numeric factorisations for K+.
    pub factorisations: usize,
    /// Columns of the dual operators F_p, one for each body that a row of the dual touches: computed, and kept from the
    /// rows before.
    pub columns_computed: usize,
    pub columns_kept: usize,
}

impl Prepared {
    /// The dual problems of the model as it is, where they have been made.
    pub fn duals(&self, model: &Model) -> Option<&Duals> {
        self.duals.as_ref().filter(|duals| duals.of == model.revisions)
    }

    /// The dual problems made last, of whatever revision.
    pub fn made_last(&self) -> Option<&Duals> {
        self.duals.as_ref()
    }

    /// Drops the pairs of friction that solves have left: the next one depends on none of them.
    pub fn forget_pairs(&mut self) {
        self.duals.iter().flat_map(|duals| &duals.islands).for_each(|ready| ready.pairs.forget());
    }

    /// Drops all that has been computed: the bodies have other numbers.
    pub fn forget(&mut self) {
        (self.bodies, self.duals) = (Vec::new(), None);
    }

    /// The same where a setup has just been done.
    pub fn done(&self, model: &Model) -> Result<&Duals> {
        self.duals(model).ok_or_else(|| Error::new(Kind::Internal, "the setup left nothing"))
    }

    /// K+ of a body as it is, where it has been made.
    pub fn inverse(&self, model: &Model, body: usize) -> Option<&Inverse> {
        let own = self.bodies.get(body).filter(|own| own.of == model.bodies[body].revisions);
        own?.inverse.as_ref()
    }

    /// Drops what was computed of revisions that are no longer: all but what serves those to come.
    pub fn follow(&mut self, model: &Model) {
        if self.duals(model).is_none() {
            self.release();
        }
        self.bodies.resize_with(model.bodies.len(), PreparedBody::default);
        let mut changed = false;
        for (own, given) in self.bodies.iter_mut().zip(&model.bodies) {
            let now = given.revisions;
            own.symbolic.take_if(|_| own.of.analysed != now.analysed);
            own.keys.take_if(|_| own.of.stiffness != now.stiffness);
            own.inverse.take_if(|_| own.of != now);
            changed |= own.of != now;
            own.of = now;
        }
        if changed {
            let inverses = self.bodies.iter_mut().filter_map(|own| own.inverse.as_mut());
            inverses.filter_map(|inverse| inverse.operator.as_mut()).for_each(Kept::only_whole);
        }
    }

    /// Gives up the dual problems; their operators are kept for rows to come.
    pub(super) fn release(&mut self) {
        for ready in self.duals.take().into_iter().flat_map(|duals| duals.islands) {
            for (p, operator) in ready.island.bodies.into_iter().zip(ready.dual.into_operators()) {
                if let Some(inverse) = &mut self.bodies[p].inverse {
                    inverse.operator = operator;
                }
            }
        }
    }

    /// Bytes of all factors, those that bodies share once.
    pub(super) fn bytes_of_factors(&self) -> usize {
        let inverses = self.bodies.iter().filter_map(|own| own.inverse.as_ref());
        let mut seen = HashSet::new();
        inverses.filter(|of| seen.insert(of.kplus.factor_address())).map(|of| of.bytes).sum()
    }

    /// These times with the memory that is kept.
    pub fn phases(&self, model: &Model, phases: &Phases) -> Vec<PhaseReport> {
        let mut phases = *phases;
        if let Some(duals) = self.duals(model) {
            let islands = &duals.islands;
            phases.keeps(Phase::Factorisation, duals.operators.factor_bytes);
            phases.keeps(Phase::DualOperators, islands.iter().map(|ready| ready.dual.bytes_kept()).sum());
            let preconditioners = islands.iter().filter_map(|ready| ready.preconditioner.as_ref());
            phases.keeps(Phase::Preconditioner, preconditioners.map(|(_, made)| made.bytes_kept()).sum());
        }
        phases.report()
    }

    /// Keys of all bodies, whatever their matrices.
    #[cfg(test)]
    pub fn set_keys(&mut self, model: &Model, keys: impl Fn(usize) -> [u64; 2]) {
        self.follow(model);
        self.bodies.iter_mut().enumerate().for_each(|(p, own)| own.keys = Some(keys(p)));
    }
}
