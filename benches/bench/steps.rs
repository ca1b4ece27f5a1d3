//! A problem that has been handed over, solved load step by load step.

use decks::Deck;
use feti_contact::error::Result as Solver;
use feti_contact::solver::{Outcome, Problem, Report, RowKind};

use crate::backing::back_memory;
use crate::clock::{peak, restart_peak, Clock, Lap};

/// Every entry of the certificate is as small as this; all other options but the threads have their defaults.
const CERTIFICATE: f64 = 1e-9;
/// Loads and gaps of a step, against those of the step before.
const NEXT_LOAD: f64 = 1.1;
const NEXT_GAP: f64 = 0.9;

pub struct Steps {
    pub problem: Problem,
    loads: Vec<Vec<f64>>,
    gaps: Vec<f64>,
}

impl Steps {
    /// `deck` is what has been handed over; nothing of it stays but loads and gaps.
    pub fn new(mut problem: Problem, deck: Deck, threads: i64) -> Result<Self, String> {
        set_options(&mut problem, threads).map_err(text)?;
        let gaps = deck.contact.rhs;
        let loads = deck.bodies.into_iter().map(|body| body.load).collect();
        Ok(Self { problem, loads, gaps })
    }

    /// Prints lines `name value`: times, peak of memory, what the report says. Gives the time as well.
    pub fn first(&mut self) -> Result<(Report, Lap), String> {
        back_memory(self.loads.iter().map(Vec::len).sum());
        restart_peak();
        let (report, lap) = timed("first", &mut self.problem)?;
        println!("peak {:.0}", peak());
        details(&self.problem, &report, self.loads.len()).map_err(text)?;
        Ok((report, lap))
    }

    /// The next step, likewise.
    pub fn next(&mut self, name: &str) -> Result<Report, String> {
        self.load().map_err(text)?;
        let (report, _) = timed(name, &mut self.problem)?;
        println!("{name}_products {}", report.counts.products);
        Ok(report)
    }

    fn load(&mut self) -> Solver<()> {
        self.loads.iter_mut().flatten().for_each(|f| *f *= NEXT_LOAD);
        self.gaps.iter_mut().for_each(|c| *c *= NEXT_GAP);
        for (p, load) in self.loads.iter().enumerate() {
            self.problem.set_load(p, load)?;
        }
        self.problem.set_rhs(RowKind::Inequality, 0, &self.gaps)
    }
}

pub fn set_options(problem: &mut Problem, threads: i64) -> Solver<()> {
    problem.set_f64("certificate_tolerance", CERTIFICATE)?;
    problem.set_i64("threads", threads)
}

pub fn text(error: feti_contact::error::Error) -> String {
    error.to_string()
}

/// Solves and prints times, also those of the phases. The certificate must pass.
pub fn timed(name: &str, problem: &mut Problem) -> Result<(Report, Lap), String> {
    let clock = Clock::start();
    let report = problem.solve().map_err(text)?;
    let lap = clock.lap();
    print_lap(name, lap);
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
    Ok((report, lap))
}

pub fn print_lap(name: &str, lap: Lap) {
    println!("{name}_wall {:.6}\n{name}_cpu {:.6}", lap.wall, lap.cpu);
}

fn details(problem: &Problem, report: &Report, bodies: usize) -> Solver<()> {
    let facts = (0..bodies).map(|p| problem.body_facts(p)).collect::<Solver<Vec<_>>>()?;
    println!("bodies {}", report.sizes.bodies);
    println!("pieces {}", facts.iter().map(|body| body.pieces).sum::<usize>());
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
