//! A Newton step of the laws of friction, for the corrector: residuals by the data of the host, dense factors of the rows that may
//! carry a force.

use crate::error::Result;
use crate::qp::friction::{newton_step, slipping, without_force, Corrected, FrictionProblem, State};
use crate::qp::{DirectOnRows, Restricted};
use crate::solve::friction::laws::cones;
use crate::solve::recovery::{Faces, Recovery};

/// The change of forces, over all rows, and amplitudes, and the states of the nodes that it assumes.
pub struct Step {
    pub forces: Vec<f64>,
    pub turn: Vec<f64>,
    pub states: Vec<State>,
}

impl Recovery<'_> {
    /// The rows that carry no force at a point, by its gaps.
    pub fn open_rows(&self, x: &[f64], gaps: &[f64]) -> Result<Vec<bool>> {
        let rows: Vec<usize> = (0..x.len()).collect();
        Ok(without_force(&cones(self.ready, &self.scaled.gaps, &rows)?, x, gaps))
    }

    /// The rows whose forces do not respond to motions of an answer: those without a force, and of nodes that slip.
    pub fn held_with_friction(&self, u: &[f64], x: &[f64]) -> Result<Vec<bool>> {
        let (rows, gaps) = ((0..x.len()).collect::<Vec<_>>(), self.gaps_left(&[u], &[x]));
        let cones = cones(self.ready, &self.scaled.gaps, &rows)?;
        let mut held = without_force(&cones, x, &gaps);
        slipping(&cones, x, &gaps).for_each(|row| held[row] = true);
        Ok(held)
    }

    /// None if too many rows may carry a force. Those marked in `open` carry none.
    pub fn friction_step(&self, open: &[bool], at: Corrected) -> Result<Option<Step>> {
        let Faces { qp, direct, .. } = &self.faces;
        let rows: Vec<usize> = (0..open.len()).filter(|&i| !open[i]).collect();
        let near = Restricted::new(*qp, &rows);
        let cones = cones(self.ready, &self.scaled.gaps, &rows)?;
        let [x, r, follows] = [at.x, at.r, at.follows].map(|v| near.start(v));
        let at = Corrected { x: &x, r: &r, follows: &follows, ..at };
        let block = DirectOnRows { whole: *direct, rows: &rows };
        let problem = FrictionProblem { qp: near.qp(), cones: &cones, preconditioner: None };
        let found = newton_step(&problem, block.direct(), &at)?;
        Ok(found.map(|(forces, turn, states)| Step { forces: near.spread(&forces), turn, states }))
    }
}
