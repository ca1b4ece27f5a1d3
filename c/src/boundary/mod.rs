//! Handles, guards and argument checks around the exported functions.
//!
//! | file | holds |
//! |---|---|
//! | `handle`, `registry`, `sync` | the registry: handles are counters, never addresses, never reused |
//! | `call` | which exported function was called, and the names of its arguments |
//! | `guard` | frame of every call: registry, busy, `catch_unwind`, error records |
//! | `fpu` | the floating-point environment of the host, saved and restored |
//! | `error_store` | the last error, per thread and per problem |
//! | `arrays`, `indices`, `record` | host arrays, index arrays and structs with a `struct_size`, checked |

mod arrays;
mod call;
mod error_store;
pub mod fpu;
mod guard;
pub mod handle;
mod indices;
mod record;
mod registry;
mod sync;

pub use arrays::*;
pub(crate) use call::{call, twins, Call};
pub use error_store::{feti_last_error, feti_last_error_detail};
pub use guard::*;
pub use indices::*;
pub use record::*;
