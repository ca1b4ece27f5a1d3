//! The registry of problems. A handle is a counter from 1, cast to a pointer: never an address, never reused, and looked
//! up at every call, so that a NULL, dead or foreign handle is found out without touching memory.

use std::collections::BTreeMap;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, TryLockError};

use super::error_store::Record;
use super::fpu::Environment;
use super::types::feti_problem;
use crate::error::{Error, Kind, Result};
use crate::solver::Problem;

static PROBLEMS: RwLock<BTreeMap<usize, Arc<Slot>>> = RwLock::new(BTreeMap::new());
static LAST_HANDLE: AtomicUsize = AtomicUsize::new(0);

/// A problem with its busy flag, which is the lock, and its last error, which can be read while a call runs.
pub(super) struct Slot {
    /// None once destroyed.
    problem: Mutex<Option<Problem>>,
    /// Shared with the problem, so that it can be set while a call runs.
    cancelled: Arc<AtomicBool>,
    broken: AtomicBool,
    error: Mutex<Option<Record>>,
    /// Floating-point environment of the call that runs.
    pub environment: Arc<Environment>,
}

/// Why a problem could not be taken.
#[derive(Debug, PartialEq)]
pub(super) enum Refusal {
    Busy,
    Gone,
    Broken,
}

impl Slot {
    /// The problem, for one call; None inside when it is destroyed.
    fn claim(&self) -> std::result::Result<MutexGuard<'_, Option<Problem>>, Refusal> {
        match self.problem.try_lock() {
            Ok(problem) => Ok(problem),
            Err(TryLockError::WouldBlock) => Err(Refusal::Busy),
            Err(TryLockError::Poisoned(poisoned)) => {
                self.mark_broken();
                Ok(poisoned.into_inner())
            }
        }
    }

    /// Runs `work` on the problem unless another call runs, or it is destroyed, or an internal error left it unusable.
    pub fn with<T>(&self, work: impl FnOnce(&mut Problem) -> T) -> std::result::Result<T, Refusal> {
        let mut claimed = self.claim()?;
        let problem = claimed.as_mut().ok_or(Refusal::Gone)?;
        if self.broken.load(Ordering::Acquire) {
            return Err(Refusal::Broken);
        }
        self.environment.note();
        Ok(work(problem))
    }

    /// Ends the setup or the solve that runs.
    pub fn cancel(&self) -> std::result::Result<(), Refusal> {
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

    pub fn keep_error(&self, record: Record) {
        *self.error.lock().unwrap_or_else(PoisonError::into_inner) = Some(record);
    }

    /// Text of the problem's last error, empty when there was none.
    pub fn error_text(&self) -> String {
        let kept = self.error.lock().unwrap_or_else(PoisonError::into_inner);
        kept.as_ref().map(|record| record.text.clone()).unwrap_or_default()
    }
}

/// Enters a problem under a new handle.
pub(super) fn register(problem: Problem) -> Result<*mut feti_problem> {
    let next = LAST_HANDLE.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |last| last.checked_add(1));
    let last = next.map_err(|last| Error::new(Kind::Overflow, format!("all {last} handles are used up")))?;
    let slot = Slot {
        cancelled: problem.canceller(),
        problem: Mutex::new(Some(problem)),
        broken: AtomicBool::new(false),
        error: Mutex::new(None),
        environment: Arc::new(Environment::new()),
    };
    PROBLEMS.write().unwrap_or_else(PoisonError::into_inner).insert(last + 1, Arc::new(slot));
    Ok(ptr::without_provenance_mut(last + 1))
}

pub(super) fn find(handle: *mut feti_problem) -> Option<Arc<Slot>> {
    PROBLEMS.read().unwrap_or_else(PoisonError::into_inner).get(&handle.addr()).cloned()
}

/// Takes the problem out of the registry; a call that found the slot before meets [`Refusal::Gone`].
pub(super) fn remove(handle: *mut feti_problem) -> std::result::Result<Problem, Refusal> {
    let slot = find(handle).ok_or(Refusal::Gone)?;
    let problem = slot.claim()?.take().ok_or(Refusal::Gone)?;
    PROBLEMS.write().unwrap_or_else(PoisonError::into_inner).remove(&handle.addr());
    Ok(problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_threads_that_destroy_a_problem_one_succeeds() {
        for _ in 0..100 {
            let number = register(Problem::new()).unwrap().addr();
            let threads: Vec<_> = (0..4)
                .map(|_| std::thread::spawn(move || remove(ptr::without_provenance_mut(number)).map(|_| ())))
                .collect();
            let outcomes: Vec<_> = threads.into_iter().map(|thread| thread.join().unwrap()).collect();
            assert_eq!(outcomes.iter().filter(|outcome| outcome.is_ok()).count(), 1);
            assert!(find(ptr::without_provenance_mut(number)).is_none());
        }
    }

    #[test]
    fn problems_on_many_threads_do_not_disturb_each_other() {
        let work = || {
            let handles: Vec<_> = (0..100).map(|_| register(Problem::new()).unwrap()).collect();
            let used = handles
                .iter()
                .all(|p| find(*p).unwrap().with(|problem| problem.add_body(3)).unwrap() == Ok(0));
            used && handles.into_iter().all(|p| remove(p).is_ok())
        };
        let threads: Vec<_> = (0..4).map(|_| std::thread::spawn(work)).collect();
        assert!(threads.into_iter().all(|thread| thread.join().unwrap()));
    }
}
