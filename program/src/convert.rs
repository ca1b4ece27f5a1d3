//! `convert`: a problem file of a folder, or a folder of a problem file.

use std::path::Path;

use clap::ArgMatches;

use crate::contents::Contents;
use crate::end::{self, End};
use crate::{command, folder, given};

pub fn convert(of: &ArgMatches) -> Result<End, String> {
    let (from, to) = (Path::new(command::file(of)), Path::new(command::one(of, "TO").unwrap_or_default()));
    let mut problem = given::read(from)?;
    let text = match from.is_dir() {
        true => {
            problem.write_file(to).map_err(|error| error.to_string())?;
            String::new()
        }
        false => {
            let contents = Contents::of(&problem)?;
            folder::write(&contents, to)?;
            match contents.left_out() {
                left if left.is_empty() => String::new(),
                left => format!("the folder has no place for: {left}\n"),
            }
        }
    };
    Ok(End { text, status: end::OK })
}
