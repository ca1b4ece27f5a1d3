//! The progress function of the host: what it receives for a step, and what it returns.

use crate::qp::StepKind;

/// What the host's function receives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// The step of the dual method just completed; none: a part of the setup, with counts of 0 and values that are NaN.
    pub step: Option<StepKind>,
    /// Completed part of the work of a setup, an estimate that never decreases; NaN in steps of the method.
    pub fraction: f64,
    pub steps: usize,
    /// Products with F.
    pub products: usize,
    /// Contact rows with a force; parallel rows count once.
    pub active: usize,
    /// Norm of the projected gradient relative to the value that ends the solve; then the norms of its parts: on rows
    /// with a force (22), and on rows that must get a force (23).
    pub residual: f64,
    pub free: f64,
    pub chopped: f64,
    /// `1/2 l'F l - l'd`, force x length.
    pub theta: f64,
    /// Time since the call began.
    pub seconds: f64,
}

impl Progress {
    /// A report of a setup of which this fraction is complete.
    pub fn of_setup(fraction: f64, seconds: f64) -> Self {
        let [residual, free, chopped, theta] = [f64::NAN; 4];
        Self {
            step: None,
            fraction,
            steps: 0,
            products: 0,
            active: 0,
            residual,
            free,
            chopped,
            theta,
            seconds,
        }
    }
}

/// The answer of the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reply {
    Continue,
    /// End with the answer of the last step.
    Cancel,
    /// The host's function has failed, with this number.
    Failed(i32),
}

pub type Listener = Box<dyn FnMut(&Progress) -> Reply + Send + Sync>;
