//! `feti-contact`: solves, checks, shows and converts problem files. The man page, `feti-contact.1`, says what for.

mod check;
mod command;
mod contents;
mod convert;
mod end;
mod folder;
mod given;
mod json;
mod live;
mod show;
mod solve;
mod table;

use std::io::{self, Write};
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = match command::command().try_get_matches() {
        Ok(arguments) => arguments,
        Err(error) => {
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { end::USAGE } else { end::OK });
        }
    };
    let done = match arguments.subcommand() {
        Some(("solve", of)) => solve::solve(of),
        Some(("check", of)) => check::check(of),
        Some(("show", of)) => show::show(of),
        Some(("convert", of)) => convert::convert(of),
        _ => return ExitCode::from(end::USAGE),
    };
    match done {
        Ok(end) => ExitCode::from(end.told()),
        Err(text) => {
            let _ = writeln!(io::stderr(), "feti-contact: {text}");
            ExitCode::from(end::NONE)
        }
    }
}
