//! Files that the library opens: what it refuses, and how it says so.

use std::fs;
use std::io;
use std::path::Path;

use crate::error::{Error, Kind, Result};

/// Refuses a path to a device, a pipe or a folder: to open it might wait for ever, to write to it end the process by a signal.
/// A file that does not exist is accepted.
pub fn regular(path: &Path) -> Result<()> {
    match fs::metadata(path) {
        Ok(found) if !found.is_file() => {
            Err(Error::new(Kind::Io, format!("{}: open: this is not a regular file", path.display())))
        }
        _ => Ok(()),
    }
}

pub fn failed(path: &Path, operation: &str, error: &io::Error) -> Error {
    Error::new(Kind::Io, format!("{}: {operation}: {error}", path.display()))
}
