//! The problem that the arguments name.

use std::path::Path;

use clap::ArgMatches;
use feti_contact::solver::{options, OptionValue, Problem};

use crate::{command, folder};

/// From a problem file or a folder, with the options of the arguments.
pub fn problem(of: &ArgMatches) -> Result<Problem, String> {
    let path = Path::new(command::file(of));
    let mut problem = read(path)?;
    for (name, value) in command::options(of)? {
        set(&mut problem, &name, &value)?;
    }
    Ok(problem)
}

pub fn read(path: &Path) -> Result<Problem, String> {
    if path.is_dir() {
        return folder::read(path);
    }
    let mut problem = Problem::new();
    problem.offer_method(&paper::Paper);
    problem.read_file(path).map_err(|error| error.to_string())?;
    Ok(problem)
}

/// Texts may have blanks, which a line of options may not.
fn set(problem: &mut Problem, name: &str, value: &str) -> Result<(), String> {
    let known = options().iter().find(|option| option.name.to_bytes() == name.as_bytes());
    let is_text =
        known.is_some_and(|option| matches!(option.default, OptionValue::Str(_) | OptionValue::Text(_)));
    let done = match is_text {
        true => problem.set_str(name, value),
        false => problem.set_text(&format!("{name}={value}")),
    };
    done.map_err(|error| error.to_string())
}
