//! Rows whose gaps are far larger than all motions caused by loads and rows are left out of the dual problem. They join it only if bodies
//! travel that far: if nothing else holds a load, if the answer without these rows violates them, or if there is no answer
//! without them.

use crate::error::{Error, Kind, Result};
use crate::numbers::solve::FAR;
use crate::qp::{Rung, Solution, Verdict};
use crate::solve::case::Case;
use crate::solve::certifier::Judged;
use crate::solve::diagnosis::Unheld;
use crate::solve::fallback::gave_up;

use crate::solve::scaled::Scaled;

/// The rows left out, and what the runs without them have found.
pub struct Near<'a> {
    case: Case<'a>,
    scaled: &'a Scaled,
    pub far: Vec<bool>,
    /// The first solution of a run that gave up although rows were left out.
    given_up: Option<Solution>,
}

/// What follows a run.
pub enum Next {
    /// Rows have joined: another run, from the forces of this solution, or from those of the run before.
    Run(Option<Solution>),
    Ended(Solution),
}

impl<'a> Near<'a> {
    pub fn new(case: Case<'a>, scaled: &'a Scaled) -> Self {
        Self { case, scaled, far: scaled.gaps.far.clone(), given_up: None }
    }

    /// The rows of the dual problem.
    pub fn rows(&self) -> Vec<usize> {
        (0..self.far.len()).filter(|&i| !self.far[i]).collect()
    }

    /// The loads or assumed amplitudes have changed.
    pub fn forget(&mut self) {
        self.given_up = None;
    }

    /// Rows with a finite gap are left out.
    fn comes_in(&self) -> bool {
        (0..self.far.len()).any(|i| self.far[i] && self.scaled.gaps.value[i] < f64::INFINITY)
    }

    /// Whether bodies that slide without end on these rows may be stopped by others: then the nearest join.
    pub fn may_stop(&mut self, error: &Error) -> bool {
        let may_stop = error.kind == Kind::Slides && self.comes_in();
        if may_stop {
            self.take_in_nearest();
        }
        may_stop
    }

    /// What follows this solution, of which the certificate has said `judged`. Where a motion of negative stiffness has been `driven`
    /// up to a row, more than the load of the host is to be held.
    pub fn after(&mut self, solution: Solution, judged: &Judged, driven: bool) -> Result<Next> {
        if let Judged::RowsReached(rows) = judged {
            rows.iter().for_each(|&i| self.far[i] = false);
            return Ok(Next::Run(Some(solution)));
        }
        if !self.comes_in() {
            let first = self.given_up.take().filter(|_| gave_up(&solution));
            return Ok(Next::Ended(first.unwrap_or(solution)));
        }
        match &solution.verdict {
            Verdict::Infeasible { .. } => {
                if !driven && Unheld::least(self.case, self.scaled, &self.far)?.is_little() {
                    return Ok(Next::Ended(solution));
                }
            }
            Verdict::Unbounded { .. } => {}
            _ if gave_up(&solution) && Rung::FarRows.is_tried() => {
                self.given_up.get_or_insert(solution);
            }
            _ => return Ok(Next::Ended(solution)),
        }
        self.take_in_nearest();
        Ok(Next::Run(None))
    }

    /// Takes in the nearest far row and all rows up to `FAR` times as far; rows with infinite gaps stay out.
    fn take_in_nearest(&mut self) {
        let (far, gaps) = (&mut self.far, &self.scaled.gaps.value);
        let nearest = (0..far.len()).filter(|&i| far[i]).map(|i| gaps[i]).fold(f64::INFINITY, f64::min);
        far.iter_mut()
            .zip(gaps)
            .for_each(|(far, gap)| *far &= !(*gap <= FAR * nearest && *gap < f64::INFINITY));
    }
}
