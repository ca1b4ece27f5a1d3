//! Translates between the host's problem and the problem that is solved, in which parts replace bodies.

use crate::decomposition::{self, Decomposition};
use crate::error::{Error, Result};
use crate::linalg::Matrix;
use crate::model::{HostModel, Parts, SolvedModel};
use crate::setup::{Prepared, Whole};
use crate::solve::{Answer, Shown, Stays};
use crate::solver::findings::Findings;

/// Whether the bodies that are solved are the same unknowns of the host.
pub fn same_bodies(a: &Option<Decomposition>, b: &Option<Decomposition>) -> bool {
    let parts = |of: &Option<Decomposition>| of.as_ref().and_then(|of| of.model.parts.clone());
    match (parts(a), parts(b)) {
        (Some(a), Some(b)) => a.same(&b),
        (Some(parts), None) | (None, Some(parts)) => parts.parts.iter().all(|part| part.whole),
        (None, None) => true,
    }
}

pub fn solved<'a>(host: &'a HostModel, decomposition: &'a Option<Decomposition>) -> &'a SolvedModel {
    decomposition.as_ref().map_or(host, |of| &of.model)
}

pub fn of_host(host: &HostModel, decomposition: &Option<Decomposition>, error: Error) -> Error {
    match decomposition.as_ref().and_then(|of| of.model.parts.as_deref()) {
        Some(parts) => decomposition::of_host(host, parts, error),
        None => error,
    }
}

/// Converts the answer for the pieces to an answer for the host's bodies. Forces of glue follow those of the host's
/// equality rows: first the forces of joints.
pub fn answer_of_host(
    host: &HostModel,
    solved: &SolvedModel,
    prepared: &Prepared,
    mut answer: Answer,
    stays: &mut Stays,
) -> Result<Answer> {
    let Some(parts) = solved.parts.as_deref() else { return Ok(answer) };
    let starts = host.starts();
    answer.u = parts.mean_from(&answer.u, (&solved.starts(), &starts))?;
    for (j, _) in &mut stays.at {
        let part = parts.starts[1..].partition_point(|end| end <= j);
        *j = parts.offsets[parts.parts[part].body] + parts.place(part, *j - parts.starts[part]).0;
    }
    stays.at.sort_unstable_by_key(|of| of.0);
    let shown = Shown::new(host, &answer.u, stays);
    let gap = |i: usize| host.contact.open_gap_at(i, |j| shown.at(j), answer.lambda[i]);
    let gaps = (0..host.contact.len()).map(gap).collect();
    answer.gaps = gaps;
    answer.slips = answer.slips_of(host, |j| shown.at(j));
    let bodies = 0..host.bodies.len();
    let worst =
        |body: usize| parts.of(body).fold(0.0, |worst: f64, part| worst.max(answer.force_errors[part]));
    answer.force_errors = bodies.clone().map(worst).collect();
    let amplitudes = |body: usize| match whole_of(prepared, parts, body).filter(|_| parts.is_cut(body)) {
        Some(whole) => whole.amplitudes(solved, body, &answer.u[starts[body]..starts[body + 1]]),
        None => parts.of(body).flat_map(|part| answer.alpha[part].iter().copied()).collect(),
    };
    answer.alpha = bodies.map(amplitudes).collect();
    let report = &mut answer.report;
    report.sizes = host.sizes();
    report.body = report.body.map(|part| parts.parts[part].body);
    report.floating_modes = answer.alpha.iter().map(Vec::len).sum();
    Ok(answer)
}

/// The island of a body in terms of the host's bodies, if it contains pieces.
fn whole_of<'a>(prepared: &'a Prepared, parts: &Parts, body: usize) -> Option<&'a Whole> {
    let duals = prepared.made_last()?;
    duals.islands[duals.island_of[parts.first[body]]].whole()
}

pub fn null_space_of<'a>(prepared: &'a Prepared, parts: &Parts, body: usize) -> Option<&'a Matrix> {
    whole_of(prepared, parts, body)?.null_space(body)
}

pub fn findings_of_host(host: &HostModel, solved: &SolvedModel, mut findings: Findings) -> Findings {
    let bodies = |numbers: &[usize]| {
        let mut bodies: Vec<usize> = numbers.iter().map(|part| solved.name(*part)).collect();
        bodies.dedup();
        bodies
    };
    (findings.doubtful, findings.soft) = (bodies(&findings.doubtful), bodies(&findings.soft));
    findings.redundant.retain(|(row, _)| *row < host.contact.len() + host.equalities.len());
    findings
}
