//! The cost of the linear problem for the states of the last answer with friction; used for measurements.

use crate::error::{Error, Kind, Result};
use crate::solve::{products_of_known_states, Case};
use crate::solver::decomposed::solved;
use crate::solver::problem::Problem;

impl Problem {
    /// Products with F for the linear problems with the states of the last solve, summed over all groups of bodies with
    /// friction.
    #[doc(hidden)]
    pub fn products_of_known_states(&self) -> Result<usize> {
        let Self { model: host, decomposition, prepared, .. } = self;
        let model = solved(host, decomposition);
        let mut all = None;
        for ready in &prepared.done(model)?.islands {
            let own = products_of_known_states(Case { model, prepared, ready, method: None })?;
            all = all.map_or(own, |sum: usize| Some(sum + own.unwrap_or(0)));
        }
        all.ok_or_else(|| Error::new(Kind::State, "the last solve had no friction"))
    }
}
