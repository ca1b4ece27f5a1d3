//! The C interface. No mathematics: every function converts its arguments once, calls [`crate::solver`], and writes back.
//!
//! | file | holds |
//! |---|---|
//! | `types`, `constants`, `status` | structs, constants and status numbers of the header |
//! | `handle`, `registry`, `sync` | the registry: handles are counters, never addresses, never reused |
//! | `call` | which exported function was called, and the names of its arguments |
//! | `guard` | what surrounds every call: registry, busy, `catch_unwind`, error records |
//! | `fpu` | the floating-point environment of the host, saved and restored |
//! | `error_store` | the last error, per thread and per problem |
//! | `arrays`, `indices`, `record` | host arrays, index arrays and structs with a `struct_size`, checked |
//! | `problem`, `file`, `options`, `body`, `body_info`, `stiffness`, `values`, `numbering`, `null_space`, `operator`, `rows`, `solve`, `phases`, `progress`, `log`, `state`, `diagnosis`, `results`, `validation` | the functions |
//!
//! The generator of the header and of the Fortran interfaces reads these files: each exported function has a table of
//! its arguments, in which the word NULL in the rule says that the pointer may be NULL.
#![deny(unsafe_op_in_unsafe_fn)]
#![warn(clippy::undocumented_unsafe_blocks)]
#![allow(clippy::too_many_arguments)]

mod arrays;
mod body;
mod body_info;
mod call;
mod constants;
mod diagnosis;
mod error_store;
mod file;
mod fpu;
mod guard;
mod handle;
mod indices;
mod log;
mod null_space;
mod numbering;
mod operator;
mod options;
mod phases;
mod problem;
mod progress;
mod record;
mod registry;
mod results;
mod rows;
mod solve;
mod state;
mod status;
mod stiffness;
mod sync;
mod types;
mod validation;
mod values;

#[cfg(test)]
mod error_tests;
#[cfg(test)]
mod panic_tests;
#[cfg(test)]
mod tests;

pub use body::*;
pub use body_info::*;
pub use diagnosis::*;
pub use error_store::{feti_last_error, feti_last_error_detail};
pub use file::*;
pub use log::*;
pub use null_space::*;
pub use numbering::*;
pub use operator::*;
pub use options::*;
pub use phases::*;
pub use problem::*;
pub use progress::*;
pub use results::*;
pub use rows::*;
pub use solve::*;
pub use state::*;
pub use status::*;
pub use stiffness::*;
pub use types::*;
pub use validation::*;
pub use values::*;
