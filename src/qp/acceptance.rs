//! The acceptance test, which makes the final decision about a point, and the reports of a run: its steps, its end.

use crate::error::{Error, Kind, Result};
use crate::linalg::vector::norm;
use crate::qp::gradient::Split;
use crate::qp::Counts;

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// The projected gradient is small at `tolerance` x the scale of the judge.
    pub tolerance: f64,
    /// Gamma > 0 of the proportionality test, no unit.
    pub gamma: f64,
    pub steps: usize,
}

/// The acceptance test. Knows what the numbers mean: gives the length the residual is measured against, and the last word.
pub trait AcceptanceTest {
    /// Scale of the gaps at the point x with multiplier alpha.
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64>;
    /// Whether the answer recovered from (x, alpha) passes its certificate.
    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool>;
    /// How many times too large what the last point was refused for is; not known to one who does not ask.
    fn missed(&self) -> Option<f64> {
        None
    }
    /// It judges by better data than A and b: a residual of zero might be refused.
    fn has_better_data(&self) -> bool {
        false
    }
    /// A solution that was not accepted, mended by better data than A and b until it is; none where that fails.
    fn mended(&mut self, _: &Solution) -> Result<Option<Solution>> {
        Ok(None)
    }
    /// The scale without any travel, at the point accepted last; not known before, or to one who does not ask.
    fn length(&self) -> Option<f64> {
        None
    }
}

/// Sees every step; an error ends the run, with the point reached where it says `Cancelled` or `TimeOver`.
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

/// Where the method stands after a step.
pub struct StepReport<'a> {
    pub kind: StepKind,
    pub counts: &'a Counts,
    pub active: &'a [bool],
    pub theta: f64,
    /// Norms of `g^P`, of its parts `g^I` (22) and `g^C` (23), and the norm that counts as zero.
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
    /// The judge accepted the answer.
    Solved,
    StepLimit,
    TimeLimit,
    Cancelled,
    /// theta no longer decreases, and the judge does not accept.
    Stalled,
    /// The residual is as small as asked, eight times over, and the judge does not accept.
    Inaccurate,
    /// No x >= 0 was found with `G x = e`; that of the solution comes nearest, `direction = e - G x`. Where G resists it
    /// nowhere, `G_i'direction <= 0` (`= 0` where x_i is free), it proves that there is none; `margin = |direction| / |e|`.
    Infeasible {
        direction: Vec<f64>,
        margin: f64,
    },
    /// theta falls without end along `-p`.
    Unbounded {
        p: Vec<f64>,
    },
}

impl Verdict {
    /// How a run ends that observer or operator would not let go on.
    pub fn of_refusal(error: Error) -> Result<Self> {
        match error.kind {
            Kind::Cancelled => Ok(Self::Cancelled),
            Kind::TimeOver => Ok(Self::TimeLimit),
            _ => Err(error),
        }
    }

    /// What was found for a solution that ends so; where the host or the time has refused it, `otherwise` and the verdict of that.
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
    /// Dimension of the part of alpha that the free rows leave undetermined.
    pub undetermined: usize,
    /// What the judge measured the residual against.
    pub scale: f64,
    pub verdict: Verdict,
    pub counts: Counts,
}

impl Solution {
    /// What another method found, or, where the host or the time has refused it, this solution with the verdict of that.
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

    /// Accepts every point whose residual is as small as asked; sees `allowed` steps.
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
