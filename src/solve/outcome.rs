//! How an answer counts.

use crate::error::Result;
use crate::model::Accuracy;
use crate::platform::interrupt;
use crate::qp::{Solution, Verdict};
use crate::solve::case::Case;
use crate::solve::diagnosis::Contradictions;
use crate::solve::recovery::{Ending, Recovery};
use crate::solve::report::Outcome;
use crate::solve::scaled::Scaled;

/// The outcome of an answer, or the error that names why there is none. `slides`: a body slides along rows that hardly resist it.
pub fn outcome(
    case: Case,
    dual: &Scaled,
    recovery: &Recovery,
    ending: &mut Ending,
    (slides, accuracy): (bool, Accuracy),
) -> Result<Outcome> {
    let passed = ending.judgement.certificate.passed();
    let mut outcome = match of_method(case, dual, &ending.solution)? {
        Outcome::Solved if !passed => Outcome::Inaccurate,
        // beside negative stiffness an equilibrium may be no minimum
        Outcome::Stalled | Outcome::Inaccurate if passed && case.ready.dual.negative.is_empty() => {
            Outcome::Solved
        }
        outcome => outcome,
    };
    if outcome == Outcome::Solved && slides {
        outcome = Outcome::Marginal;
    }
    if let Some(taken) = dual.unheld.as_ref().filter(|taken| taken.loads.is_some()) {
        // the certificate for the host uses the host's own load
        ending.judgement =
            interrupt::never(|| recovery.judged_on(&case.data(dual.loads.clone())?, &ending.recovered))?;
        let is_marginal = taken.share > accuracy.data || !ending.judgement.certificate.passed();
        outcome = match outcome {
            Outcome::Solved if taken.share > accuracy.marginal() => Outcome::Inaccurate,
            Outcome::Solved if is_marginal => Outcome::Marginal,
            outcome => outcome,
        };
    }
    if matches!(outcome, Outcome::Inaccurate | Outcome::Stalled) && ending.judgement.travelled {
        outcome = Outcome::Marginal;
    }
    Ok(outcome)
}

/// What the verdict of the method means, or the proof that it is.
fn of_method(case: Case, dual: &Scaled, solution: &Solution) -> Result<Outcome> {
    match &solution.verdict {
        Verdict::Solved => Ok(Outcome::Solved),
        Verdict::StepLimit => Ok(Outcome::Iterations),
        Verdict::TimeLimit => Ok(Outcome::Time),
        Verdict::Cancelled => Ok(Outcome::Cancelled),
        Verdict::Stalled | Verdict::Infeasible { .. } => Ok(Outcome::Stalled),
        Verdict::Inaccurate => Ok(Outcome::Inaccurate),
        Verdict::Unbounded { p } => {
            let w: Vec<f64> = p.iter().map(|p| -p).collect();
            let w = case.ready.rows.scaling.decoupling.solve_transposed(w);
            match Contradictions::new(case, &dual.gaps).proved(&w) {
                Ok(proved) => proved.map_or(Ok(Outcome::Stalled), Err),
                Err(error) if Verdict::of_refusal(error.clone())? == Verdict::Cancelled => {
                    Ok(Outcome::Cancelled)
                }
                Err(_) => Ok(Outcome::Time),
            }
        }
    }
}
