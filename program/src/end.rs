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

/// Name of the status and class of a solve's end.
pub fn of(end: &Result<Outcome, Kind>) -> (&'static str, u8) {
    match end {
        Ok(Outcome::Solved) => (Outcome::Solved.status(), OK),
        Ok(outcome) => (outcome.status(), INCOMPLETE),
        Err(kind) => (kind.status(), NONE),
    }
}

/// What to do after a solve without a complete answer.
pub fn cure(name: &str) -> &'static str {
    match name {
        "FETI_INACCURATE" | "FETI_STALLED" => "K is nearly singular, or its numbers have few digits: the worst place is in the certificate",
        "FETI_ITERATIONS" => "raise the option max_steps",
        "FETI_TIME" => "raise the option time_limit",
        "FETI_MARGINAL" => "a small part of the load is held by no row, or a body slides along rows that hardly resist it: see the notes",
        "FETI_LOAD_NOT_HELD" => "a support or a pair of bodies is missing, or normals point the wrong way",
        "FETI_SLIDES" => "friction holds only a part of the load: support the body, or check the coefficients",
        "FETI_GAPS_CONTRADICT" => "no displacement satisfies these rows: correct their gaps or signs, or make them compliant",
        "FETI_INDEFINITE" => "K has a negative stiffness: check the elements at this place, or declare soft motions",
        "FETI_NULL_SPACE" => "the declared motions are not those of K: correct them, give coordinates, or leave the search to the library",
        "FETI_MEMORY" => "set the option memory_limit, or dual_operator=implicit",
        _ => "the text of the error says what is wrong",
    }
}
