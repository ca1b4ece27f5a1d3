//! From one load step to the next: the slip at the end of a step is the reference of the next step.

use crate::error::{Error, Kind, Result};
use crate::solve::Outcome;
use crate::solver::problem::Problem;

impl Problem {
    /// `s_old := T u - C_t lambda_t` of the last answer at every node, also at open nodes; the answer must be certified.
    /// The answer is unchanged, including its slips; a second call has no further effect.
    pub fn commit_friction(&mut self) -> Result<()> {
        let answer = self.answer()?;
        if answer.failed.contains(&true) {
            let what =
                "a group of bodies has no answer: there are no slips from which the next step could start";
            return Err(Error::new(Kind::State, what));
        }
        if !matches!(answer.report.outcome, Outcome::Solved | Outcome::Marginal) {
            let what = "the last answer is not certified: its slips cannot be the start of the next step";
            return Err(Error::new(Kind::State, what));
        }
        let reached = match &answer.of_others {
            Some(others) => others.reached.clone(),
            None => self.model.friction.reached(|j| answer.u[j], &answer.tangential)?,
        };
        self.history.commits += 1;
        self.model.commit_reference(reached)
    }
}
