//! Where a solve starts, and states of a problem to come back to when a load step is rejected.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::constraints::{RowKind, RowSet};
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::first_non_finite;
use crate::platform::memory::{copied, zeros};
use crate::solver::problem::Problem;
use crate::solver::results::{Answer, Asked};
use crate::solver::setup::Ready;
use crate::solver::words::StartFrom;

/// What a problem remembers besides its data.
#[derive(Default)]
pub(super) struct History {
    /// Start of the next solve, given by the host: multipliers of contact and equality rows, force.
    start: [Option<Vec<f64>>; 2],
    /// The last answer for the present rows; it outlives a change of a matrix.
    previous: Option<Arc<Answer>>,
    states: BTreeMap<usize, State>,
    /// Number of states saved so far.
    saved: usize,
    /// Counted up with every change of a matrix or a null space.
    data: u64,
}

/// Loads, rows and multipliers; never factors.
struct State {
    data: u64,
    /// Of every body, where it has one.
    loads: Vec<Option<Vec<f64>>>,
    /// Contact and equality rows, with c, h and 1/k.
    rows: [RowSet; 2],
    previous: Option<Arc<Answer>>,
    /// `previous` was the answer for exactly these data.
    answered: bool,
}

/// Where a solve starts.
pub(super) struct Start {
    given: [Option<Vec<f64>>; 2],
    previous: Option<Arc<Answer>>,
}

impl Start {
    /// What it comes from.
    pub fn name(&self) -> &'static str {
        match (&self.given, &self.previous) {
            ([None, None], None) => "cold",
            ([None, None], Some(_)) => "previous",
            _ => "given",
        }
    }

    /// `x = L'lambda / (S 2^p)` of an island, parallel rows together; multipliers that are not there are zero.
    pub fn scaled(&self, ready: &Ready) -> Result<Vec<f64>> {
        let mut multipliers = [self.given[0].as_deref(), self.given[1].as_deref()];
        if multipliers == [None, None] {
            multipliers = self.previous.as_deref().map_or([None, None], |a| [Some(&a.lambda), Some(&a.mu)]);
        }
        let rows = &ready.rows;
        let mut x = zeros(rows.groups(), "start values")?;
        for (i, (group, sign)) in rows.grouping.members() {
            let (kind, row) = ready.island.kind_and_row(i);
            // where the last solve has left none
            let known = multipliers[kind as usize].map(|all| all[row]).filter(|v| v.is_finite());
            x[group] += sign * known.unwrap_or(0.0) / (rows.scale[i] * ready.island.unit);
        }
        Ok(rows.decoupling.apply_transposed(&x))
    }
}

impl History {
    pub fn data_changed(&mut self) {
        self.data += 1;
    }

    /// Multipliers belong to rows.
    pub fn rows_changed(&mut self) {
        self.start = [None, None];
        self.previous = None;
    }
}

impl Problem {
    pub(super) fn keep(&mut self, answer: Answer) {
        let answer = Arc::new(answer);
        self.history.previous = Some(Arc::clone(&answer));
        self.answer = Some(answer);
    }

    /// Start values for the next solve alone, whatever that comes to. Rows whose multiplier is zero start open.
    pub fn start_from(&mut self, kind: RowKind, multipliers: &[f64]) -> Result<()> {
        let expected = self.rows(kind).len();
        if multipliers.len() != expected {
            let what = format!("there are {expected} rows of this kind, not {}", multipliers.len());
            let given = multipliers.len() as f64;
            return Err(Error::argument("rows", what).value(given).limit(expected as f64));
        }
        if let Some(row) = first_non_finite(multipliers) {
            return Err(Error::argument("lambda", "the entry is not a finite number").row(row).entry(row));
        }
        self.history.start[kind as usize] = Some(copied(multipliers, "start values")?);
        Ok(())
    }

    /// Where the next solve starts: given values, which are used up, or those the options ask for.
    pub(super) fn take_start(&mut self) -> Start {
        let given = std::mem::take(&mut self.history.start);
        let previous = self.history.previous.clone();
        Start { given, previous: previous.filter(|_| self.settings.start == StartFrom::Previous) }
    }

    /// Keeps loads, rows, multipliers and active set under a number that is never used again.
    pub fn save_state(&mut self) -> Result<usize> {
        let loads = self.bodies.iter().map(|slot| copy_of(slot.body.load.as_ref())).collect::<Result<_>>()?;
        let state = State {
            data: self.history.data,
            loads,
            rows: [self.contact.copied(WHAT)?, self.equalities.copied(WHAT)?],
            previous: self.history.previous.clone(),
            answered: self.answer.is_some(),
        };
        let number = self.history.saved;
        self.history.states.insert(number, state);
        self.history.saved += 1;
        Ok(number)
    }

    /// Loads, rows and multipliers as they were; matrices stay as they are now. The state is kept. The answer
    /// comes back as well unless matrices, rows or compliances differ, or what they were set up to is gone.
    pub fn restore_state(&mut self, number: usize) -> Result<()> {
        let state = self.history.states.get(&number).ok_or_else(|| no_state(number))?;
        if state.loads.len() != self.bodies.len() {
            let what = "bodies were added since the state was saved: it no longer fits";
            return Err(Error::new(Kind::State, what));
        }
        let loads = state.loads.iter().map(|load| copy_of(load.as_ref())).collect::<Result<Vec<_>>>()?;
        let [contact, equalities] = [state.rows[0].copied(WHAT)?, state.rows[1].copied(WHAT)?];
        let same = self.contact.same_but_rhs(&contact) && self.equalities.same_but_rhs(&equalities);
        let fits = same && state.answered && state.data == self.history.data && self.ready.is_some();
        let (previous, answer) = (state.previous.clone(), state.previous.clone().filter(|_| fits));
        if !same {
            self.forget_dual();
        }
        (self.contact, self.equalities) = (contact, equalities);
        self.bodies.iter_mut().zip(loads).for_each(|(slot, load)| slot.body.load = load);
        self.answer = answer;
        self.asked = Asked::default();
        self.history.previous = previous;
        self.history.start = [None, None];
        Ok(())
    }

    pub fn drop_state(&mut self, number: usize) -> Result<()> {
        self.history.states.remove(&number).map(drop).ok_or_else(|| no_state(number))
    }
}

const WHAT: &str = "a saved state";

fn copy_of(load: Option<&Vec<f64>>) -> Result<Option<Vec<f64>>> {
    load.map(|f| copied(f, WHAT)).transpose()
}

fn no_state(number: usize) -> Error {
    Error::argument("id", "no state has this number").index(number as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{RowsInput, SparseInput, Storage};

    /// Two unknowns with a spring between them, pushed against a wall.
    #[test]
    fn a_restored_answer_has_its_setup_or_is_none() {
        let mut problem = Problem::new();
        let body = problem.add_body(2).unwrap();
        let (ptr, col, val) = ([0, 1, 3], [0, 0, 1], [1.0, -1.0, 1.0]);
        let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
        problem.set_load(body, &[2.0, 0.5]).unwrap();
        let wall = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[1.0], rhs: Some(&[1.0]) };
        problem.add_rows(RowKind::Inequality, wall).unwrap();
        problem.solve().unwrap();
        let (state, amplitudes) = (problem.save_state().unwrap(), problem.amplitudes(body).unwrap().to_vec());
        problem.clear_rows(RowKind::Inequality);
        problem.add_rows(RowKind::Inequality, wall).unwrap();
        problem.restore_state(state).unwrap();
        assert_eq!(problem.amplitudes(body).unwrap_err().kind, Kind::State);
        problem.setup().unwrap();
        problem.restore_state(state).unwrap();
        assert_eq!(problem.amplitudes(body).unwrap(), amplitudes);
    }
}
