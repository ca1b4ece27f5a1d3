//! The library's own threads: as many as the host asks for, made when first needed, never rayon's global pool.

use std::hint::black_box;
use std::sync::mpsc::{channel, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Error, Result};
use crate::linalg::memory::room;
use crate::solver::pools::Pools;

static POOLS: Pools<ThreadPool> = Pools { made: Mutex::new(Vec::new()) };

/// Address space of a thread: its stack, and the heap of 64 MiB that the GNU allocator sets apart for it. Without one
/// every small piece takes a page.
const STARTED: usize = 67 << 20;
/// The heap is cut out of twice its size.
const STARTING: usize = 64 << 20;

/// Name of every thread of a pool.
pub const THREAD_NAME: &str = "feti-contact";

/// Threads to use: those asked for, or one for every CPU this process may run on.
pub fn count(asked: i64) -> usize {
    match usize::try_from(asked) {
        Ok(threads) if threads > 0 => threads,
        _ => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
    }
}

/// Runs tasks `0..count`, which may share their own work among the threads, and returns their results in order; the
/// first error in order wins. Where the system does not
/// give so many threads, fewer do the same.
pub fn run<T: Send>(
    threads: usize,
    count: usize,
    task: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let pool = if count < 1 { None } else { largest_pool(threads) };
    let results: Vec<Result<T>> = match pool {
        Some(pool) => pool.install(|| (0..count).into_par_iter().map(&task).collect()),
        None => (0..count).map(&task).collect(),
    };
    results.into_iter().collect()
}

/// What the calling thread hears while tasks run.
pub enum Heard<T> {
    /// A task is done, with its result.
    Done(usize, T),
    /// None has been for some time.
    Nothing,
}

/// The calling thread hears of itself after this time.
const PATIENCE: Duration = Duration::from_millis(500);

/// Runs tasks `0..count` while the calling thread hears of every result as it comes, in any order. All tasks are run;
/// returns the first error in their order.
pub fn run_heard<T: Send>(
    threads: usize,
    count: usize,
    task: impl Fn(usize) -> Result<T> + Sync,
    hear: &mut dyn FnMut(Heard<T>),
) -> Result<()> {
    let mut first: Option<(usize, Error)> = None;
    let mut sort = |ended: Option<(usize, Result<T>)>| match ended {
        None => hear(Heard::Nothing),
        Some((k, Ok(value))) => hear(Heard::Done(k, value)),
        Some((k, Err(error))) if first.as_ref().is_none_or(|(at, _)| k < *at) => first = Some((k, error)),
        Some(_) => {}
    };
    match largest_pool(if count == 0 { 0 } else { threads }) {
        None => (0..count).for_each(|k| sort(Some((k, task(k))))),
        Some(pool) => pool.in_place_scope(|scope| {
            let (sender, results) = channel();
            for k in 0..count {
                let (sender, task) = (sender.clone(), &task);
                // The calling thread listens until the last sender is gone: it is never sent into the void.
                scope.spawn(move |_| drop(sender.send((k, task(k)))));
            }
            drop(sender);
            loop {
                match results.recv_timeout(PATIENCE) {
                    Ok(ended) => sort(Some(ended)),
                    Err(RecvTimeoutError::Timeout) => sort(None),
                    Err(RecvTimeoutError::Disconnected) => break,
                }
            }
        }),
    }
    first.map_or(Ok(()), |(_, error)| Err(error))
}

/// A pool of so many threads, or of half as many, and so on; none of a single thread.
fn largest_pool(threads: usize) -> Option<Arc<ThreadPool>> {
    std::iter::successors(Some(threads), |threads| Some(threads / 2)).take_while(|t| *t > 1).find_map(pool)
}

fn pool(threads: usize) -> Option<Arc<ThreadPool>> {
    POOLS.get(std::process::id(), threads, || {
        let starting = room(threads * STARTED + STARTING, "threads").ok()?;
        let builder = ThreadPoolBuilder::new().num_threads(threads).thread_name(|_| THREAD_NAME.to_owned());
        let pool = builder.build().ok()?;
        // Every thread takes its heap now, while there is room for it.
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
        for threads in [1, 2, 5] {
            let mut heard = Vec::new();
            let failing = |k| if k % 7 == 3 { Err(Error::new(Kind::State, "no").body(k)) } else { Ok(k * k) };
            let ended = run_heard(threads, 20, failing, &mut |event| {
                assert_eq!(std::thread::current().id(), caller);
                if let Heard::Done(k, square) = event {
                    heard.push((k, square));
                }
            });
            heard.sort_unstable();
            let expected: Vec<_> = (0..20).filter(|k| k % 7 != 3).map(|k| (k, k * k)).collect();
            assert_eq!((heard, ended.unwrap_err().place.body), (expected, Some(3)));
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
        run_heard(2, 1, waiting, &mut |event| {
            events.push(matches!(event, Heard::Nothing));
            ended.store(true, Ordering::Relaxed);
        })
        .unwrap();
        assert_eq!(events, [true, false]);
    }
}
