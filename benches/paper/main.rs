//! The three problems of the paper by its own method and by the default. One line a figure,
//!
//! ```text
//! paper <problem> <quantity> paper <value> ours <value> default <value> ok|differs
//! ```
//!
//! and a line of details per problem. In the folder given (docs) the rows of the table in paper.md are written anew, and
//! the pictures. paper.md explains every figure. Exit code 1 where a problem is not solved; `differs` alone leaves it 0.

#[allow(dead_code)]
#[path = "../../tests/reference/case.rs"]
mod case;
mod drawings;
#[path = "../plot/mod.rs"]
mod plot;
mod problems;
mod run;

use std::path::Path;
use std::process::ExitCode;

use problems::{Figure, Problem, PROBLEMS};
use run::Run;

fn main() -> ExitCode {
    let folder = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let folder = folder.unwrap_or_else(|| "docs".into());
    let (mut rows, mut failed) = (Vec::new(), 0);
    for problem in &PROBLEMS {
        match (run::by_paper(problem), run::by_default(problem)) {
            (Ok(paper), Ok(default)) => rows.extend(report(problem, &paper, &default)),
            (paper, default) => {
                failed += 1;
                let why = [paper.err(), default.err()].into_iter().flatten().collect::<Vec<_>>().join("; ");
                println!("paper {} failed: {why}", problem.name);
            }
        }
    }
    let table = Path::new(&folder).join("paper.md");
    let written = if failed == 0 { handbook(&table, &rows) } else { Ok(()) };
    match written.and_then(|()| drawings::all(&Path::new(&folder).join("pictures"))) {
        Ok(names) => names.iter().for_each(|name| println!("picture {name}")),
        Err(why) => {
            failed += 1;
            println!("handbook failed: {why}");
        }
    }
    let differ = rows.iter().filter(|row| row.ends_with("| differs |")).count();
    println!("paper: {} problems, {differ} figures differ, {failed} failed", PROBLEMS.len());
    if failed > 0 {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

/// Prints the lines of one problem and gives them as rows of the table.
fn report(problem: &Problem, paper: &Run, default: &Run) -> Vec<String> {
    let mut rows = Vec::new();
    let mut line = |quantity: &str, figure: &Figure, ours: f64, default: Option<f64>| {
        let word = if figure.holds(ours) { "ok" } else { "differs" };
        let (name, printed) = (problem.name, figure.printed.map_or("-".into(), number));
        let (ours, default) = (number(ours), default.map_or("-".into(), number));
        println!("paper {name} {quantity} paper {printed} ours {ours} default {default} {word}");
        rows.push(format!("| {name} | {quantity} | {printed} | {ours} | {default} | {word} |"));
    };
    let figures = &problem.figures;
    line("outer", &figures.outer, paper.outer as f64, None);
    line("inner", &figures.inner, paper.inner as f64, Some(default.inner as f64));
    line("products", &figures.products, paper.products as f64, Some(default.products as f64));
    line("unknowns", &figures.unknowns, paper.unknowns as f64, Some(default.unknowns as f64));
    line("duals", &figures.duals, paper.duals as f64, Some(default.duals as f64));
    line("accuracy", &figures.accuracy, paper.accuracy, Some(default.accuracy));
    println!("    {}; default: {}", paper.details(), default.details());
    rows
}

/// Puts the rows in the place of those under the head of the table.
fn handbook(path: &Path, rows: &[String]) -> Result<(), String> {
    const HEAD: &str = "| problem | quantity | paper | ours | default | |\n|---|---|---|---|---|---|\n";
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let (before, rest) = text.split_once(HEAD).ok_or("paper.md has no table of figures")?;
    let after = rest.split_once("\n\n").map_or("", |(_, after)| after);
    let text = format!("{before}{HEAD}{}\n\n{after}", rows.join("\n"));
    std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

/// Whole numbers as such, others with two digits.
fn number(value: f64) -> String {
    if value.fract() == 0.0 {
        format!("{value}")
    } else {
        format!("{value:.1e}")
    }
}
