//! The synchronisation types of [`super::registry`]; `tests/loom` replaces them by loom's.

pub(super) use feti_contact::platform::instant;
pub(super) use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
pub(super) use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, TryLockError};
