//! One contact solve in a process of its own, and a second one for new loads and gaps.

use decks::Deck;
use feti_contact::error::Result as Solver;
use feti_contact::solver::{Outcome, Problem, Report, RowKind};

use crate::clock::{peak, restart_peak, Clock, Lap};
use crate::hand_over;

/// Every entry of the certificate is as small as this; all other options but the threads have their defaults.
const CERTIFICATE: f64 = 1e-9;
/// Loads and gaps of the second step, against the first.
const SECOND_LOAD: f64 = 1.1;
const SECOND_GAP: f64 = 0.9;

/// Prints lines `name value`.
pub fn run(deck: Deck, threads: i64) -> Result<(), String> {
    let text = |error: feti_contact::error::Error| error.to_string();
    let taking = Clock::start();
    let mut problem = hand_over::problem(&deck).map_err(text)?;
    print_lap("hand_over", taking.lap());
    problem.set_f64("certificate_tolerance", CERTIFICATE).map_err(text)?;
    problem.set_i64("threads", threads).map_err(text)?;
    let gaps = deck.contact.rhs.clone();
    let loads: Vec<Vec<f64>> = deck.bodies.into_iter().map(|body| body.load).collect();
    drop(deck.contact);
    restart_peak();
    let report = timed("first", &mut problem)?;
    println!("peak {:.0}", peak());
    details(&problem, &report, loads.len()).map_err(text)?;
    next_step(&mut problem, &loads, &gaps).map_err(text)?;
    let second = timed("second", &mut problem)?;
    println!("second_products {}", second.counts.products);
    println!("second_factorisations {}", second.work.factorisations - report.work.factorisations);
    Ok(())
}

/// Solves and prints times, also those of the phases.
fn timed(name: &str, problem: &mut Problem) -> Result<Report, String> {
    let clock = Clock::start();
    let report = problem.solve().map_err(|error| error.to_string())?;
    print_lap(name, clock.lap());
    for phase in &report.phases {
        println!("{name}_{}_wall {:.6}", phase.name.to_string_lossy().replace(' ', "_"), phase.seconds);
    }
    if report.outcome != Outcome::Solved || !report.certificate.passed() {
        return Err(format!(
            "{:?}, certificate {:.1e} of its limit",
            report.outcome,
            report.certificate.worst()
        ));
    }
    Ok(report)
}

fn print_lap(name: &str, lap: Lap) {
    println!("{name}_wall {:.6}\n{name}_cpu {:.6}", lap.wall, lap.cpu);
}

fn details(problem: &Problem, report: &Report, bodies: usize) -> Solver<()> {
    println!("bodies {}", report.sizes.bodies);
    println!("dofs {}", report.sizes.dofs);
    println!("rows {}", report.sizes.rows);
    println!("equalities {}", report.sizes.equalities);
    println!("closed {}", report.active);
    println!("products {}", report.counts.products);
    println!("implicit {}", report.implicit_operators);
    println!("factor_bytes {}", report.factor_bytes);
    println!("operator_bytes {}", report.operator_bytes);
    println!("worst {:.3e}", report.certificate.worst());
    println!("energy {:.15e}", report.energy);
    let mut sum = 0xcbf2_9ce4_8422_2325_u64;
    for p in 0..bodies {
        for u in problem.displacement(p)? {
            sum = (sum ^ u.to_bits()).wrapping_mul(0x0100_0000_01b3).rotate_left(23);
        }
    }
    // A whole number that a double holds: equal for equal bits of u.
    println!("bits {}", sum >> 12);
    Ok(())
}

fn next_step(problem: &mut Problem, loads: &[Vec<f64>], gaps: &[f64]) -> Solver<()> {
    for (p, load) in loads.iter().enumerate() {
        let load: Vec<f64> = load.iter().map(|f| SECOND_LOAD * f).collect();
        problem.set_load(p, &load)?;
    }
    let gaps: Vec<f64> = gaps.iter().map(|c| SECOND_GAP * c).collect();
    problem.set_rhs(RowKind::Inequality, 0, &gaps)
}
