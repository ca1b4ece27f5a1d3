//! Pools of threads that are there, by process and size: each is made once. All orders of its steps on two threads are
//! tried in `tests/loom`.

use super::sync::{Arc, Mutex, PoisonError};

/// A forked child has none of its parent's threads and makes its own pools.
pub struct Pools<P> {
    pub made: Mutex<Vec<(u32, usize, Arc<P>)>>,
}

impl<P> Pools<P> {
    /// The pool of this size in this process, made if it is not there; None where it cannot be made.
    pub fn get(&self, process: u32, size: usize, make: impl FnOnce() -> Option<P>) -> Option<Arc<P>> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, _, pool)) = made.iter().find(|(p, s, _)| *p == process && *s == size) {
            return Some(Arc::clone(pool));
        }
        let pool = Arc::new(make()?);
        made.push((process, size, Arc::clone(&pool)));
        Some(pool)
    }
}
