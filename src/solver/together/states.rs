//! States of a problem of several ranks: each saves and restores its own, under one number; rank 0 also the last answer of all.

use crate::error::Result;
use crate::solver::call::Call;
use crate::solver::history::Current;
use crate::solver::joined::{Role, SavedByAll};
use crate::solver::problem::Problem;
use crate::solver::together::leader::Leading;

use crate::solver::together::Brought;

impl Problem {
    /// As `save_state`, by all ranks; false if rank 0 is alone with its problem.
    pub(in crate::solver) fn save_together(&mut self) -> Result<bool> {
        let number = self.history.saved as u64;
        Ok(self.together(Call::SaveState, number, Brought::default())?.is_some())
    }

    /// Whether the answer of a state is that of its data on all ranks; none if rank 0 is alone with its problem.
    pub(in crate::solver) fn restorable_together(&mut self, number: usize) -> Result<Option<bool>> {
        Ok(self.together(Call::RestoreState, number as u64, Brought::default())?.map(|end| end.fits))
    }

    /// The answer of a restored state.
    pub(in crate::solver) fn restored_together(&mut self, fits: bool) {
        let revisions = self.model.revisions;
        if let Some(joined) = &mut self.joined {
            joined.answered = fits.then_some(revisions);
        }
    }

    /// A state is dropped.
    pub(in crate::solver) fn forget_together(&mut self, number: usize) {
        if let Some(Role::Leads(leader)) = self.joined.as_mut().map(|joined| &mut joined.role) {
            leader.states.remove(&number);
        }
    }
}

impl Leading<'_> {
    /// Keeps the last answer of all.
    pub(super) fn save(&mut self, number: usize) {
        let previous = self.all.history().previous.clone();
        let order = self.leader.order.clone();
        self.leader.states.insert(number, SavedByAll { order, previous });
    }

    /// Takes it back; `fits`: the answer of each rank is that of its data.
    pub(super) fn restore(&mut self, number: usize, fits: bool) -> bool {
        let is_set_up = self.all.prepared.duals(&self.all.model).is_some();
        self.all.prepared.forget_pairs();
        let saved = self.leader.states.get(&number);
        let previous = saved.and_then(|saved| saved.previous.clone());
        let same = saved.is_some_and(|saved| saved.order == self.leader.order);
        let fits = fits && is_set_up && same && previous.is_some();
        let made = self.all.prepared.made;
        let history = self.all.history();
        history.current = previous.clone().filter(|_| fits).map(|answer| Current::new(answer, made));
        (history.start, history.previous) = ([None, None, None], previous);
        // rows in another order have other places in it
        self.leader.expected = saved.map(|saved| saved.order.clone());
        fits
    }
}
