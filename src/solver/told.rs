//! The log lines of a call: what is solved and how, the result, warnings.

use std::fmt::Write;

use crate::certificate::Certificate;
use crate::error::Result;
use crate::model::{Counted, HostModel, Sizes, SolvedModel, Word};
use crate::progress::{Log, LogLevel};
use crate::setup::{Duals, Prepared, Ready};
use crate::solve::{Outcome, Report, Slide};

/// Sizes and options at the start of a call.
pub fn begin(log: &Log, model: &HostModel, call: &str) -> Result<()> {
    log.begin();
    let (sizes, version) = (model.sizes(), env!("CARGO_PKG_VERSION"));
    let Sizes { bodies, dofs, rows, equalities, nodes, .. } = sizes;
    log.say(LogLevel::Phase, || {
        let friction = if nodes > 0 { format!(", {nodes} nodes with friction") } else { String::new() };
        format!(
            "feti-contact {version}: {call}: {bodies} bodies, {dofs} unknowns, {rows} contact rows, \
             {equalities} equality rows{friction}"
        )
    })?;
    log.say(LogLevel::Phase, || match model.settings.changes() {
        changes if changes.is_empty() => "options: defaults".to_owned(),
        changes => format!("options: {changes}"),
    })
}

/// One line on the answer, and warnings.
pub fn result(log: &Log, model: &HostModel, report: &Report) -> Result<()> {
    log.say(LogLevel::Result, || result_line(report))?;
    if let Some(body) = report.travelled {
        let body = &model.number_of(Counted::Body, body);
        log.say(LogLevel::Result, || {
            format!(
                "warning: the load of body {body} is below the rounding of its displacement and counts as none: its strain is \
                 lost, and of its forces only their balance is certain"
            )
        })?;
    }
    let told = report.slide.is_some() || report.travelled.is_some();
    if report.outcome == Outcome::Marginal && (!told || report.unheld > 0.0) {
        let what = "warning: a small part of the load, below 1e-7 of it, is held by no row";
        log.say(LogLevel::Result, || what.to_owned())?;
    }
    if let Some(Slide { resisted, travel, body, .. }) = report.slide {
        let body = &model.number_of(Counted::Body, body);
        log.say(LogLevel::Result, || {
            format!(
                "warning: body {body} moves as a rigid body by {travel:.1e} times its deformation, along a motion that its rows \
                 with forces resist by only {resisted:.1e} of their terms; if this is the accuracy of normals or \
                 coordinates, set data_accuracy to more"
            )
        })?;
    }
    let open = report.undetermined;
    if open > 0 {
        log.say(LogLevel::Result, || {
            format!("warning: {open} motions are left open: neither rows nor loads determine them")
        })?;
    }
    Ok(())
}

fn result_line(report: &Report) -> String {
    let ended = match report.outcome {
        Outcome::Solved => "solved",
        Outcome::Iterations => "ended at the limit of steps",
        Outcome::Time => "ended at the limit of time",
        Outcome::Cancelled => "cancelled by the host",
        Outcome::Stalled => "stalled",
        Outcome::Inaccurate => "inaccurate",
        Outcome::Marginal => "marginal",
    };
    let certificate = &report.certificate;
    let mut line = format!(
        "{ended}: {} steps, {} products, {} of {} contact rows closed{}; certificate",
        report.counts.steps(),
        report.counts.products,
        report.active,
        report.sizes.rows,
        friction(report)
    );
    let told = |name: &str| report.sizes.nodes > 0 || !name.starts_with("friction");
    let figures = Certificate::NAMES.iter().zip(certificate.entries());
    for ((name, _), entry) in figures.filter(|((name, _), _)| told(name)) {
        let _ = write!(line, " {name} {:.1e},", entry.figure);
    }
    let _ = write!(
        line,
        " limit {:.1e}; setup {:.6} seconds, solve {:.6} seconds",
        certificate.limit, report.seconds_setup, report.seconds_solve
    );
    line
}

/// States of the nodes with friction, and the work to find them.
fn friction(report: &Report) -> String {
    match (report.sizes.nodes, report.starts) {
        (0, _) => String::new(),
        (nodes, 0) => format!(", {nodes} nodes without friction"),
        (nodes, starts) => format!(
            ", {} of {nodes} nodes stick and {} slip ({} Newton steps, {starts} starts)",
            report.sticking, report.slipping, report.newton
        ),
    }
}

/// The method for the dual problem.
pub fn method(log: &Log, model: &SolvedModel, prepared: &Prepared, started: &str) -> Result<()> {
    let Duals { islands, operators, .. } = prepared.done(model)?;
    let of_island = |ready: &Ready| ready.preconditioning().word().to_string_lossy();
    let mut preconditioners: Vec<_> = islands.iter().map(of_island).collect();
    preconditioners.sort_unstable();
    preconditioners.dedup();
    log.say(LogLevel::Phase, || {
        let implicit = operators.implicit.iter().filter(|implicit| **implicit).count();
        let groups = match islands.len() {
            1 => String::new(),
            count => format!("{count} independent groups of bodies, "),
        };
        let rubbing = islands.iter().filter(|ready| ready.island.has_friction()).count();
        let mut methods = Vec::new();
        if rubbing < islands.len() || rubbing == 0 {
            methods.push(model.settings.method.word().to_string_lossy().into_owned());
        }
        if rubbing > 0 {
            methods.push("Newton's method with friction".to_string());
        }
        format!(
            "method: {}, preconditioner {}, start {started}; {groups}{} multipliers, {} floating modes, \
             {} explicit and {implicit} implicit dual operators",
            methods.join(" and "),
            preconditioners.join(" and "),
            islands.iter().map(|ready| ready.rows.groups()).sum::<usize>(),
            islands.iter().map(|ready| ready.dual.modes()).sum::<usize>(),
            operators.implicit.len() - implicit
        )
    })
}
