//! A whole contact solve against one analysis and factorisation of K by CHOLMOD, and against two solvers of quadratic
//! programs; and the factorisation of K alone against faer's. One line a figure,
//!
//! ```text
//! bench <deck> <figure> <value> goal <g> ok|short
//! ```
//!
//! with details below, and a closing line with the number short. Arguments: names of decks, none for all; `scaling` runs
//! series of decks and draws them instead. Every run is a process of its own; raw figures go to benches/runs. Exit code 1 when a run fails; a short figure alone leaves it 0.

mod backing;
mod clock;
#[path = "../../tests/support/compiler.rs"]
mod compiler;
mod cut;
mod details;
mod factors;
mod figures;
#[path = "../../tests/support/hand_over.rs"]
mod hand_over;
mod matrix;
mod ours;
mod parts;
mod peers;
mod pictures;
#[path = "../plot/mod.rs"]
mod plot;
mod problems;
mod programs;
mod runs;
mod scaling;
mod steps;
mod surfaces;
mod sweeps;

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use figures::Figure;
use peers::Peers;
use problems::{Case, Model, CASES, PEERS};
use programs::Program;
use runs::Runs;

const SURFACES: &str = "surfaces";
const SURFACES_ROUNDS: usize = 5;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["child", kind, deck, threads] => child(kind, deck, threads),
        ["scaling", ref rest @ ..] => scaling::run(rest),
        _ => benchmark(&words),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

/// One run in this process.
fn child(kind: &str, deck: &str, threads: &str) -> Result<(), String> {
    let model = || problems::case(deck).map(|case| case.model).ok_or("no such deck");
    let build = || model().map(Model::build);
    let by_elements = || model()?.by_elements().ok_or_else(|| "no deck by elements".to_string());
    match kind {
        "ours" => ours::run(build()?, threads.parse().map_err(|_| "no number of threads")?, 0),
        "few" => ours::run(build()?, threads.parse().map_err(|_| "no number of threads")?, 1),
        "frictionless" => ours::run(model()?.frictionless(), 1, 0),
        "cut" => cut::run(by_elements()?, 0, threads.parse().map_err(|_| "no number of threads")?),
        "pieces" => cut::run(by_elements()?, threads.parse().map_err(|_| "no number of pieces")?, 2),
        "later" => cut::later(by_elements),
        "surfaces" => surfaces::run(threads.parse().map_err(|_| "no number of threads")?),
        "parts" => parts::run(&build()?).map_err(|error| error.to_string()),
        "factor" => factors::run(&build()?, threads.parse().map_err(|_| "no number of threads")?),
        _ => parts::bandwidth().map_err(|error| error.to_string()),
    }
}

fn benchmark(wanted: &[&str]) -> Result<(), String> {
    let wants = |name: &str| wanted.is_empty() || wanted.contains(&name);
    let peers = Peers::set_up(wants(PEERS))?;
    let mut runs = Runs::new(&Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/runs"), "bench")?;
    let (mut lines, mut short, mut failed) = (0, 0, 0);
    let mut judge = |figures: Vec<Figure>| {
        lines += figures.len();
        short += print(&figures);
    };
    let can_run = |case: &Case| case.name != PEERS || peers.has_packages();
    for case in CASES.iter().filter(|case| wants(case.name) && can_run(case)) {
        match measure(case, &mut runs, &peers) {
            Ok(blas) => {
                judge(figures::of(case.name, &runs));
                details::print(case, &runs, &blas);
            }
            Err(why) => {
                failed += 1;
                println!("bench {} failed: {why}", case.name);
            }
        }
        peers.remove(case);
    }
    if wants("product") {
        runs.run("product", Program::Bandwidth, 1, &peers)?;
        judge(figures::of("product", &runs));
    }
    if wants(SURFACES) {
        for (round, threads) in (1..=SURFACES_ROUNDS).flat_map(|round| [(round, 1), (round, 2)]) {
            runs.run(SURFACES, Program::Surfaces(threads), round, &peers)?;
        }
        judge(figures::of_surfaces(SURFACES, &runs));
    }
    judge(figures::between(&runs));
    println!(
        "bench: {lines} figures, {short} short, {failed} failed; raw figures in {}",
        runs.path.display()
    );
    if failed > 0 {
        return Err(format!("{failed} decks failed"));
    }
    Ok(())
}

/// Lines appear as they are found, also in a pipe. Gives the number short.
fn print(figures: &[Figure]) -> usize {
    figures.iter().for_each(|figure| println!("{}", figure.line()));
    let _ = std::io::stdout().flush();
    figures.iter().filter(|figure| figure.is_short()).count()
}

/// All programs of a deck in turn, as often as the deck says; gives the BLAS in use.
fn measure(case: &Case, runs: &mut Runs, peers: &Peers) -> Result<String, String> {
    let programs = case.programs();
    if programs.iter().any(|program| program.reads_files()) {
        peers.write(case)?;
    }
    let mut blas = String::new();
    for round in 1..=case.rounds {
        for &program in programs.iter().filter(|program| round == 1 || !program.is_run_once()) {
            let text = runs.run(case.name, program, round, peers)?;
            if matches!(program, Program::Cholmod(_)) {
                blas = text;
            }
        }
    }
    agree(case, runs)?;
    Ok(blas)
}

/// Every run of the same bodies gives the same bits, and the energy of other bodies and of the peers that found a solution
/// is the same as far as they are exact.
fn agree(case: &Case, runs: &Runs) -> Result<(), String> {
    const ENERGY: f64 = 1e-4;
    const ENERGY_OF_PIECES: f64 = 1e-9;
    let of = |program: Program, quantity: &str| runs.values(case.name, program, quantity);
    let whole = [Program::Ours(1), Program::Ours(2)];
    let cut = [Program::Cut(1), Program::Cut(2), Program::Later];
    for programs in [&whole[..], &cut] {
        let bits: Vec<f64> = programs.iter().flat_map(|&program| of(program, "bits")).collect();
        if bits.iter().any(|sum| *sum != bits[0]) {
            return Err("1 and 2 threads give different bits".into());
        }
    }
    let Some(ours) = whole.iter().flat_map(|&program| of(program, "energy")).next() else { return Ok(()) };
    let others = [Program::Clarabel, Program::Osqp].map(|peer| (peer, ENERGY)).into_iter();
    let pieces = case.programs().into_iter().filter(|program| program.is_by_elements());
    for (program, limit) in others.chain(pieces.map(|program| (program, ENERGY_OF_PIECES))) {
        let found = |k: usize| of(program, "solved").get(k).is_none_or(|solved| *solved == 1.0);
        for (_, energy) in of(program, "energy").into_iter().enumerate().filter(|(k, _)| found(*k)) {
            if (energy - ours).abs() > limit * energy.abs() {
                return Err(format!("energy {ours:e}, that of {} {energy:e}", program.name()));
            }
        }
    }
    Ok(())
}
