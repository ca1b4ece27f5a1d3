//! The library's own threads: as many as the host asks for, made when first needed, never rayon's global pool.

use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Error, Kind, Result};
use crate::linalg::memory::room;

/// Pools by process and size: a forked child has none of its parent's threads and makes its own.
static POOLS: Mutex<Vec<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

/// Bytes a thread takes to start: its stack and its first small pieces.
const STARTING: usize = (2 << 20) + (256 << 10);

/// Name of every thread of a pool.
pub const THREAD_NAME: &str = "feti-contact";

/// Threads to use: those asked for, or one for every CPU this process may run on.
pub fn count(asked: i64) -> usize {
    match usize::try_from(asked) {
        Ok(threads) if threads > 0 => threads,
        _ => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
    }
}

/// Runs tasks `0..count` and returns their results in order; the first error in order wins.
pub fn run<T: Send>(
    threads: usize,
    count: usize,
    task: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let results: Vec<Result<T>> = if threads < 2 || count < 2 {
        (0..count).map(&task).collect()
    } else {
        pool(threads)?.install(|| (0..count).into_par_iter().map(&task).collect())
    };
    results.into_iter().collect()
}

fn pool(threads: usize) -> Result<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, _, pool)) = pools.iter().find(|(p, size, _)| *p == process && *size == threads) {
        return Ok(Arc::clone(pool));
    }
    let starting = room(threads * STARTING, "threads")?;
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|_| THREAD_NAME.to_owned())
        .build()
        .map_err(|e| Error::new(Kind::Memory, format!("{threads} threads could not be started: {e}")))?;
    // Until every thread runs: then it has the memory that the system gives a thread, and what is left can be judged.
    pool.broadcast(|_| ());
    drop(starting);
    room(0, "threads")?;
    let pool = Arc::new(pool);
    pools.push((process, threads, Arc::clone(&pool)));
    Ok(pool)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_and_errors_come_in_the_order_of_the_tasks() {
        for threads in [1, 2, 5] {
            assert_eq!(run(threads, 20, |k| Ok(k * k)).unwrap(), (0..20).map(|k| k * k).collect::<Vec<_>>());
            let failing = |k| if k % 7 == 3 { Err(Error::new(Kind::State, "no").body(k)) } else { Ok(k) };
            assert_eq!(run(threads, 20, failing).unwrap_err().place.body, Some(3));
        }
    }
}
