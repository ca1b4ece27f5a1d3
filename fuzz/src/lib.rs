//! The targets of the fuzzer: each reads decisions from bytes, drives the C ABI by them, and panics where the library
//! breaks its word. Called by libFuzzer (`targets/`) and by the short run of `make test` (`tests/c/fuzz.rs`).
//!
//! | file | holds |
//! |---|---|
//! | `bytes` | bytes as decisions |
//! | `buffers` | arrays for results that show whether they were written |
//! | `models` | stiffness matrices of small bodies |
//! | `host` | a host that spoils arguments, and what it checks after every call |
//! | `listeners` | what its functions for progress and log keep |
//! | `scenes` | whole problems that have a solution |
//! | `give`, `ask` | the calls that change a problem, and those that read it |
//! | `stiffness`, `forms` | matrices in every form, copied or lent, their new values, functions of the host |
//! | `friction` | nodes with friction |
//! | `whole` | calls over all bodies, numbers of the host, facts, log, options by one text |
//! | `calls` | the target: a sequence of them |
//! | `text` | the target: options by name and by text |
//! | `file` | the target: problem files |

pub mod ask;
pub mod buffers;
pub mod bytes;
pub mod calls;
pub mod file;
pub mod forms;
pub mod friction;
pub mod give;
pub mod host;
pub mod listeners;
pub mod models;
pub mod scenes;
pub mod stiffness;
pub mod text;
pub mod whole;
