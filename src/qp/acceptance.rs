//! The acceptance test, which makes the final decision about a point, and the reports of a run: its steps, its end.

use crate::error::{Error, Kind, Result};
use crate::linalg::vector::norm;
use crate::qp::gradient::Split;
use crate::qp::Counts;

/// Limits of a run.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// The projected gradient is small at `tolerance` times the scale of the acceptance test.
    pub tolerance: f64,
    /// Gamma > 0 of the proportionality test, no unit.
    pub gamma: f64,
    pub steps: usize,
}

/// The acceptance test. It knows the physical meaning of the problem: it gives the length to which the residual is
/// relative, and decides about a point.
pub trait AcceptanceTest {
    /// Scale of the gaps at the point x with multiplier alpha.
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64>;
    /// Part of the energy norm (x'A x)^1/2 that the residual of an answer that passes may have, no unit; 0 if that is not known.
    fn share_of_energy(&self) -> f64 {
        0.0
    }
    /// Whether the answer recovered from (x, alpha) passes its certificate.
    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool>;
    /// Ratio of the violation to its limit for the last point refused; not known if the test does not compute it.
    fn missed(&self) -> Option<f64> {
        None
    }
    /// It uses better data than A and b: a point with zero residual may be refused.
    fn has_better_data(&self) -> bool {
        false
    }
    /// The number of steps as expensive as this effort; none if that is not known.
    fn pays_after(&self, _: Effort) -> Option<usize> {
        None
    }
    /// Corrects a solution that was not accepted with better data than A and b.
    fn mended(&mut self, _: &Solution, _: Effort) -> Result<Mended> {
        Ok(Mended::Failed)
    }
}

/// What may be spent on a correction by better data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// A few active sets, or the interior point: only an answer that is correct to rounding replaces the solution.
    FewSets,
    Interior,
    /// Whatever active sets from that of the solution take.
    AllSets,
    /// Also from an interior point.
    All,
}

/// What correction by better data has found.
pub enum Mended {
    Accepted(Solution),
    /// No answer passes, but these forces are close to one.
    Near(Vec<f64>),
    /// It costs more than was known, and was not tried: see `pays_after`.
    Dear,
    Failed,
}

/// Receives every step; an error ends the run, with the point reached if the error is `Cancelled` or `TimeOver`.
pub trait Observer {
    fn step(&mut self, now: &StepReport) -> Result<()>;
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepKind {
    ConjugateGradient,
    Expansion,
    /// The proportioning step: rows leave the active set.
    Proportioning,
    /// A direction of the Newton method for friction.
    Newton,
}

/// The state of the method after a step.
pub struct StepReport<'a> {
    pub kind: StepKind,
    pub counts: &'a Counts,
    pub active: &'a [bool],
    pub theta: f64,
    /// Norms of `g^P`, of its parts `g^I` (22) and `g^C` (23), and the norm below which `g^P` counts as zero.
    pub residual: f64,
    pub free: f64,
    pub chopped: f64,
    pub small: f64,
}

impl<'a> StepReport<'a> {
    pub fn new(kind: StepKind, counts: &'a Counts, split: &'a Split, theta: f64, small: f64) -> Self {
        let (free, chopped) = (norm(&split.free), norm(&split.chopped));
        Self { kind, counts, active: &split.active, theta, residual: split.norm(), free, chopped, small }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The answer was accepted.
    Solved,
    StepLimit,
    TimeLimit,
    Cancelled,
    /// theta no longer decreases, and the answer is not accepted.
    Stalled,
    /// The residual is below a target tightened eight times, and the answer is not accepted.
    Inaccurate,
    /// No x >= 0 with `G x = e` was found; x of the solution is nearest to it, `direction = e - G x`. If no row of G
    /// resists it, `G_i'direction <= 0` (`= 0` if x_i is free), it proves that there is none; `margin = |direction| /
    /// |e|`.
    Infeasible {
        direction: Vec<f64>,
        margin: f64,
    },
    /// theta decreases without end along `-p`.
    Unbounded {
        p: Vec<f64>,
    },
}

impl Verdict {
    /// The verdict if an observer or operator has stopped the run.
    pub fn of_refusal(error: Error) -> Result<Self> {
        match error.kind {
            Kind::Cancelled => Ok(Self::Cancelled),
            Kind::TimeOver => Ok(Self::TimeLimit),
            _ => Err(error),
        }
    }

    /// The host, the time limit or the limit of steps has ended the run.
    pub fn is_stop(&self) -> bool {
        matches!(self, Self::StepLimit | Self::TimeLimit | Self::Cancelled)
    }

    /// The result with this verdict; if the host or the time limit has stopped its computation, `otherwise` with the
    /// verdict for that.
    pub fn with<T>(self, found: Result<T>, otherwise: T) -> Result<(T, Self)> {
        match found {
            Ok(found) => Ok((found, self)),
            Err(error) => Ok((otherwise, Self::of_refusal(error)?)),
        }
    }
}

#[derive(Debug, Clone)]
pub struct Solution {
    pub x: Vec<f64>,
    pub alpha: Vec<f64>,
    /// Dimension of the part of alpha that the free rows do not determine.
    pub undetermined: usize,
    /// The scale to which the acceptance test relates the residual.
    pub scale: f64,
    pub verdict: Verdict,
    pub counts: Counts,
}

impl Solution {
    /// The result of another method; if the host or the time limit has stopped it, this solution with the verdict for
    /// that.
    pub fn unless(self, found: Result<Self>) -> Result<Self> {
        match found {
            Ok(found) => Ok(found),
            Err(error) => Ok(Self { verdict: Verdict::of_refusal(error)?, ..self }),
        }
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Accepts every point whose residual is below the target; permits `allowed` steps.
    pub struct Lenient {
        pub allowed: usize,
    }

    impl AcceptanceTest for Lenient {
        fn scale(&mut self, _: &[f64], _: &[f64]) -> Result<f64> {
            Ok(1.0)
        }

        fn accepts(&mut self, _: &[f64], _: &[f64]) -> Result<bool> {
            Ok(true)
        }
    }

    impl Observer for Lenient {
        fn step(&mut self, now: &StepReport) -> Result<()> {
            if now.counts.steps() < self.allowed {
                Ok(())
            } else {
                Err(Error::new(Kind::Cancelled, "enough"))
            }
        }
    }
}
