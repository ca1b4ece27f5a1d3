//! The progress function of the host: what it receives for a step, and what it returns.

use crate::qp::StepKind;

/// What the host hears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// The step of the dual method that has just been done; none: a part of the setup, with counts of 0 and
    /// figures that are not numbers.
    pub step: Option<StepKind>,
    /// Part of the work of a setup that is done, an estimate that never falls; not a number in steps of the method.
    pub fraction: f64,
    pub steps: usize,
    /// Products with F.
    pub products: usize,
    /// Contact rows with a force; parallel rows count once.
    pub active: usize,
    /// Norm of the projected gradient against the one that stops the solve, and the same of its parts: on the
    /// rows with a force (22), and of the rows that want one (23).
    pub residual: f64,
    pub free: f64,
    pub chopped: f64,
    /// `1/2 l'F l - l'd`, force x length.
    pub theta: f64,
    /// Since the call began.
    pub seconds: f64,
}

/// What the host answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reply {
    Continue,
    /// End with the answer of the last step.
    Cancel,
    /// The host's function has failed, with this number.
    Failed(i32),
}

pub type Listener = Box<dyn FnMut(&Progress) -> Reply + Send + Sync>;
