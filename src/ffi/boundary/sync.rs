//! What [`super::registry`] is made of; `tests/loom` puts loom's in its place.

pub(super) use crate::platform::instant;
pub(super) use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
pub(super) use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, TryLockError};
