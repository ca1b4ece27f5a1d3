//! What is measured of a K+ once its factor is there: the error of the null space, the stiffness of soft motions, carried motions.

use std::sync::Arc;

use crate::body::carried::{self, Motions};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::pilots::Pilots;
use crate::body::probe::{known_to, sharpened};
use crate::body::soft::{known_to_entries, soft_motions};
use crate::error::Result;
use crate::linalg::vector::NOISE;
use crate::linalg::{Matrix, Multiple};
use crate::numbers::body::MOST_ROUNDING;

impl GeneralizedInverse {
    /// Measures the stiffness of the vectors if they are `soft`, otherwise the error of the null space; adds the motions of
    /// `pilots`, and carries `rigid` motions.
    pub(super) fn judged_by(
        self,
        k: &Multiple,
        soft: bool,
        pilots: Option<&Pilots>,
        rigid: Option<&Matrix>,
    ) -> Result<Self> {
        let judged = if soft { self.softened(k)? } else { self.measured(k)? };
        let judged = match pilots {
            Some(pilots) => {
                let are_null = judged.stiffness.is_empty();
                judged.led_by(pilots, k, are_null)?
            }
            None => judged,
        };
        match rigid {
            Some(rigid) => judged.with_carried(k, rigid),
            None => Ok(judged),
        }
    }

    /// Carries the rigid motions that K resists: [`carried`](crate::body::carried).
    pub(super) fn with_carried(mut self, k: &Multiple, rigid: &Matrix) -> Result<Self> {
        if self.null_space.cols == rigid.cols || self.is_soft() {
            return Ok(self);
        }
        if let Some(Motions { carried, vectors, stiffness }) =
            carried::motions(&self.factor, k, &self.null_space, rigid)?
        {
            self.stiffness = vec![0.0; self.null_space.cols];
            self.stiffness.extend(stiffness);
            self.null_space.push_cols(&vectors);
            self.carried = Some(Arc::new(carried));
        }
        Ok(self)
    }

    /// Adds the motions of these unknowns, which its factor holds. `are_null`: K does not resist the other motions.
    pub(super) fn led_by(mut self, pilots: &Pilots, k: &Multiple, are_null: bool) -> Result<Self> {
        let metric = Some(&*pilots.metric);
        let (mut null, mut soft) = (self.null_space, pilots.motions()?);
        if !are_null {
            null.push_cols(&soft);
            (null, soft) = (Matrix::zeros(null.rows, 0)?, null);
        }
        (self.null_space, self.stiffness) = soft_motions(&self.factor, (k, metric), null, soft)?;
        self.error = known_to_entries(&self.factor, k, &self.null_space)?;
        self.rounding = self.error.min(MOST_ROUNDING);
        Ok(self)
    }

    /// Replaces the vectors by soft motions and their stiffness.
    fn softened(mut self, k: &Multiple) -> Result<Self> {
        let none = Matrix::zeros(k.order(), 0)?;
        (self.null_space, self.stiffness) = soft_motions(&self.factor, (k, None), none, self.null_space)?;
        self.error = known_to_entries(&self.factor, k, &self.null_space)?;
        Ok(self)
    }

    /// Measures the error of a null space that K maps to more than rounding, as amplified by the factor.
    fn measured(mut self, k: &Multiple) -> Result<Self> {
        if self.error > NOISE {
            if let Some(sharp) = sharpened(k, &self.null_space)? {
                self.null_space = sharp;
            }
            self.error = known_to(&self.factor, k, &self.null_space)?;
        }
        Ok(self)
    }
}
