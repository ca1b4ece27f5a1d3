//! Runs of the programs, each in a process of its own, and the figures they print.

use std::fs::{create_dir_all, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::peers::Peers;

/// What is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Program {
    /// The contact solve on so many threads.
    Ours(usize),
    /// That of the same deck without friction, on one thread.
    Frictionless,
    /// The same of bodies that are handed over by their elements, and cut as the library chooses.
    Cut(usize),
    /// The same on two threads, each body cut into about so many pieces.
    Pieces(usize),
    /// Load steps of bodies by their elements on one thread, and a linear solve.
    Later,
    /// CHOLMOD's analysis and factorisation on so many threads.
    Cholmod(usize),
    /// The parts of the setup.
    Parts,
    /// The numeric factorisation of one K on so many threads.
    Factor(usize),
    /// The same by faer, in the same order of elimination.
    Faer(usize),
    /// Bytes per second of an explicit product.
    Bandwidth,
    Clarabel,
    Osqp,
}

impl Program {
    pub fn name(self) -> String {
        match self {
            Program::Ours(threads) => format!("ours_{threads}"),
            Program::Frictionless => "frictionless".into(),
            Program::Cut(threads) => format!("cut_{threads}"),
            Program::Pieces(pieces) => format!("pieces_{pieces}"),
            Program::Later => "later".into(),
            Program::Cholmod(threads) => format!("cholmod_{threads}"),
            Program::Parts => "parts".into(),
            Program::Factor(threads) => format!("factor_{threads}"),
            Program::Faer(threads) => format!("faer_{threads}"),
            Program::Bandwidth => "bandwidth".into(),
            Program::Clarabel => "clarabel".into(),
            Program::Osqp => "osqp".into(),
        }
    }

    /// What `Peers::write` writes for a deck.
    pub fn reads_files(self) -> bool {
        use Program::{Cholmod, Clarabel, Faer, Osqp};
        matches!(self, Cholmod(_) | Faer(_) | Clarabel | Osqp)
    }

    /// Bodies come by their elements.
    pub fn is_by_elements(self) -> bool {
        matches!(self, Program::Cut(_) | Program::Pieces(_) | Program::Later)
    }

    /// Of counts and of times that are compared with others of the same run: no round but the first.
    pub fn is_run_once(self) -> bool {
        self == Program::Later
    }

    fn threads(self) -> usize {
        match self {
            Program::Ours(threads) | Program::Cut(threads) | Program::Cholmod(threads) => threads,
            Program::Pieces(_) => 2,
            Program::Factor(threads) | Program::Faer(threads) => threads,
            _ => 1,
        }
    }
}

struct Sample {
    deck: &'static str,
    program: Program,
    quantity: String,
    value: f64,
}

/// All runs so far, kept in a file as they come.
pub struct Runs {
    samples: Vec<Sample>,
    csv: File,
    pub path: PathBuf,
}

impl Runs {
    /// A new file in `folder`, named by what is measured and the time.
    pub fn new(folder: &Path, kind: &str) -> Result<Self, String> {
        let text = |error: std::io::Error| format!("{}: {error}", folder.display());
        create_dir_all(folder).map_err(text)?;
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        let path = folder.join(format!("{kind}_{now}.csv"));
        let mut csv = File::create(&path).map_err(text)?;
        writeln!(csv, "deck,program,round,quantity,value").map_err(text)?;
        Ok(Self { samples: Vec::new(), csv, path })
    }

    /// Runs a program once. Gives what it printed beside figures.
    pub fn run(
        &mut self,
        deck: &'static str,
        program: Program,
        round: usize,
        peers: &Peers,
    ) -> Result<String, String> {
        let mut command = peers.command(deck, program)?;
        let threads = program.threads().to_string();
        for name in ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"] {
            command.env(name, &threads);
        }
        let text = output(&mut command).map_err(|why| format!("{deck} {}: {why}", program.name()))?;
        let mut rest = String::new();
        for line in text.lines() {
            match line.split_once(' ').map(|(name, value)| (name, value.parse::<f64>())) {
                Some((quantity, Ok(value))) => {
                    let name = program.name();
                    writeln!(self.csv, "{deck},{name},{round},{quantity},{value}")
                        .map_err(|e| e.to_string())?;
                    self.samples.push(Sample { deck, program, quantity: quantity.into(), value });
                }
                _ => rest.push_str(line),
            }
        }
        Ok(rest)
    }

    /// The values of a quantity, round by round.
    pub fn values(&self, deck: &str, program: Program, quantity: &str) -> Vec<f64> {
        let asked = |s: &&Sample| s.deck == deck && s.program == program && s.quantity == quantity;
        self.samples.iter().filter(asked).map(|sample| sample.value).collect()
    }

    pub fn median(&self, deck: &str, program: Program, quantity: &str) -> Option<f64> {
        median(self.values(deck, program, quantity))
    }

    /// Median over the rounds of one quantity over another of the same round.
    pub fn ratio(&self, deck: &str, over: (Program, &str), under: (Program, &str)) -> Option<f64> {
        let (over, under) = (self.values(deck, over.0, over.1), self.values(deck, under.0, under.1));
        median(over.iter().zip(&under).map(|(a, b)| a / b).collect())
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.len().checked_sub(1)? / 2, values.len() / 2);
    Some(0.5 * (values[low] + values[high]))
}

/// What a command prints; it must succeed.
pub fn output(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let text = String::from_utf8_lossy(&output.stderr);
    Err(format!("{}: {}", output.status, text.trim()))
}
