//! What stands below the figures of a deck.

use crate::problems::Case;
use crate::programs::Program;
use crate::runs::Runs;

/// What was solved.
const COUNTS: [&str; 8] =
    ["dofs", "pieces", "rows", "closed", "products", "implicit", "second_products", "entries"];

/// Medians in seconds.
const TIMES: [(Program, &str); 43] = [
    (Program::Cut(1), "hand_over_cpu"),
    (Program::Cut(1), "cut_cpu"),
    (Program::Cut(1), "first_cpu"),
    (Program::Cut(1), "first_factorisation_wall"),
    (Program::Cut(1), "first_dual_operators_wall"),
    (Program::Cut(1), "first_dual_solve_wall"),
    (Program::Cut(2), "first_wall"),
    (Program::Cut(2), "first_dual_solve_wall"),
    (Program::Later, "second_cpu"),
    (Program::Later, "third_cpu"),
    (Program::Pieces(216), "first_dual_solve_wall"),
    (Program::Pieces(729), "first_dual_solve_wall"),
    (Program::Ours(1), "first_cpu"),
    (Program::Ours(1), "first_analysis_wall"),
    (Program::Ours(1), "first_factorisation_wall"),
    (Program::Ours(1), "first_dual_operators_wall"),
    (Program::Ours(1), "first_dual_solve_wall"),
    (Program::Ours(1), "second_cpu"),
    (Program::Few(1), "first_cpu"),
    (Program::Few(1), "first_factorisation_wall"),
    (Program::Few(1), "first_dual_solve_wall"),
    (Program::Few(1), "second_cpu"),
    (Program::Frictionless, "first_cpu"),
    (Program::Frictionless, "first_dual_operators_wall"),
    (Program::Frictionless, "first_dual_solve_wall"),
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
    (Program::HostLoop(6), "cpu"),
    (Program::HostLoop(9), "cpu"),
    (Program::Clarabel, "cpu"),
    (Program::Osqp, "cpu"),
    (Program::Ours(2), "first_wall"),
    (Program::Cholmod(2), "wall"),
];

/// Medians, what was solved, and the BLAS of CHOLMOD.
pub fn print(case: &Case, runs: &Runs, blas: &str) {
    let median = |program, quantity: &str| runs.median(case.name, program, quantity);
    for program in [Program::Ours(1), Program::Cut(2), Program::Later, Program::Factor(1)] {
        let count = |quantity: &&str| Some(format!("{quantity} {}", median(program, quantity)?));
        let counts: Vec<String> = COUNTS.iter().filter_map(count).collect();
        if !counts.is_empty() {
            println!("    {}: {}", program.name(), counts.join(", "));
        }
    }
    println!("    {} rounds", case.rounds);
    for peer in [Program::HostLoop(6), Program::HostLoop(9), Program::Clarabel, Program::Osqp] {
        if median(peer, "solved") == Some(0.0) {
            println!("    {} found no solution in its time: its ratio is a lower bound", peer.name());
        }
    }
    for (program, quantity) in TIMES {
        if let Some(seconds) = median(program, quantity) {
            println!("    {} {quantity} {seconds:.3} s", program.name());
        }
    }
    if !blas.is_empty() {
        println!("    {blas}");
    }
}
