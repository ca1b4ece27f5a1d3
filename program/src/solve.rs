//! `solve`: the answer, its certificate, and what the library has found.

use clap::ArgMatches;
use feti_contact::solver::{Certificate, LogLevel, Problem, Report, RowKind};

use crate::end::{self, End};
use crate::live::{self, Book};
use crate::table::{row, table};
use crate::{command, folder, given, json};

pub fn solve(of: &ArgMatches) -> Result<End, String> {
    let mut problem = given::problem(of)?;
    let told = command::one(of, "log").map(|level| match level {
        "result" => LogLevel::Result,
        "step" => LogLevel::Step,
        _ => LogLevel::Phase,
    });
    let book = live::log(&mut problem, LogLevel::Phase, told);
    if told.is_none() {
        live::bar(&mut problem);
    }
    let solved = problem.solve();
    live::end_bar();
    let (name, status, cure) =
        end::of(&solved.as_ref().map(|report| report.outcome).map_err(|error| error.kind));
    let why = solved
        .as_ref()
        .err()
        .map(ToString::to_string)
        .or_else(|| problem.shortfall().map(|error| error.to_string()));
    let report = solved.ok();
    if let (Some(folder), Some(_)) = (command::one(of, "write"), &report) {
        folder::write_answer(&problem, folder.as_ref())?;
    }
    let text = match of.get_flag("json") {
        true => as_json(&problem, name, status, why.as_deref(), report.as_ref(), &book),
        false => as_tables(&problem, (name, cure), why.as_deref(), report.as_ref(), &book),
    };
    Ok(End { text, status })
}

fn as_tables(
    problem: &Problem,
    (name, cure): (&str, &str),
    why: Option<&str>,
    report: Option<&Report>,
    book: &Book,
) -> String {
    let sizes = problem.sizes();
    let mut out = format!(
        "{name}: {} bodies, {} unknowns, {} contact rows, {} equality rows, {} nodes with friction\n",
        sizes.bodies, sizes.dofs, sizes.rows, sizes.equalities, sizes.nodes
    );
    if let Some(why) = why {
        out += &format!("{why}\n");
    }
    if !cure.is_empty() {
        out += &format!("remedy: {cure}\n");
    }
    if let Some(report) = report {
        out += &format!(
            "{} rows closed, {} nodes stick, {} slip; energy {:e}; {} steps, {} products, setup {:.3} s, solve {:.3} s\n",
            report.active, report.sticking, report.slipping, report.energy, report.counts.steps(), report.counts.products,
            report.seconds_setup, report.seconds_solve
        );
        out +=
            &format!("\ncertificate, limit {:.1e} (a ratio of at most 1 passes)\n", report.certificate.limit);
        out += &certificate(&report.certificate, sizes.nodes > 0);
    }
    let found = findings(problem).into_iter().chain(live::notes(book)).collect::<Vec<_>>();
    if !found.is_empty() {
        out += "\nfindings\n";
        found.iter().for_each(|line| out += &format!("  {line}\n"));
    }
    out
}

/// The table of a certificate; without friction without its three errors.
pub fn certificate(of: &Certificate, friction: bool) -> String {
    let mut rows = vec![row(["condition", "error", "ratio", "worst at"])];
    for ((name, kind), entry) in Certificate::NAMES.iter().zip(of.entries()) {
        if !friction && name.starts_with("friction") {
            continue;
        }
        let place = entry.place.map_or(String::new(), |place| format!("{kind} {place}"));
        rows.push(vec![
            (*name).to_owned(),
            format!("{:.1e}", entry.figure),
            format!("{:.1e}", entry.ratio),
            place,
        ]);
    }
    table(&rows)
}

/// What the last solve has found, a line for each.
pub fn findings(problem: &Problem) -> Vec<String> {
    let Ok(found) = problem.findings() else { return Vec::new() };
    let mut lines = Vec::new();
    let mut several = |what: &str, of: &[usize]| {
        if let Some(first) = of.first() {
            let more = if of.len() > 1 { format!(" and {} more", of.len() - 1) } else { String::new() };
            lines.push(format!("body {first}{more}: {what}"));
        }
    };
    several("no row touches it", &found.untouched);
    several("a motion may be resisted by rounding of K alone", &found.doubtful);
    several("a motion has a small positive or negative stiffness", &found.soft);
    if found.undetermined > 0 {
        lines.push(format!("{} rigid motions that neither rows nor loads determine", found.undetermined));
    }
    if let Some(motion) = found.motion {
        lines.push(format!("the motion: velocity {:?}, rotation {:?}", &motion[..3], &motion[3..]));
    }
    let rows: Vec<String> = [RowKind::Inequality, RowKind::Equality]
        .iter()
        .flat_map(|kind| {
            found.rows(*kind).map(|(row, weight)| format!("{} {row} (weight {weight:.1e})", kind.name()))
        })
        .collect();
    if found.contradicting() > 0 && !rows.is_empty() {
        lines.push(format!("rows that contradict each other: {}", rows.join(", ")));
    }
    lines
}

pub fn certificate_json(of: &Certificate) -> String {
    let entries = Certificate::NAMES.iter().zip(of.entries()).map(|((name, kind), entry)| {
        let place = entry.place.map_or("null".to_owned(), |place| json::text(&format!("{kind} {place}")));
        let values =
            [("error", json::number(entry.figure)), ("ratio", json::number(entry.ratio)), ("place", place)];
        (*name, json::object(&values))
    });
    json::object(&entries.collect::<Vec<_>>())
}

fn as_json(
    problem: &Problem,
    name: &str,
    status: u8,
    why: Option<&str>,
    report: Option<&Report>,
    book: &Book,
) -> String {
    let sizes = problem.sizes();
    let mut items = vec![
        ("status", json::text(name)),
        ("exit", status.to_string()),
        ("text", why.map_or("null".to_owned(), json::text)),
        ("bodies", sizes.bodies.to_string()),
        ("unknowns", sizes.dofs.to_string()),
        ("contact_rows", sizes.rows.to_string()),
        ("equality_rows", sizes.equalities.to_string()),
        ("nodes_with_friction", sizes.nodes.to_string()),
        (
            "findings",
            json::array(findings(problem).iter().chain(&live::notes(book)).map(|line| json::text(line))),
        ),
    ];
    if let Some(report) = report {
        items.extend([
            ("closed", report.active.to_string()),
            ("sticking", report.sticking.to_string()),
            ("slipping", report.slipping.to_string()),
            ("undetermined", report.undetermined.to_string()),
            ("energy", json::number(report.energy)),
            ("steps", report.counts.steps().to_string()),
            ("products", report.counts.products.to_string()),
            ("seconds_setup", json::number(report.seconds_setup)),
            ("seconds_solve", json::number(report.seconds_solve)),
            ("limit", json::number(report.certificate.limit)),
            ("certificate", certificate_json(&report.certificate)),
        ]);
    }
    json::object(&items) + "\n"
}
