//! Data computed from a model, and the revisions of the model from which they were computed.

use std::collections::{BTreeMap, HashSet};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

use crate::body::{Asking, BodyElsewhere, Carried, Elsewhere, GeneralizedInverse, Lending, Owed, Token};
use crate::certificate::LoadOfWhole;
use crate::dual::{Kept, Ledger};
use crate::error::{Error, Kind, Result};
use crate::linalg::Operator;
use crate::model::{BodyRevisions, Parts, Revisions, SolvedModel};
use crate::progress::{Phase, PhaseReport, Phases};
use crate::setup::analysed::Analysed;
use crate::setup::operators::Operators;
use crate::setup::ready::Ready;

/// Factors of the bodies and dual problems of the islands. Data that do not belong to the present model are not returned.
#[derive(Default)]
pub struct Prepared {
    pub(super) bodies: Vec<PreparedBody>,
    pub(super) duals: Option<Duals>,
    /// Of bodies whose K+ is a function of the host: they decide when F_p is assembled.
    pub(super) ledgers: BTreeMap<usize, Arc<Ledger>>,
    pub work: Work,
    /// The ranks to which bodies may be lent.
    pub lending: Option<Lending>,
    /// How many times the dual problems have been made.
    pub made: usize,
}

/// Data computed for a body.
#[derive(Default)]
pub struct PreparedBody {
    of: BodyRevisions,
    /// Equal bodies share it.
    pub inverse: Option<Arc<Inverse>>,
    /// `F_p` of the previous rows, with K+ and while there is no dual problem.
    pub operator: Option<Box<Kept>>,
    /// The body on another rank.
    pub there: Option<Box<There>>,
    /// The rank that has the body, or had it with other values.
    pub rank: Option<u32>,
    /// Its carried unknowns: K+ holds them.
    pub carried: Option<Box<Carried>>,
    /// The last analysis of a matrix with this pattern.
    pub analysed: Option<Arc<Analysed>>,
    /// Keys of pattern and values, if already computed.
    pub keys: Option<[u64; 2]>,
}

/// A body on another rank.
pub struct There {
    /// Equal bodies share it.
    pub of: Arc<BodyElsewhere>,
    /// Its load there, and the hash key of its numbers.
    pub load: Mutex<Option<(Option<u64>, Arc<Token>)>>,
}

/// `K_p+` of the matrix divided by `unit`, the largest power of two that does not exceed its largest diagonal entry, and
/// its bytes.
pub struct Inverse {
    pub unit: f64,
    pub kplus: Arc<GeneralizedInverse>,
    /// Grounded unknowns of the matrix, which the certificate judges separately, ascending; none if K+ is on another rank.
    pub grounded: Option<Arc<[u32]>>,
    pub bytes: usize,
}

/// The dual problems of all islands, ready for any load and gap.
pub struct Duals {
    pub(super) of: Revisions,
    pub islands: Vec<Ready>,
    /// Choice of the operators of all bodies.
    pub operators: Operators,
    /// Island of every body.
    pub island_of: Vec<usize>,
    /// Of every body of the host that has several parts; empty if none has.
    pub loads: Vec<LoadOfWhole>,
}

/// Work of all setups since the problem was created: differences show the cost of a change of the data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Work {
    /// Symbolic analyses: ordering and pattern of a factor.
    pub analyses: usize,
    /// Numeric factorisations for K+.
    pub factorisations: usize,
    /// Columns of the dual operators F_p, one for each body touched by a row of the dual: computed columns, and columns
    /// kept from previous rows.
    pub columns_computed: usize,
    pub columns_kept: usize,
}

impl Inverse {
    /// The rank that keeps K+.
    pub fn rank(&self) -> usize {
        self.kplus.elsewhere().map_or(0, Elsewhere::rank)
    }
}

impl Prepared {
    /// The dual problems of the present model, if made.
    pub fn duals(&self, model: &SolvedModel) -> Option<&Duals> {
        self.duals.as_ref().filter(|duals| duals.of == model.revisions)
    }

    /// The dual problems made last, for any revision.
    pub fn made_last(&self) -> Option<&Duals> {
        self.duals.as_ref()
    }

    /// Drops the data that solves with friction have left for the next solve.
    pub fn forget_pairs(&mut self) {
        let islands = self.duals.iter().flat_map(|duals| &duals.islands);
        islands.filter_map(|ready| ready.pairs.as_ref()).for_each(|pairs| pairs.forget());
    }

    /// Work of all setups, and of operators that were assembled during solves.
    pub fn work(&self) -> Work {
        let later: usize = self.ledgers.values().map(|ledger| ledger.assembled.load(Ordering::Relaxed)).sum();
        Work { columns_computed: self.work.columns_computed + later, ..self.work }
    }

    /// Drops all data: the numbers of the bodies have changed.
    pub fn forget(&mut self) {
        self.work = self.work();
        (self.bodies, self.duals, self.ledgers) = (Vec::new(), None, BTreeMap::new());
    }

    /// As `duals`, after a setup.
    pub fn done(&self, model: &SolvedModel) -> Result<&Duals> {
        self.duals(model).ok_or_else(|| Error::new(Kind::Internal, "the setup left nothing"))
    }

    /// The load of the host's body to which a body belongs.
    pub fn load_of_whole(&self, model: &SolvedModel, body: usize) -> LoadOfWhole {
        let of = |parts: &Arc<Parts>| Some(self.duals.as_ref()?.loads[parts.parts[body].body]);
        model.parts.as_ref().and_then(of).unwrap_or_default()
    }

    /// K+ of the present body, if made.
    pub fn inverse(&self, model: &SolvedModel, body: usize) -> Option<&Arc<Inverse>> {
        let own = self.bodies.get(body).filter(|own| own.of == model.bodies[body].revisions);
        own?.inverse.as_ref()
    }

    /// Drops data of old revisions, except data that can be reused.
    pub fn follow(&mut self, model: &SolvedModel) {
        if self.lending.as_ref().is_some_and(|lending| lending.is_over()) {
            self.take_back();
        }
        if self.duals(model).is_none() {
            self.release();
        }
        self.bodies.resize_with(model.bodies.len(), PreparedBody::default);
        for (own, given) in self.bodies.iter_mut().zip(&model.bodies) {
            let now = given.revisions;
            if own.of.analysed != now.analysed {
                (own.analysed, own.rank) = (None, None);
            }
            own.keys.take_if(|_| own.of.stiffness != now.stiffness);
            if own.of != now {
                (own.inverse, own.operator, own.there, own.of) = (None, None, None, now);
            }
        }
    }

    /// Other ranks serve no longer: what they kept is lost.
    fn take_back(&mut self) {
        let is_lost = |own: &PreparedBody| own.there.is_some();
        if self.bodies.iter().any(is_lost) {
            self.duals = None;
        }
        for own in self.bodies.iter_mut().filter(|own| is_lost(own)) {
            (own.inverse, own.operator, own.there, own.rank) = (None, None, None, None);
        }
        self.lending = None;
    }

    /// Asks other ranks about these bodies.
    pub(super) fn ask(&self, questions: Vec<(usize, Asking)>) -> Result<Owed> {
        match &self.lending {
            Some(lending) if !questions.is_empty() => lending.ask(questions),
            _ => Ok(Owed::nothing()),
        }
    }

    /// Takes the carried unknowns of every body; drops K+ of those that hold others.
    pub(super) fn carry(&mut self, carried: Vec<Option<Box<Carried>>>) {
        for (own, carried) in self.bodies.iter_mut().zip(carried) {
            if own.carried != carried {
                (own.inverse, own.operator, own.carried) = (None, None, carried);
            }
        }
    }

    /// Drops the dual problems; their operators are kept for later rows.
    pub(super) fn release(&mut self) {
        for ready in self.duals.take().into_iter().flat_map(|duals| duals.islands) {
            for (p, operator) in ready.island.bodies.iter().zip(ready.dual.operators()) {
                let own = &mut self.bodies[*p];
                own.operator = operator.filter(|_| own.inverse.is_some());
            }
        }
    }

    /// Bytes of all factors, shared factors counted once.
    pub(super) fn bytes_of_factors(&self) -> usize {
        let inverses = self.bodies.iter().filter_map(|own| own.inverse.as_ref());
        let mut seen = HashSet::new();
        inverses.filter(|of| seen.insert(of.kplus.factor_address())).map(|of| of.bytes).sum()
    }

    /// The times of the phases, with the memory that is kept.
    pub fn phases(&self, model: &SolvedModel, phases: &Phases) -> Vec<PhaseReport> {
        let mut phases = *phases;
        if let Some(duals) = self.duals(model) {
            let islands = &duals.islands;
            phases.keeps(Phase::Factorisation, duals.operators.factor_bytes);
            phases.keeps(Phase::DualOperators, islands.iter().map(|ready| ready.dual.bytes_kept()).sum());
            let preconditioners = islands.iter().filter_map(|ready| ready.preconditioner.as_ref());
            phases.keeps(Phase::Preconditioner, preconditioners.map(|made| made.1.bytes_kept()).sum());
        }
        phases.report()
    }

    /// Rows carry unknowns of the body.
    #[cfg(test)]
    pub fn carries(&self, body: usize) -> bool {
        self.bodies[body].carried.is_some()
    }

    /// Sets the keys of all bodies independently of their matrices.
    #[cfg(test)]
    pub fn set_keys(&mut self, model: &SolvedModel, keys: impl Fn(usize) -> [u64; 2]) {
        self.follow(model);
        self.bodies.iter_mut().enumerate().for_each(|(p, own)| own.keys = Some(keys(p)));
    }
}
