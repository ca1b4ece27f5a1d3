//! What [`super::pools`] is made of; `tests/loom` puts loom's in its place.

pub(super) use crate::solver::fork::instant;
pub use std::sync::{Arc, Mutex, PoisonError};
