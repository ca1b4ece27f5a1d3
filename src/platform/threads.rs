//! The library's own threads: as many as the host asks for, created when first needed, never rayon's global pool.

use std::cell::Cell;
use std::hint::black_box;
use std::sync::mpsc::{channel, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Error, Result};
use crate::platform::interrupt::Interrupt;
use crate::platform::memory::headroom;
use crate::platform::pools::Pools;

static POOLS: Pools<ThreadPool> = Pools { made: Mutex::new(Vec::new()) };

/// Stack of a thread. Set explicitly, or the standard library would use the environment variable RUST_MIN_STACK.
const STACK: usize = 2 << 20;
/// Address space of a thread: its stack, and the heap of 64 MiB that the GNU allocator reserves for it. Without this heap
/// every small object takes a page.
const STARTED: usize = STACK + (65 << 20);
/// The allocator reserves twice the heap size and keeps an aligned half.
const STARTING: usize = 64 << 20;

/// Name of every thread of a pool.
pub const THREAD_NAME: &str = "feti-contact";

/// Limit of threads per CPU: more threads would wait for each other.
const PER_CPU: usize = 4;

/// Number of threads: as requested, or one per CPU of this process; at most as many as the work can occupy, rounded down
/// to a power of two, so that problems of similar size share a pool.
pub fn count(asked: i64, occupied: usize) -> usize {
    let cpus = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let occupied = 1 << occupied.max(1).ilog2();
    match usize::try_from(asked).unwrap_or(0).min(occupied) {
        0 if occupied == 1 => 1,
        0 => cpus().min(occupied),
        // the system is asked only if it matters
        asked if asked <= PER_CPU => asked,
        asked => asked.min(PER_CPU * cpus()),
    }
}

/// Runs tasks `0..count`, which may share their own work among the threads, under the interrupt of this thread, and
/// returns their results in order; the first error in order wins. If the system gives fewer threads, these do all the
/// work.
pub fn run<T: Send>(
    threads: usize,
    count: usize,
    task: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let pool = if count < 1 { None } else { pool_for(threads) };
    let results: Vec<Result<T>> = match pool {
        Some(pool) => {
            let present = Interrupt::present().unheard();
            pool.install(|| (0..count).into_par_iter().map_init(|| present.enter(), |_, k| task(k)).collect())
        }
        None => (0..count).map(&task).collect(),
    };
    results.into_iter().collect()
}

thread_local! {
    /// Number of threads for loops over long vectors.
    static TEAM: Cell<usize> = const { Cell::new(1) };
}

/// Runs `work`, in which [`parts`] may share loops among this number of threads.
pub fn with_team<T>(threads: usize, work: impl FnOnce() -> T) -> T {
    struct Before(usize);
    impl Drop for Before {
        fn drop(&mut self) {
            TEAM.set(self.0);
        }
    }
    let _before = Before(TEAM.replace(threads));
    work()
}

/// Results of the parts `0..count` of a loop, in order. The parts must not depend on the number of threads, and none may
/// wait or fail.
pub fn parts<T: Send>(count: usize, part: impl Fn(usize) -> T + Sync) -> Vec<T> {
    match if count > 1 { pool_for(TEAM.get()) } else { None } {
        Some(pool) => pool.install(|| (0..count).into_par_iter().map(&part).collect()),
        None => (0..count).map(&part).collect(),
    }
}

/// As `parts`, with a piece of data for every part: piece k of `pieces` goes to part k.
pub fn parts_of<P: Send, T: Send>(pieces: Vec<P>, part: impl Fn(usize, P) -> T + Sync) -> Vec<T> {
    match if pieces.len() > 1 { pool_for(TEAM.get()) } else { None } {
        Some(pool) => {
            pool.install(|| pieces.into_par_iter().enumerate().map(|(k, piece)| part(k, piece)).collect())
        }
        None => pieces.into_iter().enumerate().map(|(k, piece)| part(k, piece)).collect(),
    }
}

/// As `run`, but the calling thread itself runs the tasks `on_caller`.
pub fn run_apart<T: Send>(
    threads: usize,
    count: usize,
    on_caller: impl Fn(usize) -> bool,
    task: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    if !(0..count).any(&on_caller) {
        return run(threads, count, task);
    }
    let order: Vec<usize> = (0..count).collect();
    let mut results: Vec<Option<T>> = order.iter().map(|_| None).collect();
    run_heard(Tasks { threads, order: &order, on_caller: &on_caller }, task, &mut |heard| {
        if let TaskEvent::Done(k, result) = heard {
            results[k] = Some(result);
        }
    })?;
    Ok(results.into_iter().flatten().collect())
}

/// The order in which tasks begin, a permutation of `0..order.len()`, and which tasks must run on the calling thread.
#[derive(Clone, Copy)]
pub struct Tasks<'a> {
    pub threads: usize,
    pub order: &'a [usize],
    pub on_caller: &'a dyn Fn(usize) -> bool,
}

/// What the calling thread receives while tasks run.
pub enum TaskEvent<T, M = ()> {
    /// A task is done, with its result.
    Done(usize, T),
    /// A message of a task that is still running.
    Said(M),
    /// Nothing has arrived for some time.
    Nothing,
}

/// The calling thread receives `Nothing` after this time.
const PATIENCE: Duration = Duration::from_millis(500);

/// Starts tasks in their order; the calling thread receives every result when it is complete, between the tasks that it
/// runs itself. All tasks are run; returns the error with the lowest task number.
pub fn run_heard<T: Send>(
    tasks: Tasks,
    task: impl Fn(usize) -> Result<T> + Sync,
    hear: &mut dyn FnMut(TaskEvent<T>),
) -> Result<()> {
    run_telling(tasks, |k, _| task(k), hear)
}

/// As `run_heard`, for tasks that send messages while they run.
pub fn run_telling<T: Send, M: Send>(
    tasks: Tasks,
    task: impl Fn(usize, &dyn Fn(M)) -> Result<T> + Sync,
    hear: &mut dyn FnMut(TaskEvent<T, M>),
) -> Result<()> {
    let mut first: Option<(usize, Error)> = None;
    let mut sort = |event: TaskEvent<Result<T>, M>| match event {
        TaskEvent::Nothing => hear(TaskEvent::Nothing),
        TaskEvent::Said(what) => hear(TaskEvent::Said(what)),
        TaskEvent::Done(k, Ok(value)) => hear(TaskEvent::Done(k, value)),
        TaskEvent::Done(k, Err(error)) if first.as_ref().is_none_or(|(at, _)| k < *at) => {
            first = Some((k, error));
        }
        TaskEvent::Done(..) => {}
    };
    let (sender, sent) = channel();
    let run = |k: usize, sender: &Sender<TaskEvent<Result<T>, M>>| {
        let ended = task(k, &|what| drop(sender.send(TaskEvent::Said(what))));
        drop(sender.send(TaskEvent::Done(k, ended)));
    };
    let (own, others): (Vec<usize>, Vec<usize>) = tasks.order.iter().partition(|&&k| (tasks.on_caller)(k));
    let present = Interrupt::present().unheard();
    match pool_for(if others.is_empty() { 0 } else { tasks.threads }) {
        None => tasks.order.iter().for_each(|&k| {
            run(k, &sender);
            sent.try_iter().for_each(&mut sort);
        }),
        Some(pool) => pool.in_place_scope(|scope| {
            for k in others {
                let (sender, run, present) = (sender.clone(), &run, &present);
                // The calling thread receives until the last sender is dropped, so no message is lost.
                scope.spawn(move |_| present.during(|| run(k, &sender)));
            }
            for k in own {
                run(k, &sender);
                sent.try_iter().for_each(&mut sort);
            }
            drop(sender);
            loop {
                match sent.recv_timeout(PATIENCE) {
                    Ok(event) => sort(event),
                    Err(RecvTimeoutError::Timeout) => sort(TaskEvent::Nothing),
                    Err(RecvTimeoutError::Disconnected) => break,
                }
            }
        }),
    }
    first.map_or(Ok(()), |(_, error)| Err(error))
}

/// None on a thread of a pool, where a function of the host has called the library for another problem: waiting there
/// could block the last working thread.
fn pool_for(threads: usize) -> Option<Arc<ThreadPool>> {
    largest_pool(if rayon::current_thread_index().is_some() { 1 } else { threads })
}

/// A pool of this size, or half of it, and so on; none for a single thread.
fn largest_pool(threads: usize) -> Option<Arc<ThreadPool>> {
    std::iter::successors(Some(threads), |threads| Some(threads / 2)).take_while(|t| *t > 1).find_map(pool)
}

fn pool(threads: usize) -> Option<Arc<ThreadPool>> {
    POOLS.get(std::process::id(), threads, || {
        let starting = headroom(threads * STARTED + STARTING, "threads").ok()?;
        let builder = ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK);
        let pool = builder.thread_name(|_| THREAD_NAME.to_owned()).build().ok()?;
        // every thread allocates its heap now, while there is room for it
        pool.broadcast(|_| drop(black_box(Box::new(0_u64))));
        drop(starting);
        Some(pool)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    use crate::error::Kind;

    #[test]
    fn results_and_errors_come_in_the_order_of_the_tasks() {
        for threads in [1, 2, 5] {
            assert_eq!(run(threads, 20, |k| Ok(k * k)).unwrap(), (0..20).map(|k| k * k).collect::<Vec<_>>());
            let failing = |k| if k % 7 == 3 { Err(Error::new(Kind::State, "no").body(k)) } else { Ok(k) };
            assert_eq!(run(threads, 20, failing).unwrap_err().place.body, Some(3));
        }
    }

    #[test]
    fn the_calling_thread_hears_of_every_result_and_gets_the_first_error_in_order() {
        let caller = std::thread::current().id();
        let order: Vec<usize> = (0..20).rev().collect();
        for threads in [1, 2, 5] {
            let mut heard = Vec::new();
            let failing = |k| if k % 7 == 3 { Err(Error::new(Kind::State, "no").body(k)) } else { Ok(k * k) };
            let ended =
                run_heard(Tasks { threads, order: &order, on_caller: &|_| false }, failing, &mut |event| {
                    assert_eq!(std::thread::current().id(), caller);
                    if let TaskEvent::Done(k, square) = event {
                        heard.push((k, square));
                    }
                });
            if threads == 1 {
                assert!(heard.is_sorted_by(|a, b| a.0 > b.0), "begun in another order");
            }
            heard.sort_unstable();
            let expected: Vec<_> = (0..20).filter(|k| k % 7 != 3).map(|k| (k, k * k)).collect();
            assert_eq!((heard, ended.unwrap_err().place.body), (expected, Some(3)));
        }
    }

    #[test]
    fn threads_are_as_many_as_the_work_occupies_and_a_few_for_each_cpu_at_most() {
        let cpus = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        for (asked, occupied, expected) in [
            (1, 1 << 20, 1),
            (3, 1 << 20, 3),
            (4096, 0, 1),
            (4096, 1, 1),
            (4096, 3, 2),
            (3, 5, 3),
            (4096, 9, 8.min(4 * cpus)),
            (4096, 1 << 20, 4 * cpus),
            (0, 1 << 20, cpus),
            (0, 1, 1),
        ] {
            assert_eq!(count(asked, occupied), expected, "{asked} asked for, {occupied} occupied");
        }
    }

    #[test]
    fn of_many_sizes_four_pools_wait_and_those_in_use_or_of_another_process_stay() {
        let pools = Pools { made: Mutex::new(vec![(1, 2, Arc::new(0))]) };
        let used = pools.get(7, 2, || Some(2)).unwrap();
        (3..30).for_each(|size| assert_eq!(pools.get(7, size, || Some(size)).as_deref(), Some(&size)));
        assert!(Arc::ptr_eq(&used, &pools.get(7, 2, || None).unwrap()), "a pool in use is gone");
        assert_eq!(pools.get(7, 29, || None).as_deref(), Some(&29), "the one of the last call is gone");
        let there: Vec<_> = pools.made.lock().unwrap().iter().map(|(p, size, _)| (*p, *size)).collect();
        assert_eq!(there, [(1, 2), (7, 27), (7, 28), (7, 2), (7, 29)]);
    }

    /// Independently of other tasks that the threads of a pool run at that time.
    #[test]
    fn tasks_on_other_threads_are_those_of_the_call_that_began_them() {
        use crate::platform::interrupt::check;
        let cancelled = Interrupt::new(std::sync::Arc::new(AtomicBool::new(true)));
        for threads in [1, 2] {
            let ended = cancelled.during(|| run(threads, 8, |_| check()));
            assert_eq!(ended.unwrap_err().kind, Kind::Cancelled);
            let order: Vec<usize> = (0..8).collect();
            let tasks = Tasks { threads, order: &order, on_caller: &|_| false };
            let ended = cancelled.during(|| run_heard(tasks, |_| check(), &mut |_| {}));
            assert_eq!(ended.unwrap_err().kind, Kind::Cancelled);
            assert!(run(threads, 8, |_| check()).is_ok());
        }
    }

    #[test]
    fn calls_from_threads_of_the_pool_end() {
        let within = |k: usize| run_apart(2, 5, |inner| inner == 4, |inner| Ok(k + inner));
        assert_eq!(run(2, 8, within).unwrap()[7], [7, 8, 9, 10, 11]);
    }

    #[test]
    fn the_calling_thread_runs_its_own_tasks_and_results_stay_in_order() {
        let caller = std::thread::current().id();
        for threads in [1, 2, 5] {
            let own = |k: usize| k % 3 == 1;
            let task = |k: usize| {
                assert!(!own(k) || std::thread::current().id() == caller, "{k}");
                Ok(k)
            };
            assert_eq!(run_apart(threads, 20, own, task).unwrap(), (0..20).collect::<Vec<_>>());
            let failing = |k| if k > 7 { Err(Error::new(Kind::State, "no").body(k)) } else { Ok(k) };
            assert_eq!(run_apart(threads, 20, own, failing).unwrap_err().place.body, Some(8));
        }
    }

    #[test]
    fn the_calling_thread_hears_something_during_a_long_task() {
        let ended = AtomicBool::new(false);
        let waiting = |_| {
            while !ended.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(1));
            }
            Ok(())
        };
        let mut events = Vec::new();
        run_heard(Tasks { threads: 2, order: &[0], on_caller: &|_| false }, waiting, &mut |event| {
            events.push(matches!(event, TaskEvent::Nothing));
            ended.store(true, Ordering::Relaxed);
        })
        .unwrap();
        assert_eq!(events, [true, false]);
    }
}
