//! Problems by number, each with its lock, its cancellation flag and its last error; the registry does not depend on the
//! type of a problem. `tests/loom` tries all orders of its steps on two threads.

use std::collections::BTreeMap;

use super::sync::{
    instant, Arc, AtomicBool, AtomicUsize, Mutex, MutexGuard, Ordering, PoisonError, RwLock, TryLockError,
};

/// Numbers count from 1 and are never reused.
pub struct Registry<P, R, E> {
    pub slots: RwLock<BTreeMap<usize, Arc<Slot<P, R, E>>>>,
    pub last: AtomicUsize,
}

/// A problem with its busy flag, which is the lock, and its last error, which can be read while a call runs.
pub struct Slot<P, R, E> {
    /// None after the problem is destroyed.
    problem: Mutex<Option<P>>,
    /// Shared with the problem, so that it can be set while a call runs.
    cancelled: Arc<AtomicBool>,
    broken: AtomicBool,
    error: Mutex<Option<R>>,
    /// Data that every thread may use while a call runs.
    pub shared: E,
}

/// Why a problem is not available.
#[derive(Debug, PartialEq)]
pub enum Refusal {
    Busy,
    Gone,
    Broken,
}

impl<P, R: Clone, E> Slot<P, R, E> {
    /// Locks the problem for one call; the content is None if it is destroyed.
    fn claim(&self) -> Result<MutexGuard<'_, Option<P>>, Refusal> {
        match self.problem.try_lock() {
            Ok(problem) => Ok(problem),
            Err(TryLockError::WouldBlock) => Err(Refusal::Busy),
            Err(TryLockError::Poisoned(poisoned)) => {
                self.mark_broken();
                Ok(poisoned.into_inner())
            }
        }
    }

    /// Runs `work` on the problem unless another call runs, the problem is destroyed, or an internal error has made it
    /// unusable.
    pub fn with<T>(&self, work: impl FnOnce(&mut P) -> T) -> Result<T, Refusal> {
        let mut claimed = self.claim()?;
        let problem = claimed.as_mut().ok_or(Refusal::Gone)?;
        if self.broken.load(Ordering::Acquire) {
            return Err(Refusal::Broken);
        }
        Ok(work(problem))
    }

    /// Ends the running setup or solve.
    pub fn cancel(&self) -> Result<(), Refusal> {
        if self.broken.load(Ordering::Acquire) {
            return Err(Refusal::Broken);
        }
        self.cancelled.store(true, Ordering::Relaxed);
        Ok(())
    }

    /// After an internal error the problem can only be destroyed.
    pub fn mark_broken(&self) {
        self.broken.store(true, Ordering::Release);
    }

    pub fn keep_error(&self, record: R) {
        instant(|| *self.error.lock().unwrap_or_else(PoisonError::into_inner) = Some(record));
    }

    /// The problem's last error.
    pub fn error(&self) -> Option<R> {
        instant(|| self.error.lock().unwrap_or_else(PoisonError::into_inner).clone())
    }
}

impl<P, R: Clone, E> Registry<P, R, E> {
    /// Registers a problem with its flag `cancelled` under a new number; None if all numbers are used.
    pub fn register(&self, problem: P, cancelled: Arc<AtomicBool>, shared: E) -> Option<usize> {
        let next = self.last.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |last| last.checked_add(1));
        let number = next.ok()? + 1;
        let slot = Slot {
            problem: Mutex::new(Some(problem)),
            cancelled,
            broken: AtomicBool::new(false),
            error: Mutex::new(None),
            shared,
        };
        let slot = Arc::new(slot);
        instant(|| self.slots.write().unwrap_or_else(PoisonError::into_inner).insert(number, slot));
        Some(number)
    }

    pub fn find(&self, number: usize) -> Option<Arc<Slot<P, R, E>>> {
        instant(|| self.slots.read().unwrap_or_else(PoisonError::into_inner).get(&number).cloned())
    }

    /// Removes the problem; a call that already found the slot gets [`Refusal::Gone`].
    pub fn remove(&self, number: usize) -> Result<P, Refusal> {
        let slot = self.find(number).ok_or(Refusal::Gone)?;
        let problem = slot.claim()?.take().ok_or(Refusal::Gone)?;
        instant(|| self.slots.write().unwrap_or_else(PoisonError::into_inner).remove(&number));
        Ok(problem)
    }
}
