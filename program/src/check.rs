//! `check`: whether the library takes the input, and the certificate of an answer.

use std::path::Path;

use clap::ArgMatches;
use feti_contact::solver::{Candidate, LogLevel};

use crate::end::{self, End};
use crate::solve::{certificate, certificate_json};
use crate::{command, folder, given, json, live};

pub fn check(of: &ArgMatches) -> Result<End, String> {
    let mut problem = given::problem(of)?;
    let book = live::log(&mut problem, LogLevel::Result, None);
    live::bar(&mut problem);
    let ready = problem.setup();
    live::end_bar();
    ready.map_err(|error| format!("{}: {error}", error.kind.status()))?;
    let file = Path::new(command::file(of));
    let answer = match command::one(of, "answer") {
        Some(folder) => {
            Some(folder::answer(folder.as_ref(), &problem)?.ok_or(format!("{folder}: there is no u.txt"))?)
        }
        None if file.is_dir() => folder::answer(file, &problem)?,
        None => None,
    };
    let sizes = problem.sizes();
    let certificate_of = |[u, lambda, mu, tangential]: [Vec<f64>; 4]| {
        let answer = Candidate { u: &u, lambda: &lambda, mu: &mu, tangential: &tangential };
        problem.check_with_friction(answer).map_err(|error| error.to_string())
    };
    let checked = answer.map(certificate_of).transpose()?;
    let status = match &checked {
        Some(of) if !of.passed() => end::INCOMPLETE,
        _ => end::OK,
    };
    let notes = live::notes(&book);
    if of.get_flag("json") {
        let items = [
            ("input", json::text("accepted")),
            ("passes", checked.as_ref().map_or("null".to_owned(), |_| (status == end::OK).to_string())),
            ("certificate", checked.as_ref().map_or("null".to_owned(), certificate_json)),
            ("findings", json::array(notes.iter().map(|line| json::text(line)))),
        ];
        return Ok(End { text: json::object(&items) + "\n", status });
    }
    let mut text = format!(
        "the input is accepted: {} bodies, {} unknowns, {} contact rows, {} equality rows, {} nodes with friction\n",
        sizes.bodies, sizes.dofs, sizes.rows, sizes.equalities, sizes.nodes
    );
    notes.iter().for_each(|line| text += &format!("{line}\n"));
    text += &match &checked {
        None => "there is no answer to check: --answer FOLDER names one\n".to_owned(),
        Some(of) => {
            let verdict = if status == end::OK { "passes" } else { "does not pass" };
            format!("the answer {verdict}, limit {:.1e}\n{}", of.limit, certificate(of, sizes.nodes > 0))
        }
    };
    Ok(End { text, status })
}
