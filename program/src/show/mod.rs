//! `show`: what the problem has, and what in it is suspicious, each with its place and a remedy.

mod bodies;
mod geometry;
mod library;
mod overview;
mod rows;

use clap::ArgMatches;

use crate::contents::Contents;
use crate::end::{self, End};
use crate::{command, given, json};

/// Seconds for the solve that looks for faults, unless the user says otherwise.
const SECONDS: f64 = 60.0;

/// Something that the user may not have intended.
pub struct Suspicion {
    pub place: String,
    pub what: String,
    pub remedy: &'static str,
}

impl Suspicion {
    pub fn new(place: String, what: impl Into<String>, remedy: &'static str) -> Self {
        Self { place, what: what.into(), remedy }
    }
}

pub fn show(of: &ArgMatches) -> Result<End, String> {
    let mut problem = given::problem(of)?;
    let options = problem.settings().changes();
    if command::one(of, "time-limit").is_none() {
        problem.set_f64("time_limit", SECONDS).map_err(|error| error.to_string())?;
    }
    let contents = Contents::of(&problem)?;
    let mut found = bodies::suspicions(&contents);
    found.extend(rows::suspicions(&contents));
    found.extend(geometry::suspicions(&contents));
    // the library's own words last: they name the same faults by their effect
    found.extend(library::suspicions(&mut problem));
    let status = if found.is_empty() { end::OK } else { end::INCOMPLETE };
    let text = match of.get_flag("json") {
        true => as_json(&found),
        false => overview::text(&problem, &Contents::of(&problem)?, &options) + &as_text(&found),
    };
    Ok(End { text, status })
}

fn as_text(found: &[Suspicion]) -> String {
    if found.is_empty() {
        return "\nnothing suspicious\n".to_owned();
    }
    let line = |of: &Suspicion| format!("  {}: {}\n    remedy: {}\n", of.place, of.what, of.remedy);
    format!("\nsuspicious: {}\n{}", found.len(), found.iter().map(line).collect::<String>())
}

fn as_json(found: &[Suspicion]) -> String {
    let one = |of: &Suspicion| {
        json::object(&[
            ("place", json::text(&of.place)),
            ("what", json::text(&of.what)),
            ("remedy", json::text(of.remedy)),
        ])
    };
    json::object(&[("suspicious", json::array(found.iter().map(one)))]) + "\n"
}

/// `what 3, 5, 7 and 4 more`
pub fn listed(what: &str, numbers: &[usize]) -> String {
    let shown: Vec<_> = numbers.iter().take(3).map(usize::to_string).collect();
    let more = numbers.len().saturating_sub(3);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{what} {}{more}", shown.join(", "))
}

/// The middle of some numbers; none of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
