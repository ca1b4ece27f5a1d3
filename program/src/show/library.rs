//! What the library itself finds: errors, findings, warnings and notes of its log.

use feti_contact::error::Kind;
use feti_contact::solver::{LogLevel, Problem};

use crate::show::{listed, Suspicion};
use crate::{end, live};

/// Parts of warnings that say what the answer is, and are no faults of the input.
const FACTS: [&str; 2] = ["no body has a load", "are left open"];

/// Parts of lines of the log that are faults of the input, and what to do; other notes are facts.
const REMEDIES: [(&str, &str); 10] = [
    ("coefficient of friction", "give the coefficient as a number: 0.3, not 30 per cent"),
    ("no stiffness, no row and no load", "leave the unknown out, or give the elements that hold it"),
    ("multiple of its contact row", "give tangential rows that are perpendicular to the normal"),
    ("length of its shortest", "multiply the rows of a node by the same number"),
    ("because the row has no entry", "leave the row out, or give its entries"),
    (
        "the row constrains nothing",
        "check which unknowns the row joins: a row between the same unknowns cancels",
    ),
    ("of those of all other rows", "multiply the row by a number, or leave it out"),
    ("neither gaps nor right-hand sides move", "give loads, gaps or prescribed motions"),
    ("searched its null space", "check coordinates and directions of the unknowns of this body"),
    ("digits", "write K with all digits of double precision (17), or give coordinates"),
];

pub fn suspicions(problem: &mut Problem) -> Vec<Suspicion> {
    let book = live::log(problem, LogLevel::Phase, None);
    live::bar(problem);
    let solved = problem.solve();
    live::end_bar();
    let mut found = Vec::new();
    let (name, status, cure) =
        end::of(&solved.as_ref().map(|report| report.outcome).map_err(|error| error.kind));
    if status != end::OK {
        let why = solved.as_ref().err().cloned().or_else(|| problem.shortfall());
        let (place, what) = why.map_or((String::new(), String::new()), |error| {
            let text = error.to_string();
            let place = error.place.to_string();
            (place.trim_end_matches(": ").to_owned(), text[place.len()..].to_owned())
        });
        let place = if place.is_empty() { "the problem".to_owned() } else { place };
        found.push(Suspicion::new(
            place,
            if what.is_empty() { name.to_owned() } else { format!("{name}: {what}") },
            cure,
        ));
    }
    let findings = problem.findings().ok();
    if let Some(of) = findings.filter(|of| !of.untouched.is_empty()) {
        let remedy = "give rows to the pairs of this body, or leave it out";
        found.push(Suspicion::new(listed("body", &of.untouched), "no row touches it", remedy));
    }
    if let Some(of) = findings.filter(|of| of.contradicting() > 0) {
        for kind in [feti_contact::solver::RowKind::Inequality, feti_contact::solver::RowKind::Equality] {
            let rows: Vec<usize> = of.rows(kind).map(|(row, _)| row).collect();
            if !rows.is_empty() {
                let what = "contradicts the other rows of the proof";
                found.push(Suspicion::new(listed(kind.name(), &rows), what, Kind::GapsContradict.cure()));
            }
        }
    }
    for line in live::notes(&book) {
        let is_warning = line.starts_with("warning: ");
        let known = REMEDIES.iter().find(|(part, _)| line.contains(part));
        let is_fact = known.is_none() && FACTS.iter().any(|part| line.contains(part));
        if known.is_none() && !is_warning || is_fact {
            continue;
        }
        let text = line.split_once(": ").map_or(&*line, |(_, text)| text);
        let (place, what) = match text.split_once(": ") {
            Some((place, what)) => (place.to_owned(), what),
            None => (named(text).unwrap_or_else(|| "the problem".to_owned()), text),
        };
        let remedy = known.map_or("see the text", |(_, remedy)| remedy);
        found.push(Suspicion::new(place, what, remedy));
    }
    found
}

/// The first body, node or row that a text names.
fn named(text: &str) -> Option<String> {
    let words: Vec<&str> = text.split(' ').collect();
    let at = words
        .windows(2)
        .position(|pair| ["body", "node", "row"].contains(&pair[0]) && pair[1].parse::<usize>().is_ok())?;
    let kind = at
        .checked_sub(1)
        .map(|k| words[k])
        .filter(|_| words[at] == "row")
        .map_or(String::new(), |kind| format!("{kind} "));
    Some(format!("{kind}{} {}", words[at], words[at + 1]))
}
