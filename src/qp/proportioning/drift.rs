//! How far a gradient that is updated by products with an approximate operator may differ from `A x - b`: the relative error of all updates
//! that was found when the gradient was last recomputed.

use crate::linalg::vector::norm;

/// The share as long as none has been measured.
const FIRST: f64 = 1e-5;
/// What is not measured well: shares are taken this many times as large.
const SAFETY: f64 = 4.0;
/// Errors of this part of the residual are felt.
const FELT: f64 = 0.1;

pub struct Drift {
    share: f64,
    /// Sum of the lengths of the updates since the gradient was computed.
    updates: f64,
    /// Steps when it was.
    computed: usize,
}

impl Default for Drift {
    fn default() -> Self {
        Self { share: FIRST, updates: 0.0, computed: 0 }
    }
}

impl Drift {
    /// g has changed by `t image`.
    pub fn add(&mut self, t: f64, image: &[f64]) {
        self.updates += t.abs() * norm(image);
    }

    /// g was wrong by so much, and is not any more.
    pub fn measured(&mut self, error: f64, steps: usize) {
        if self.updates > 0.0 && error.is_finite() {
            self.share = SAFETY * error / self.updates;
        }
        (self.updates, self.computed) = (0.0, steps);
    }

    /// Errors may be felt in a residual of this length; not before a step has been made.
    pub fn is_felt(&self, residual: f64, steps: usize) -> bool {
        steps > self.computed && self.share * self.updates > FELT * residual
    }
}
