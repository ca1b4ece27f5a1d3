//! What [`super::pools`] is made of; `tests/loom` puts loom's in its place.

pub use std::sync::{Arc, Mutex, PoisonError};
