//! Solves that have to end with an answer.

use feti_contact::solver::{Outcome, Problem, Report};

/// The report of a solve that ended with an answer as good as asked for.
pub fn solved(problem: &mut Problem, what: &str) -> Result<Report, String> {
    let report = problem.solve().map_err(|error| format!("{what}: {error}"))?;
    if report.outcome == Outcome::Solved {
        return Ok(report);
    }
    let (outcome, worst) = (report.outcome, report.certificate.worst());
    let products = report.counts.products;
    Err(format!("{what}: {outcome:?} after {products} products with F, certificate {worst:.1e} of its limit"))
}
