//! How a command ends: what it prints, its exit status, and what to do.

use std::io::{self, Write};

use feti_contact::error::Kind;
use feti_contact::solver::Outcome;

/// The library's status is 0; or nothing suspicious was found.
pub const OK: u8 = 0;
/// Above 0, an incomplete answer; or the certificate does not pass; or something is suspicious.
pub const INCOMPLETE: u8 = 1;
/// Below 0, no answer; or a file that cannot be read or written.
pub const NONE: u8 = 2;
/// Arguments that the program does not have (EX_USAGE).
pub const USAGE: u8 = 64;

/// What goes to standard output at the end of a command.
pub struct End {
    pub text: String,
    pub status: u8,
}

impl End {
    /// Prints the text. A reader that does not want all of it, as `head`, is no failure.
    pub fn told(self) -> u8 {
        let _ = io::stdout().lock().write_all(self.text.as_bytes());
        self.status
    }
}

/// Name of the status, class and cure of a solve's end.
pub fn of(end: &Result<Outcome, Kind>) -> (&'static str, u8, &'static str) {
    match end {
        Ok(outcome) => {
            let class = if *outcome == Outcome::Solved { OK } else { INCOMPLETE };
            (outcome.status(), class, outcome.cure())
        }
        Err(kind) => (kind.status(), NONE, kind.cure()),
    }
}
