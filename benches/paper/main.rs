//! The three problems of the paper by its own method and by the default. One line a figure,
//!
//! ```text
//! paper <problem> <quantity> paper <value> ours <value> default <value> ok|differs
//! ```
//!
//! a line of details per problem, and pictures in the folder given (docs/pictures). docs/paper.md explains every
//! figure. Exit code 1 where a problem is not solved; `differs` alone leaves it 0.

#[allow(dead_code)]
#[path = "../../tests/reference/case.rs"]
mod case;
mod drawings;
mod plot;
mod problems;
mod run;

use std::process::ExitCode;

use problems::{Figure, Problem, PROBLEMS};
use run::Run;

fn main() -> ExitCode {
    let folder = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let folder = folder.unwrap_or_else(|| "docs/pictures".into());
    let (mut differ, mut failed) = (0, 0);
    for problem in &PROBLEMS {
        match (run::by_paper(problem), run::by_default(problem)) {
            (Ok(paper), Ok(default)) => {
                differ += report(problem, &paper, &default);
            }
            (paper, default) => {
                failed += 1;
                let why = [paper.err(), default.err()].into_iter().flatten().collect::<Vec<_>>().join("; ");
                println!("paper {} failed: {why}", problem.name);
            }
        }
    }
    match drawings::all(std::path::Path::new(&folder)) {
        Ok(names) => names.iter().for_each(|name| println!("picture {name}")),
        Err(why) => {
            failed += 1;
            println!("pictures failed: {why}");
        }
    }
    println!("paper: {} problems, {differ} figures differ, {failed} failed", PROBLEMS.len());
    if failed > 0 {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

/// The lines of one problem; how many of its figures differ.
fn report(problem: &Problem, paper: &Run, default: &Run) -> usize {
    let mut differ = 0;
    let mut line = |quantity: &str, figure: &Figure, ours: f64, default: Option<f64>| {
        let word = if figure.holds(ours) { "ok" } else { "differs" };
        differ += usize::from(word == "differs");
        let printed = figure.printed.map_or("-".into(), number);
        let (ours, default) = (number(ours), default.map_or("-".into(), number));
        println!("paper {} {quantity} paper {printed} ours {ours} default {default} {word}", problem.name);
    };
    let figures = &problem.figures;
    line("outer", &figures.outer, paper.outer as f64, None);
    line("inner", &figures.inner, paper.inner as f64, Some(default.inner as f64));
    line("products", &figures.products, paper.products as f64, Some(default.products as f64));
    line("unknowns", &figures.unknowns, paper.unknowns as f64, Some(default.unknowns as f64));
    line("duals", &figures.duals, paper.duals as f64, Some(default.duals as f64));
    line("accuracy", &figures.accuracy, paper.accuracy, Some(default.accuracy));
    println!("    {}; default: {}", paper.details(), default.details());
    differ
}

/// Whole numbers as such, others with two digits.
fn number(value: f64) -> String {
    if value.fract() == 0.0 {
        format!("{value}")
    } else {
        format!("{value:.1e}")
    }
}
