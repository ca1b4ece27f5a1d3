//! Time and memory of a whole contact solve against unknowns, contact rows, bodies and threads. One line a value,
//!
//! ```text
//! scaling <sweep> <deck> <quantity> <value>
//! ```
//!
//! and two pictures a sweep in docs/pictures. Arguments: names of sweeps, none for all; a number leaves out the decks of
//! more unknowns. Exit code 1 when a run fails.

use std::io::Write;
use std::path::Path;

use crate::figures;
use crate::peers::Peers;
use crate::pictures;
use crate::problems::{self, Case, Model};
use crate::programs::Program;
use crate::runs::Runs;
use crate::sweeps::{Sweep, CUT, MEGABYTE, OURS, SWEEPS, THREADS, UNIT};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");
/// Unknowns beyond which a deck is run once.
const LARGE: usize = 50_000;
pub fn run(words: &[&str]) -> Result<(), String> {
    let (numbers, names): (Vec<&str>, Vec<&str>) =
        words.iter().copied().partition(|word| word.parse::<usize>().is_ok());
    if let Some(name) = names.iter().find(|name| SWEEPS.iter().all(|sweep| sweep.name != **name)) {
        return Err(format!("no sweep {name}"));
    }
    let most = numbers.iter().filter_map(|word| word.parse().ok()).min().unwrap_or(usize::MAX);
    let peers = Peers::set_up(false)?;
    let mut runs = Runs::new(&Path::new(ROOT).join("benches/runs"), "scaling")?;
    let mut failed = 0;
    for sweep in SWEEPS.iter().filter(|sweep| names.is_empty() || names.contains(&sweep.name)) {
        let cases = sweep.decks.iter().filter_map(|name| problems::case(name));
        for case in cases.filter(|case| case.model.unknowns() <= most) {
            if let Err(why) = sweep.measure(case, &mut runs, &peers) {
                failed += 1;
                println!("scaling {} {} failed: {why}", sweep.name, case.name);
            }
            peers.remove(case);
        }
        for path in pictures::write(sweep, &runs, &Path::new(ROOT).join("docs/pictures"))? {
            println!("picture {path}");
        }
    }
    figures::of_growth(&runs).iter().for_each(|figure| println!("{}", figure.line()));
    println!("scaling: {failed} failed; raw figures in {}", runs.path.display());
    if failed > 0 {
        return Err(format!("{failed} decks failed"));
    }
    Ok(())
}

impl Sweep {
    /// Runs the programs of one deck in turn, unless the sweep before has done so, and prints what they found.
    fn measure(&self, case: &'static Case, runs: &mut Runs, peers: &Peers) -> Result<(), String> {
        let programs = self.programs();
        let rounds = if case.model.unknowns() > LARGE { 1 } else { 3 };
        if programs.iter().any(|&program| runs.values(case.name, program, "peak").is_empty()) {
            if programs.contains(&UNIT) {
                peers.write(case)?;
            }
            for round in 1..=rounds {
                for &program in &programs {
                    runs.run(case.name, program, round, peers)?;
                }
            }
        }
        same_bits(case, &programs, runs)?;
        self.same_energy(case, runs)?;
        self.print(case, &programs, runs);
        Ok(())
    }

    fn print(&self, case: &Case, programs: &[Program], runs: &Runs) {
        let line = |quantity: &str, value: Option<String>| {
            if let Some(value) = value {
                println!("scaling {} {} {quantity} {value}", self.name, case.name);
            }
        };
        let three = |value: Option<f64>| value.map(|value| format!("{value:.3}"));
        let median = |program: Program, quantity: &str| runs.median(case.name, program, quantity);
        for quantity in ["bodies", "pieces", "dofs", "rows", "equalities", "closed", "products"] {
            line(quantity, median(programs[0], quantity).map(|count| count.to_string()));
        }
        for &program in programs {
            let clock = if matches!(self.name, THREADS | CUT) { "wall" } else { "cpu" };
            let time = if program == UNIT { clock.to_string() } else { format!("first_{clock}") };
            let peak = median(program, "peak").map(|bytes| bytes / MEGABYTE);
            line(&format!("{},{clock}_s", program.name()), three(median(program, &time)));
            line(&format!("{},peak_MB", program.name()), three(peak));
        }
        // Lines appear as they are found, also in a pipe.
        let _ = std::io::stdout().flush();
    }

    /// A cube has the same energy whatever the bodies it is cut into: of lengths times s, s^3 times as much.
    fn same_energy(&self, case: &Case, runs: &Runs) -> Result<(), String> {
        const ENERGY: f64 = 1e-6;
        let of = |name: &str| {
            let Model::Cut(side) = problems::case(name)?.model else { return None };
            Some(runs.median(name, OURS, "energy")? / (side as f64).powi(3))
        };
        let (first, own) = (self.decks.iter().find_map(|name| of(name)), of(case.name));
        match first.zip(own) {
            Some((first, own)) if (first - own).abs() > ENERGY * first.abs() => {
                Err(format!("energy {own:e} of the cube of edge 1, before it was cut otherwise {first:e}"))
            }
            _ => Ok(()),
        }
    }
}

/// Every run of ours gives the same bits, on any number of threads.
fn same_bits(case: &Case, programs: &[Program], runs: &Runs) -> Result<(), String> {
    let bits: Vec<f64> =
        programs.iter().flat_map(|&program| runs.values(case.name, program, "bits")).collect();
    if bits.iter().any(|sum| *sum != bits[0]) {
        return Err("different bits on other numbers of threads, or when run again".into());
    }
    Ok(())
}
