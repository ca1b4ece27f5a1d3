//! The registry of problems. A handle is a counter from 1, cast to a pointer: never an address, never reused, and looked
//! up at every call, so that a NULL, dead or foreign handle is detected without touching memory.

use std::collections::BTreeMap;
use std::ptr;

use crate::boundary::error_store::Record;
use crate::boundary::fpu::Environment;
use crate::boundary::registry::{self, Registry};
use crate::boundary::sync::{Arc, AtomicUsize, RwLock};
use crate::header::types::feti_problem;
use feti_contact::error::{Error, Kind, Result};
use feti_contact::solver::Problem;

pub use crate::boundary::registry::Refusal;

pub type Slot = registry::Slot<Problem, Record, Arc<Environment>>;

static PROBLEMS: Registry<Problem, Record, Arc<Environment>> =
    Registry { slots: RwLock::new(BTreeMap::new()), last: AtomicUsize::new(0) };

/// Registers a problem under a new handle.
pub fn register(problem: Problem) -> Result<*mut feti_problem> {
    let cancelled = problem.canceller();
    let number = PROBLEMS
        .register(problem, cancelled, Arc::new(Environment::new()))
        .ok_or_else(|| Error::new(Kind::Overflow, "all numbers of handles are used up"))?;
    Ok(ptr::without_provenance_mut(number))
}

pub fn find(handle: *mut feti_problem) -> Option<Arc<Slot>> {
    PROBLEMS.find(handle.addr())
}

/// Removes the problem from the registry; a call that already found the slot gets [`Refusal::Gone`].
pub fn remove(handle: *mut feti_problem) -> std::result::Result<Problem, Refusal> {
    PROBLEMS.remove(handle.addr())
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
