//! The C interface. No mathematics: every function converts its arguments once, calls [`feti_contact::solver`], and writes back.
//!
//! | file | holds |
//! |---|---|
//! | `header/` | structs, constants and status numbers of the header |
//! | `boundary/` | frame of every call: handles, panics, errors, arrays of the host |
//! | `bodies/` | the functions of bodies |
//! | `reserve` | memory for calls during which a malloc of the host fails |
//! | `problem`, `file`, `options`, `rows`, `friction`, `surfaces`, `pairs`, `solve`, `phases`, `ranks`, `progress`, `log`, `state`, `diagnosis`, `results`, `validation` | the other functions |
//!
//! The generator of the header and of the Fortran interfaces reads these files: each exported function has a table of its
//! arguments; if a rule contains the word NULL, the pointer may be NULL.
#![deny(unsafe_op_in_unsafe_fn)]
#![warn(clippy::undocumented_unsafe_blocks)]
#![allow(clippy::too_many_arguments)]

mod bodies;
mod boundary;
mod diagnosis;
mod dof_table;
mod file;
mod friction;
mod header;
mod log;
mod options;
mod pairs;
mod phases;
mod problem;
mod progress;
mod ranks;
#[cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64")))]
mod reserve;
mod results;
mod rows;
mod solve;
mod state;
mod surfaces;
mod validation;

#[cfg(test)]
mod tests;

pub use bodies::*;
pub use boundary::{feti_last_error, feti_last_error_detail};
pub use diagnosis::*;
pub use dof_table::*;
pub use file::*;
pub use friction::*;
pub use header::status::*;
pub use header::types::*;
pub use log::*;
pub use options::*;
pub use pairs::*;
pub use phases::*;
pub use problem::*;
pub use progress::*;
pub use ranks::*;
pub use results::*;
pub use rows::*;
pub use solve::*;
pub use state::*;
pub use surfaces::*;
pub use validation::*;
