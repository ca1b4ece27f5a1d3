//! What a problem keeps besides its data: the last answer, the start of the next solve, saved states.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::constraints::{Friction, RowKind, RowSet};
use crate::solve::{Answer, Start};

#[derive(Default)]
pub struct History {
    /// The answer of the last solve, where it gave one.
    pub current: Option<Current>,
    /// Which rows it is about: their revision.
    rows: u64,
    /// Start of the next solve, given by the host: multipliers of contact, equality and tangential rows, force.
    pub start: [Option<Vec<f64>>; 3],
    /// The last answer for the present rows; it outlives a change of a matrix.
    pub previous: Option<Arc<Answer>>,
    pub states: BTreeMap<usize, State>,
    /// Number of states saved so far.
    pub saved: usize,
}

/// An answer, by which dual problems it was found, and what was made of it once somebody has asked.
pub struct Current {
    pub answer: Arc<Answer>,
    /// Number of times that the dual problems had been made.
    pub made: usize,
    /// Motions that it leaves open, over the modes of one island each.
    pub open_motions: Option<Vec<(usize, Vec<f64>)>>,
    /// Forces of the rows of one kind, or of both, on all bodies.
    pub reactions: Option<(Option<RowKind>, Vec<f64>)>,
}

/// Loads, rows and multipliers; never factors.
pub struct State {
    /// Revision of the matrices.
    pub bodies: u64,
    /// Of every body, where it has one.
    pub loads: Vec<Option<Vec<f64>>>,
    /// Contact and equality rows, with c, h and 1/k.
    pub rows: [RowSet; 2],
    /// Nodes with friction: their laws, tangential rows, s_old and compliances.
    pub friction: Friction,
    pub previous: Option<Arc<Answer>>,
    /// `previous` was the answer for exactly these data.
    pub answered: bool,
}

impl Current {
    pub fn new(answer: Arc<Answer>, made: usize) -> Self {
        Self { answer, made, open_motions: None, reactions: None }
    }
}

impl History {
    /// Of these rows, by their revision: multipliers of others are none of theirs.
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

    /// Where the next solve starts: given values, which are used up, or else the last answer, if that is wanted.
    pub fn take_start(&mut self, previous: bool) -> Start {
        let given = std::mem::take(&mut self.start);
        Start { given, previous: self.previous.clone().filter(|_| previous) }
    }
}
