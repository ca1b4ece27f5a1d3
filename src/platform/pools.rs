//! The existing pools of threads, by process and size, created when first needed. `tests/loom` tries all orders of its steps on two
//! threads.

use super::sync::{instant, Arc, Mutex, PoisonError};

/// Pools that are kept while nobody uses them: their threads wait, and hold their stacks and heaps.
const KEPT: usize = 4;

/// A forked child has none of its parent's threads and makes its own pools.
pub struct Pools<P> {
    /// The one that was asked for last is the last.
    pub made: Mutex<Vec<(u32, usize, Arc<P>)>>,
}

impl<P> Pools<P> {
    /// The pool of this size in this process, made if it is not there; None where it cannot be made. To start threads
    /// takes long: others have the list meanwhile, and of two pools that are made at the same time one ends unused.
    pub fn get(&self, process: u32, size: usize, make: impl FnOnce() -> Option<P>) -> Option<Arc<P>> {
        self.listed(process, size, None).or_else(|| self.listed(process, size, make().map(Arc::new)))
    }

    /// The pool that is there, or `new` in its place, comes last; those that are too many end.
    fn listed(&self, process: u32, size: usize, new: Option<Arc<P>>) -> Option<Arc<P>> {
        let mut ended = Vec::new();
        let pool = instant(|| {
            let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
            let there = made.iter().position(|(p, s, _)| *p == process && *s == size);
            let pool = there.map(|at| made.remove(at).2).or_else(|| new.clone())?;
            // What the parent made has no threads here that could be told to end.
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
        // To wake threads that are to end takes longer than the list may be held.
        drop(ended);
        pool
    }
}
