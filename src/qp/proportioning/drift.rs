//! How far a gradient that is updated by products with an approximate operator may differ from `A x - b`: the relative
//! error of all updates, as measured when the gradient was last recomputed.

use crate::linalg::vector::norm;
use crate::numbers::qp::{DRIFT_FELT, DRIFT_SAFETY, FIRST_DRIFT};

pub struct Drift {
    share: f64,
    /// Sum of the lengths of the updates since the gradient was last computed.
    updates: f64,
    /// Number of steps at that time.
    computed: usize,
}

impl Default for Drift {
    fn default() -> Self {
        Self { share: FIRST_DRIFT, updates: 0.0, computed: 0 }
    }
}

impl Drift {
    /// Notes the update of g by `t image`.
    pub fn add(&mut self, t: f64, image: &[f64]) {
        self.updates += t.abs() * norm(image);
    }

    /// Notes the error of g that was found when g was recomputed.
    pub fn measured(&mut self, error: f64, steps: usize) {
        if self.updates > 0.0 && error.is_finite() {
            self.share = DRIFT_SAFETY * error / self.updates;
        }
        (self.updates, self.computed) = (0.0, steps);
    }

    /// Whether errors may matter for a residual of this length; not before the first step.
    pub fn is_felt(&self, residual: f64, steps: usize) -> bool {
        steps > self.computed && self.share * self.updates > DRIFT_FELT * residual
    }
}
