//! The one place that says why there is no answer: a load that nothing holds, rows that contradict each other. It takes a
//! candidate for the proof from whoever found it and tries it on the data of the host. What is not proved is not said: the
//! next method follows.
//!
//! | module | claims |
//! |---|---|
//! | `loads` | no forces of the rows hold the load: a rigid motion |
//! | `gaps` | no displacement satisfies the rows: weights of rows |

mod gaps;
mod loads;

use crate::constraints::RowKind;
use crate::error::{Error, Proof};
use crate::solver::problem::Problem;
use crate::solver::setup::Ready;

pub(super) use gaps::Contradictions;
pub(super) use loads::{Unheld, MARGINAL, ROUNDING};

/// The error of a row without entries, which contradicts itself; `first` is the place of its kind in the stack.
pub(super) fn empty_row_contradicts(error: Error, first: usize) -> Error {
    let (Some(row), Some(gap)) = (error.place.row, error.place.value) else { return error };
    error.proved_by(proof_of_rows(1.0, vec![(first + row, -gap)], first + row))
}

/// Weights in the scaling of the host, the largest 1, in the order of the rows.
pub(super) fn proof_of_rows(margin: f64, mut weights: Vec<(usize, f64)>, heaviest: usize) -> Proof {
    let largest = weights.iter().fold(0.0, |largest: f64, (_, w)| largest.max(w.abs()));
    weights.iter_mut().for_each(|(_, w)| *w /= largest);
    weights.sort_by_key(|(row, _)| *row);
    Proof::Rows { margin, weights, heaviest }
}

/// Number in the stack of all contact rows and all equality rows of row i in that of an island.
pub(super) fn in_stack(problem: &Problem, ready: &Ready, i: usize) -> usize {
    match ready.island.kind_and_row(i) {
        (RowKind::Inequality, row) => row,
        (RowKind::Equality, row) => problem.contact.len() + row,
    }
}

/// Kind of a row of the stack, and its number among those.
pub(super) fn kind_and_row(i: usize, contact: usize) -> (RowKind, usize) {
    if i < contact {
        (RowKind::Inequality, i)
    } else {
        (RowKind::Equality, i - contact)
    }
}
