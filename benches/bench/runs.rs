//! Runs of the programs, each in a process of its own, and the figures they print.

use std::fs::{create_dir_all, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use crate::peers::Peers;
use crate::programs::{output, Program};

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
        if let Some(core) = kernels() {
            command.env("OPENBLAS_CORETYPE", core);
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

/// The kernels of OpenBLAS for this processor: older versions do not know newer ones, and take those of 2004 for them.
fn kernels() -> Option<&'static str> {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
            return Some("SKYLAKEX");
        }
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            return Some("HASWELL");
        }
    }
    None
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.len().checked_sub(1)? / 2, values.len() / 2);
    Some(0.5 * (values[low] + values[high]))
}
