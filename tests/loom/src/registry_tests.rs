use std::collections::BTreeMap;

use loom::cell::UnsafeCell;
use loom::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use loom::sync::{Arc, RwLock};
use loom::thread;

use crate::registry::{Refusal, Registry};

/// Loom fails a test in which two threads touch the cell at a time.
struct Problem {
    calls: UnsafeCell<usize>,
    cancelled: Arc<AtomicBool>,
}

type Problems = Arc<Registry<Problem, usize, ()>>;

fn empty() -> Problems {
    Arc::new(Registry { slots: RwLock::new(BTreeMap::new()), last: AtomicUsize::new(0) })
}

fn create(problems: &Problems) -> usize {
    let cancelled = Arc::new(AtomicBool::new(false));
    let problem = Problem { calls: UnsafeCell::new(0), cancelled: Arc::clone(&cancelled) };
    problems.register(problem, cancelled, ()).unwrap()
}

/// A call as the guard makes it: found, taken, used.
fn call(problems: &Problems, number: usize) -> Result<usize, Refusal> {
    let slot = problems.find(number).ok_or(Refusal::Gone)?;
    slot.with(|problem| {
        problem.calls.with_mut(|calls| {
            // SAFETY: loom watches that nobody else has the pointer now.
            unsafe {
                *calls += 1;
                *calls
            }
        })
    })
}

/// Runs both on threads of their own, on the same registry, in all orders.
fn beside<A: 'static, B: 'static>(
    problems: &Problems,
    first: impl FnOnce(&Problems) -> A + 'static,
    second: impl FnOnce(&Problems) -> B + 'static,
) -> (A, B) {
    let theirs = Arc::clone(problems);
    let other = thread::spawn(move || first(&theirs));
    let mine = second(problems);
    (other.join().unwrap(), mine)
}

#[test]
fn problems_created_on_two_threads_have_numbers_of_their_own_and_are_found() {
    loom::model(|| {
        let problems = empty();
        let (a, b) = beside(&problems, create, create);
        assert_eq!((a.min(b), a.max(b)), (1, 2));
        assert_eq!((call(&problems, a), call(&problems, b)), (Ok(1), Ok(1)));
    });
}

#[test]
fn of_two_calls_on_a_problem_one_runs_and_the_other_is_told_busy_or_comes_after() {
    loom::model(|| {
        let problems = empty();
        let number = create(&problems);
        let outcome = beside(&problems, move |p| call(p, number), move |p| call(p, number));
        let right =
            [(Ok(1), Ok(2)), (Ok(2), Ok(1)), (Ok(1), Err(Refusal::Busy)), (Err(Refusal::Busy), Ok(1))];
        assert!(right.contains(&outcome), "{outcome:?}");
    });
}

#[test]
fn of_two_threads_that_destroy_a_problem_one_succeeds() {
    loom::model(|| {
        let problems = empty();
        let number = create(&problems);
        let remove = move |p: &Problems| p.remove(number).map(drop);
        let (a, b) = beside(&problems, remove, remove);
        assert_eq!([&a, &b].iter().filter(|outcome| outcome.is_ok()).count(), 1);
        assert!([a, b].contains(&Err(Refusal::Busy)) || problems.find(number).is_none());
    });
}

#[test]
fn a_problem_destroyed_during_a_call_stays_until_the_call_is_over_or_the_call_finds_none() {
    loom::model(|| {
        let problems = empty();
        let number = create(&problems);
        let (called, removed) =
            beside(&problems, move |p| call(p, number), move |p| p.remove(number).map(drop));
        match (&called, &removed) {
            // Busy each: the call held the problem, or the destruction did.
            (Ok(1), Ok(())) | (Ok(1), Err(Refusal::Busy)) => {}
            (Err(Refusal::Gone | Refusal::Busy), Ok(())) => {}
            outcome => panic!("{outcome:?}"),
        }
        assert_eq!(problems.find(number).is_none(), removed.is_ok());
    });
}

#[test]
fn a_problem_created_while_another_one_is_destroyed_is_not_disturbed() {
    loom::model(|| {
        let problems = empty();
        let old = create(&problems);
        let (new, removed) = beside(&problems, create, move |p| p.remove(old).map(drop));
        assert_eq!((new, removed, call(&problems, new)), (2, Ok(()), Ok(1)));
        assert!(problems.find(old).is_none());
    });
}

#[test]
fn a_call_that_runs_is_cancelled_from_another_thread_without_waiting() {
    loom::model(|| {
        let problems = empty();
        let number = create(&problems);
        let wish = |problem: &mut Problem| problem.cancelled.load(Ordering::Relaxed);
        let running = move |p: &Problems| p.find(number).unwrap().with(wish);
        let (seen, told) = beside(&problems, running, move |p| p.find(number).unwrap().cancel());
        assert!(seen.is_ok() && told == Ok(()));
        // Whoever comes later sees the wish.
        assert_eq!(problems.find(number).unwrap().with(wish), Ok(true));
    });
}

#[test]
fn a_problem_that_failed_inside_refuses_the_next_call_and_is_destroyed() {
    loom::model(|| {
        let problems = empty();
        let number = create(&problems);
        let failing = move |p: &Problems| {
            let slot = p.find(number).unwrap();
            slot.with(|_| slot.mark_broken())
        };
        let (failed, called) = beside(&problems, failing, move |p| call(p, number));
        let right = [Ok(1), Err(Refusal::Busy), Err(Refusal::Broken)];
        assert!(
            right.contains(&called) && (failed.is_ok() || failed == Err(Refusal::Busy)),
            "{failed:?} {called:?}"
        );
        if failed.is_ok() {
            assert_eq!(call(&problems, number), Err(Refusal::Broken));
            assert_eq!(problems.find(number).unwrap().cancel(), Err(Refusal::Broken));
        }
        assert!(problems.remove(number).is_ok());
    });
}

#[test]
fn the_error_of_a_problem_is_read_while_a_call_runs_whole_or_not_at_all() {
    loom::model(|| {
        let problems = empty();
        let number = create(&problems);
        let failing = move |p: &Problems| {
            let slot = p.find(number).unwrap();
            slot.with(|_| slot.keep_error(5))
        };
        let (_, read) = beside(&problems, failing, move |p| p.find(number).unwrap().error());
        assert!([None, Some(5)].contains(&read));
        assert_eq!(problems.find(number).unwrap().error(), Some(5));
    });
}
