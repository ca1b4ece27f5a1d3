//! The programs, each run in a process of its own.

use std::process::Command;

/// What is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Program {
    /// The contact solve on so many threads.
    Ours(usize),
    /// The same with option steps=1: factors in single precision where they suffice.
    Few(usize),
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
    /// A host's own loop of penalty and active set around CHOLMOD, on one thread, to an accuracy of 10^-k.
    HostLoop(usize),
    /// The parts of the setup.
    Parts,
    /// The numeric factorisation of one K on so many threads.
    Factor(usize),
    /// The same by faer, in the same order of elimination.
    Faer(usize),
    /// Bytes per second of an explicit product.
    Bandwidth,
    /// A find between two surfaces on so many threads.
    Surfaces(usize),
    Clarabel,
    Osqp,
}

impl Program {
    pub fn name(self) -> String {
        match self {
            Program::Ours(threads) => format!("ours_{threads}"),
            Program::Few(threads) => format!("few_{threads}"),
            Program::Frictionless => "frictionless".into(),
            Program::Cut(threads) => format!("cut_{threads}"),
            Program::Pieces(pieces) => format!("pieces_{pieces}"),
            Program::Later => "later".into(),
            Program::Cholmod(threads) => format!("cholmod_{threads}"),
            Program::HostLoop(digits) => format!("host_loop_{digits}"),
            Program::Parts => "parts".into(),
            Program::Factor(threads) => format!("factor_{threads}"),
            Program::Faer(threads) => format!("faer_{threads}"),
            Program::Bandwidth => "bandwidth".into(),
            Program::Surfaces(threads) => format!("surfaces_{threads}"),
            Program::Clarabel => "clarabel".into(),
            Program::Osqp => "osqp".into(),
        }
    }

    /// What `Peers::write` writes for a deck.
    pub fn reads_files(self) -> bool {
        use Program::{Cholmod, Clarabel, Faer, HostLoop, Osqp};
        matches!(self, Cholmod(_) | HostLoop(_) | Faer(_) | Clarabel | Osqp)
    }

    /// Bodies come by their elements.
    pub fn is_by_elements(self) -> bool {
        matches!(self, Program::Cut(_) | Program::Pieces(_) | Program::Later)
    }

    /// Of counts and of times that are compared with others of the same run: no round but the first.
    pub fn is_run_once(self) -> bool {
        self == Program::Later
    }

    pub fn threads(self) -> usize {
        match self {
            Program::Ours(threads) | Program::Cut(threads) | Program::Cholmod(threads) => threads,
            Program::Few(threads) => threads,
            Program::Pieces(_) => 2,
            Program::Factor(threads) | Program::Faer(threads) | Program::Surfaces(threads) => threads,
            _ => 1,
        }
    }
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
