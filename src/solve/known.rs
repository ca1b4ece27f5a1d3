//! The cost of the linear problem for the states of the last answer.

use crate::error::Result;
use crate::platform::threads;
use crate::solve::case::Case;
use crate::solve::friction::on_known_states;
use crate::solve::interruptible::Interruptible;
use crate::solve::island::scaled;

/// Products with F if all states of the last answer of an island with friction are known; none without such an answer.
pub fn products_of_known_states(case: Case) -> Result<Option<usize>> {
    let ready = case.ready;
    threads::with_team(case.threads(), || {
        let dual = scaled(case)?;
        let f = Interruptible::new(&ready.dual, ready.product_threads(case.threads()));
        on_known_states(ready, &case.model.settings, dual.qp(ready, &f), &dual.gaps)
    })
}
