//! The library's own threads: as many as the host asks for, made when first needed, never rayon's global pool.

use std::hint::black_box;
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::Result;
use crate::linalg::memory::room;

/// Pools by process and size: a forked child has none of its parent's threads and makes its own.
static POOLS: Mutex<Vec<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

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

/// A pool of so many threads, or of half as many, and so on; none of a single thread.
fn largest_pool(threads: usize) -> Option<Arc<ThreadPool>> {
    std::iter::successors(Some(threads), |threads| Some(threads / 2)).take_while(|t| *t > 1).find_map(pool)
}

fn pool(threads: usize) -> Option<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, _, pool)) = pools.iter().find(|(p, size, _)| *p == process && *size == threads) {
        return Some(Arc::clone(pool));
    }
    let starting = room(threads * STARTED + STARTING, "threads").ok()?;
    let builder = ThreadPoolBuilder::new().num_threads(threads).thread_name(|_| THREAD_NAME.to_owned());
    let pool = Arc::new(builder.build().ok()?);
    // Every thread takes its heap now, while there is room for it.
    pool.broadcast(|_| drop(black_box(Box::new(0_u64))));
    drop(starting);
    pools.push((process, threads, Arc::clone(&pool)));
    Some(pool)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Error, Kind};

    #[test]
    fn results_and_errors_come_in_the_order_of_the_tasks() {
        for threads in [1, 2, 5] {
            assert_eq!(run(threads, 20, |k| Ok(k * k)).unwrap(), (0..20).map(|k| k * k).collect::<Vec<_>>());
            let failing = |k| if k % 7 == 3 { Err(Error::new(Kind::State, "no").body(k)) } else { Ok(k) };
            assert_eq!(run(threads, 20, failing).unwrap_err().place.body, Some(3));
        }
    }
}
