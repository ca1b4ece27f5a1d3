//! What a problem keeps in addition to its data: the last answer, the start of the next solve, saved states.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::constraints::{Friction, RowKind, RowSet, Table};
use crate::model::{Pairs, SolvedModel};
use crate::solve::{Answer, Start};

#[derive(Default)]
pub struct History {
    /// The answer of the last solve, if it gave one.
    pub current: Option<Current>,
    /// Revision of the rows to which these values belong.
    rows: u64,
    /// Start of the next solve, given by the host: multipliers of contact, equality and tangential rows, force.
    pub start: [Option<Vec<f64>>; 3],
    /// The last answer for the present rows; it remains after a change of a matrix.
    pub previous: Option<Arc<Answer>>,
    pub states: BTreeMap<usize, State>,
    /// Number of states saved so far.
    pub saved: usize,
    /// How often slips were committed.
    pub commits: u64,
}

/// An answer, the dual problems it belongs to, and results computed from it on request.
pub struct Current {
    pub answer: Arc<Answer>,
    /// How many times the dual problems had been made at that time.
    pub made: usize,
    /// Motions that the answer leaves undetermined, each over the modes of one island.
    pub open_motions: Option<Vec<(usize, Vec<f64>)>>,
    /// Reactions on all bodies, of the rows of one kind or of both kinds.
    pub reactions: Option<(Option<RowKind>, Vec<f64>)>,
}

/// Loads, rows and multipliers; never factors.
pub struct State {
    /// Revision of the matrices.
    pub bodies: u64,
    /// Loads of the bodies that have one.
    pub loads: Vec<Option<Box<[f64]>>>,
    /// Contact and equality rows, with c, h and 1/k.
    pub rows: [RowSet; 2],
    /// Surfaces at their positions, and what nodes have met and keep.
    pub pairs: Pairs,
    /// Nodes with friction: their laws, tangential rows, s_old and compliances.
    pub friction: Friction,
    /// What these rows are in the host's table of unknowns.
    pub table: Option<Arc<Table>>,
    pub previous: Option<Arc<Answer>>,
    /// `previous` was the answer for exactly these data.
    pub answered: bool,
}

impl State {
    /// Its rows are those of a model but for right-hand sides and laws.
    pub fn is_of(&self, model: &SolvedModel) -> bool {
        let [contact, equalities] = &self.rows;
        model.contact.same_but_rhs(contact)
            && model.equalities.same_but_rhs(equalities)
            && model.friction.same_but_law(&model.contact, &self.friction, contact)
    }
}

impl Current {
    pub fn new(answer: Arc<Answer>, made: usize) -> Self {
        Self { answer, made, open_motions: None, reactions: None }
    }
}

impl History {
    /// The history for rows of this revision: multipliers of other rows are dropped.
    pub fn of(&mut self, rows: u64) -> &mut Self {
        if self.rows != rows {
            (self.rows, self.start, self.previous) = (rows, [None, None, None], None);
        }
        self
    }

    pub fn keep(&mut self, answer: Answer, made: usize) {
        let answer = Arc::new(answer);
        self.previous = Some(Arc::clone(&answer));
        self.current = Some(Current::new(answer, made));
    }

    /// Start values of the host, which are used only once.
    pub fn given_start(&mut self) -> Vec<Option<Vec<f64>>> {
        std::mem::take(&mut self.start).into()
    }

    /// The start of the next solve: the given values, which are used only once, otherwise the last answer if `previous`.
    pub fn take_start(&mut self, previous: bool) -> Start {
        let given = std::mem::take(&mut self.start);
        Start { given, previous: self.previous.clone().filter(|_| previous) }
    }
}
