//! Start values of the host for the next solve; saved states of a problem, which are restored when a load step is rejected.

use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::first_non_finite;
use crate::platform::memory::{copied, headroom};
use crate::solver::history::{Current, State};
use crate::solver::problem::Problem;

impl Problem {
    /// Start values for the next solve only, also if that fails. Rows whose multiplier is zero start open.
    pub fn start_from(&mut self, kind: RowKind, multipliers: &[f64]) -> Result<()> {
        let expected = self.model.rows(kind).len();
        if multipliers.len() != expected {
            let what = format!("there are {expected} rows of this kind, not {}", multipliers.len());
            let given = multipliers.len() as f64;
            return Err(Error::argument("rows", what).value(given).limit(expected as f64));
        }
        if let Some(row) = first_non_finite(multipliers) {
            return Err(Error::argument("lambda", "the entry is not a finite number").row(row).entry(row));
        }
        self.history().start[kind as usize] = Some(copied(multipliers, "start values")?);
        Ok(())
    }

    /// Keeps loads, rows, friction, positions and pairs of surfaces, multipliers and active set under a number that is never used again.
    pub fn save_state(&mut self) -> Result<usize> {
        self.save_together()?;
        let loads = self.model.bodies.iter().map(|given| copy_of(given.body.load.as_deref()));
        let _room = headroom(self.model.pairs.bytes(), WHAT)?;
        let state = State {
            bodies: self.model.revisions.bodies,
            loads: loads.collect::<Result<_>>()?,
            rows: [self.model.contact.copied(WHAT)?, self.model.equalities.copied(WHAT)?],
            friction: self.model.friction.copied(WHAT)?,
            table: self.model.table.clone(),
            pairs: self.model.pairs.clone(),
            previous: self.history().previous.clone(),
            answered: self.current().is_some(),
        };
        let history = &mut self.history;
        history.states.insert(history.saved, state);
        history.saved += 1;
        Ok(history.saved - 1)
    }

    /// Restores loads, rows, friction, positions and pairs of surfaces, and multipliers; the matrices keep their present values. The saved state is kept.
    /// The answer is also restored, unless matrices, rows or compliances differ or its setup no longer exists.
    pub fn restore_state(&mut self, number: usize) -> Result<()> {
        let fits = match self.restorable_together(number)? {
            Some(fits) => fits,
            None => self.restorable(number)? && self.prepared.duals(&self.model).is_some(),
        };
        self.restore(number, fits)?;
        self.restored_together(fits);
        Ok(())
    }

    /// Whether the answer of a state is that of its data, with the present matrices.
    pub(super) fn restorable(&self, number: usize) -> Result<bool> {
        let Self { model, history, .. } = self;
        let state = history.states.get(&number).ok_or_else(|| no_state(number))?;
        if state.loads.len() != model.bodies.len() {
            let what = "bodies were added since the state was saved: it no longer fits";
            return Err(Error::new(Kind::State, what));
        }
        if !state.pairs.is_of(&model.pairs) {
            let what = "surfaces or pairs were added since the state was saved: it no longer fits";
            return Err(Error::new(Kind::State, what));
        }
        Ok(state.is_of(model) && state.answered && state.bodies == model.revisions.bodies)
    }

    /// `fits`: with its answer.
    fn restore(&mut self, number: usize, fits: bool) -> Result<()> {
        let Self { model, prepared, history, .. } = self;
        let state = history.states.get(&number).ok_or_else(|| no_state(number))?;
        let loads = state.loads.iter().map(|load| copy_of(load.as_deref())).collect::<Result<Vec<_>>>()?;
        let [contact, equalities] = [state.rows[0].copied(WHAT)?, state.rows[1].copied(WHAT)?];
        let friction = state.friction.copied(WHAT)?;
        let _room = headroom(state.pairs.bytes(), WHAT)?;
        let pairs = state.pairs.clone();
        let same = state.is_of(model);
        prepared.forget_pairs();
        let previous = state.previous.clone();
        model.revisions.laws += u64::from(!same);
        (model.contact, model.equalities, model.friction) = (contact, equalities, friction);
        model.table.clone_from(&state.table);
        model.pairs = pairs;
        model.bodies.iter_mut().zip(loads).for_each(|(given, load)| given.body.load = load);
        history.of(model.revisions.rows).start = [None, None, None];
        let answer = previous.clone().filter(|_| fits);
        history.current = answer.map(|answer| Current::new(answer, prepared.made));
        history.previous = previous;
        Ok(())
    }

    pub fn drop_state(&mut self, number: usize) -> Result<()> {
        self.forget_together(number);
        self.history.states.remove(&number).map(drop).ok_or_else(|| no_state(number))
    }
}

const WHAT: &str = "a saved state";

fn copy_of(load: Option<&[f64]>) -> Result<Option<Box<[f64]>>> {
    load.map(|f| Ok(copied(f, WHAT)?.into())).transpose()
}

fn no_state(number: usize) -> Error {
    Error::argument("id", "no state has this number").index(number as i64)
}
