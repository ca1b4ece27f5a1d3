//! The registry of problems and the list of pools under loom: every test runs once for each order in which the steps of
//! its threads can come. What a problem or a pool is does not matter here: a number that only one thread may touch.
#![cfg(test)]
#![allow(dead_code)]

#[path = "../../../src/platform/pools.rs"]
mod pools;
#[path = "../../../c/src/boundary/registry.rs"]
mod registry;

mod sync {
    pub fn instant<T>(work: impl FnOnce() -> T) -> T {
        work()
    }
    pub use loom::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    pub use loom::sync::{Arc, Mutex, MutexGuard, RwLock};
    pub use std::sync::{PoisonError, TryLockError};
}

mod pool_tests;
mod registry_tests;
