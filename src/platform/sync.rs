//! The synchronisation types of [`super::pools`]; `tests/loom` replaces them by loom's.

pub(super) use crate::platform::fork::instant;
pub use std::sync::{Arc, Mutex, PoisonError};
