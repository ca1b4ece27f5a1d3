//! What [`super::pools`] is made of; `tests/loom` puts loom's in its place.

pub(super) use crate::platform::fork::instant;
pub use std::sync::{Arc, Mutex, PoisonError};
