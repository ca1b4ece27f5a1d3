//! A whole contact solve against one analysis and factorisation of K by CHOLMOD, and against two solvers of quadratic
//! programs; and the factorisation of K alone against faer's. One line a figure,
//!
//! ```text
//! bench <deck> <figure> <value> goal <g> ok|short
//! ```
//!
//! with details below, and a closing line with the number short. Arguments: names of decks, none for all; `scaling` runs
//! series of decks and draws them instead. Every run is a process of its own; raw figures go to benches/runs. Exit code 1 when a run fails; a short figure alone leaves it 0.

mod clock;
#[path = "../../tests/support/compiler.rs"]
mod compiler;
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
mod runs;
mod scaling;

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use figures::Figure;
use peers::Peers;
use problems::{Case, Model, CASES, PEERS};
use runs::{Program, Runs};

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
    let build = || problems::case(deck).map(|case| case.model.build()).ok_or("no such deck");
    match kind {
        "ours" => ours::run(build()?, threads.parse().map_err(|_| "no number of threads")?),
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
                details(case, &runs, &blas);
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
    let ours = [Program::Ours(1), Program::Ours(2)];
    let programs = match case.model {
        Model::Blocks(_) => {
            peers.write(case)?;
            if case.name == PEERS {
                vec![ours[0], Program::Clarabel, Program::Osqp]
            } else {
                vec![ours[0], Program::Cholmod(1), ours[1], Program::Cholmod(2), Program::Parts]
            }
        }
        Model::OneBody(_) => ours.to_vec(),
        Model::Clamped(_) => {
            peers.write(case)?;
            vec![Program::Factor(1), Program::Faer(1), Program::Factor(2), Program::Faer(2)]
        }
        Model::Flat(..) | Model::Cube(_) | Model::Cut(_) => ours[..1].to_vec(),
    };
    let mut blas = String::new();
    for round in 1..=case.rounds {
        for &program in &programs {
            let text = runs.run(case.name, program, round, peers)?;
            if program == Program::Cholmod(2) {
                blas = text;
            }
        }
    }
    agree(case, runs)?;
    Ok(blas)
}

/// Every run of ours gives the same bits, and the energy of the peers that found a solution is that of ours.
fn agree(case: &Case, runs: &Runs) -> Result<(), String> {
    const ENERGY: f64 = 1e-4;
    let of = |program: Program, quantity: &str| runs.values(case.name, program, quantity);
    let ours = |quantity: &str| [1, 2].map(|threads| of(Program::Ours(threads), quantity)).concat();
    let (bits, energies) = (ours("bits"), ours("energy"));
    if bits.iter().any(|sum| *sum != bits[0]) {
        return Err("1 and 2 threads give different bits".into());
    }
    for peer in [Program::Clarabel, Program::Osqp] {
        let solved =
            of(peer, "solved").into_iter().zip(of(peer, "energy")).filter(|(solved, _)| *solved == 1.0);
        for (_, energy) in solved {
            if (energy - energies[0]).abs() > ENERGY * energy.abs() {
                return Err(format!("energy {:e}, that of {} {energy:e}", energies[0], peer.name()));
            }
        }
    }
    Ok(())
}

/// Medians in seconds, and what was solved.
fn details(case: &Case, runs: &Runs, blas: &str) {
    let median = |program, quantity: &str| runs.median(case.name, program, quantity);
    let ours = Program::Ours(1);
    let text: Vec<String> = ["dofs", "rows", "closed", "products", "implicit", "second_products", "entries"]
        .iter()
        .filter_map(|quantity| {
            let count = median(ours, quantity).or_else(|| median(Program::Factor(1), quantity))?;
            Some(format!("{quantity} {count}"))
        })
        .collect();
    println!("    {}, {} rounds", text.join(", "), case.rounds);
    let times = [
        (ours, "first_cpu"),
        (ours, "first_analysis_wall"),
        (ours, "first_factorisation_wall"),
        (ours, "first_dual_operators_wall"),
        (ours, "first_dual_solve_wall"),
        (ours, "second_cpu"),
        (Program::Parts, "ordering_cpu"),
        (Program::Parts, "analysis_cpu"),
        (Program::Parts, "plan_cpu"),
        (Program::Parts, "execute_cpu"),
        (Program::Parts, "factorisation_cpu"),
        (Program::Parts, "dual_operator_cpu"),
        (Program::Cholmod(1), "analyse_cpu"),
        (Program::Cholmod(1), "factorise_cpu"),
        (Program::Factor(1), "cpu"),
        (Program::Faer(1), "cpu"),
        (Program::Factor(2), "wall"),
        (Program::Faer(2), "wall"),
        (Program::Clarabel, "cpu"),
        (Program::Osqp, "cpu"),
    ];
    for peer in [Program::Clarabel, Program::Osqp] {
        if median(peer, "solved") == Some(0.0) {
            println!("    {} found no solution in its time: its ratio is a lower bound", peer.name());
        }
    }
    for (program, quantity) in times {
        if let Some(seconds) = median(program, quantity) {
            println!("    {} {quantity} {seconds:.3} s", program.name());
        }
    }
    if !blas.is_empty() {
        println!("    {blas}");
    }
}
