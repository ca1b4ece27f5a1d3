//! The thread pools, by process and size, created when first needed. `tests/loom` tries all orders of its steps on two
//! threads.

use super::sync::{instant, Arc, Mutex, PoisonError};

/// Number of pools kept while they are not used: their threads wait and occupy stacks and heaps.
const KEPT: usize = 4;

/// A forked child has none of its parent's threads and makes its own pools.
pub struct Pools<P> {
    /// The pool requested last is at the end.
    pub made: Mutex<Vec<(u32, usize, Arc<P>)>>,
}

impl<P> Pools<P> {
    /// The pool of this size in this process, created if necessary; None if that fails. Starting threads takes long, so
    /// the list is not locked meanwhile; if two threads create the same pool, one of the two is dropped.
    pub fn get(&self, process: u32, size: usize, make: impl FnOnce() -> Option<P>) -> Option<Arc<P>> {
        self.listed(process, size, None).or_else(|| self.listed(process, size, make().map(Arc::new)))
    }

    /// Moves the existing pool, or `new` in its place, to the end; removes pools above the limit.
    fn listed(&self, process: u32, size: usize, new: Option<Arc<P>>) -> Option<Arc<P>> {
        let mut ended = Vec::new();
        let pool = instant(|| {
            let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
            let there = made.iter().position(|(p, s, _)| *p == process && *s == size);
            let pool = there.map(|at| made.remove(at).2).or_else(|| new.clone())?;
            // pools made by the parent process have no threads here that could be ended
            let mut over = (made.iter().filter(|(p, ..)| *p == process).count() + 1).saturating_sub(KEPT);
            made.retain(|(p, _, idle)| {
                let ends = over > 0 && *p == process && Arc::strong_count(idle) == 1;
                if ends {
                    over -= 1;
                    ended.push(Arc::clone(idle));
                }
                !ends
            });
            made.push((process, size, Arc::clone(&pool)));
            Some(pool)
        });
        // waking threads to end them takes too long to hold the lock
        drop(ended);
        pool
    }
}
