//! The dofs held for soft motions. One dof for each given motion keeps F of (14) definite while K has only small negative
//! stiffness along these motions. If the negative stiffness is larger, F is indefinite or nearly so, and the library
//! holds other or more dofs: each additional dof adds one soft motion, and K is still represented exactly. So it does if F
//! is singular, as between two soft motions that exchange their work.

use std::sync::Arc;

use crate::body::fixing::{fixing_dofs, held_against};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::known::Known;
use crate::body::layout::{Layout, Symbolic};
use crate::body::probe::missing_mode;
use crate::error::{Error, Kind, Result};
use crate::linalg::{Cholesky, Matrix};
use crate::numbers::body::LOOSE;
use crate::platform::memory::zeros;

/// Limit of dofs held in addition to one per given motion: the number of rigid motions of a body.
const FURTHER: usize = 6;

impl Known {
    /// The factor of F, its analysis, and how many times further dofs had to be held.
    pub(super) fn factorised(&mut self, most: usize) -> Result<(Arc<Symbolic>, Cholesky, usize)> {
        let missing = || Error::new(Kind::Internal, "a body was not analysed");
        let mut further = 0;
        loop {
            let symbolic = self.symbolic.clone().ok_or_else(missing)?;
            let breakdown = match symbolic.analysis.factorize(&self.k.matrix, self.k.by)? {
                Ok(factor) => return Ok((symbolic, factor, further)),
                Err(breakdown) => breakdown,
            };
            let missing = || missing_mode(breakdown.dof, breakdown.relative_pivot, self.null_space.cols);
            let error = breakdown.refused().unwrap_or_else(missing);
            if self.null_space.cols >= most {
                return Err(error);
            }
            self.hold_also(symbolic.analysis.fastest(&self.k.matrix, self.k.by, breakdown.dof)?)?;
            further += 1;
        }
    }

    /// Largest number of motions that this body may have.
    pub(super) fn most_motions(&self) -> usize {
        self.null_space.cols + if self.is_free_to_choose() { FURTHER } else { 0 }
    }

    fn is_free_to_choose(&self) -> bool {
        self.soft && !self.given
    }

    /// The dofs that hold the motions of this K+ best, if the present dofs hold them badly.
    pub(super) fn better(&self, made: &GeneralizedInverse) -> Result<Option<Vec<usize>>> {
        if !self.is_free_to_choose()
            || self.pilots.is_some()
            || made.stiffness.iter().all(|stiffness| *stiffness >= 0.0)
        {
            return Ok(None);
        }
        let root = self.k.roots()?;
        let best = fixing_dofs(&made.null_space, &root)?;
        let is_loose = held_against(&made.null_space, &root, &self.fixing, &best)? < LOOSE;
        Ok(is_loose.then_some(best))
    }

    /// Holds these dofs, and takes `null_space` as the motions that they hold.
    pub(super) fn hold(&mut self, null_space: Matrix, fixing: Vec<usize>) -> Result<()> {
        (self.null_space, self.fixing) = (null_space, fixing);
        let layout = Arc::new(Layout::Held(self.fixing.clone()));
        self.symbolic = Some(Arc::new(Symbolic { layout, analysis: self.analyse()? }));
        Ok(())
    }

    /// Holds one more dof.
    pub(super) fn hold_also(&mut self, dof: usize) -> Result<()> {
        let mut unit = zeros(self.null_space.rows, "a soft motion")?;
        unit[dof] = 1.0;
        let (mut null_space, mut fixing) = (self.null_space.clone(), self.fixing.clone());
        null_space.push_col(&unit);
        fixing.push(dof);
        self.hold(null_space, fixing)
    }
}
