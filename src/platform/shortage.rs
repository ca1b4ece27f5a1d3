//! A malloc that has failed ends the calls of a C host at their next check with `Kind::Memory`; until then memory comes from
//! the reserve of the C interface. A program in Rust keeps its own allocator: there nothing is ever short.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A malloc has failed since the first of the running calls began.
static SHORT: AtomicBool = AtomicBool::new(false);
/// Calls of the host that run now, on all threads.
static CALLS: AtomicUsize = AtomicUsize::new(0);

/// True if a malloc has failed: the call has to end.
pub fn is_short() -> bool {
    SHORT.load(Ordering::Relaxed)
}

/// Called where a malloc fails.
pub fn begin() {
    SHORT.store(true, Ordering::Relaxed);
}

/// A call of the host, until dropped. When none runs any more, the next one tries the allocator again.
pub struct RunningCall(());

impl RunningCall {
    pub fn begin() -> Self {
        CALLS.fetch_add(1, Ordering::Relaxed);
        Self(())
    }
}

impl Drop for RunningCall {
    fn drop(&mut self) {
        if CALLS.fetch_sub(1, Ordering::Relaxed) == 1 {
            SHORT.store(false, Ordering::Relaxed);
        }
    }
}
