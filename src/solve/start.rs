//! The start point of a solve.

use std::sync::Arc;

use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::Operator;
use crate::setup::Ready;
use crate::solve::answer::Answer;

/// Where a solve starts.
pub struct Start {
    /// Multipliers of contact, equality and tangential rows, force.
    pub given: [Option<Vec<f64>>; 3],
    /// The last answer for these rows.
    pub previous: Option<Arc<Answer>>,
}

impl Start {
    /// The origin of the start point.
    pub fn name(&self) -> &'static str {
        match (&self.given, &self.previous) {
            ([None, None, None], None) => "cold",
            ([None, None, None], Some(_)) => "previous",
            _ => "given",
        }
    }

    /// `x = L'lambda / (S 2^p)` of an island, with parallel rows combined; missing multipliers are zero.
    pub fn scaled(&self, ready: &Ready) -> Result<Vec<f64>> {
        let mut multipliers = RowKind::ALL.map(|kind| self.given[kind as usize].as_deref());
        if multipliers == [None; 3] {
            let previous = self.previous.as_deref();
            multipliers = RowKind::ALL.map(|kind| previous.map(|answer| answer.forces(kind)));
        }
        let mut x = ready.rows.scaling.forces_to_dual(|i| {
            let (kind, row) = ready.island.kind_and_row(i);
            // if the last solve has left no multipliers
            let known =
                multipliers[kind as usize].and_then(|all| all.get(row).copied()).filter(|v| v.is_finite());
            known.unwrap_or(0.0)
        })?;
        x.resize(ready.dual.order(), 0.0);
        Ok(x)
    }
}
