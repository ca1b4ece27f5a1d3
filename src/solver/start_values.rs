//! Start values of the host for the next solve.

use crate::constraints::RowKind;
use crate::error::{Error, Result};
use crate::linalg::vector::first_non_finite;
use crate::platform::memory::copied;
use crate::solver::problem::Problem;

impl Problem {
    /// Start values for the next solve alone, whatever that comes to. Rows whose multiplier is zero start open.
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
}
