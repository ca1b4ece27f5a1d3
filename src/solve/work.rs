//! The work of the loads, which measures how far they can move the bodies.

use crate::error::Result;
use crate::solve::case::Case;
use crate::solve::local::Work;

/// V, force x length: `sum_p (g'v)^2 / v'K v` of the self-equilibrated parts `g = f - D R R'f / unit` of the loads f without the
/// grounded unknowns. For any motion v this is at most `g'K+ g`, the work of the load on the body alone: v = K+ g makes it large,
/// and an inexact K+ cannot make it too large.
pub fn work_of_loads(case: Case) -> Result<f64> {
    Ok(case.locals()?.ask(|_| Work, &case.loads()?)?.into_iter().sum())
}
