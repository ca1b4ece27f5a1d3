//! Pools of threads that are there, by process and size: made when first needed. All orders of its steps on two threads
//! are tried in `tests/loom`.

use super::sync::{Arc, Mutex, PoisonError};

/// Pools that are kept while nobody uses them: their threads wait, and hold their stacks and heaps.
const KEPT: usize = 4;

/// A forked child has none of its parent's threads and makes its own pools.
pub struct Pools<P> {
    /// The one that was asked for last is the last.
    pub made: Mutex<Vec<(u32, usize, Arc<P>)>>,
}

impl<P> Pools<P> {
    /// The pool of this size in this process, made if it is not there; None where it cannot be made.
    pub fn get(&self, process: u32, size: usize, make: impl FnOnce() -> Option<P>) -> Option<Arc<P>> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let pool = match made.iter().position(|(p, s, _)| *p == process && *s == size) {
            Some(at) => made.remove(at).2,
            None => Arc::new(make()?),
        };
        // What the parent made has no threads here that could be told to end.
        let mut over = (made.iter().filter(|(p, ..)| *p == process).count() + 1).saturating_sub(KEPT);
        made.retain(|(p, _, idle)| {
            let ends = over > 0 && *p == process && Arc::strong_count(idle) == 1;
            over -= usize::from(ends);
            !ends
        });
        made.push((process, size, Arc::clone(&pool)));
        Some(pool)
    }
}
