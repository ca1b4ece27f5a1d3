//! Nested dissection by METIS 5, the library of the system (feature `metis`).
//!
//! During a call METIS 5.1 affects the host in ways that the library itself never does. It handles SIGABRT and SIGTERM
//! and leaves its code by a jump when one arrives, so none must arrive; both handlers are restored at the end. It seeds
//! `rand` of the C library and uses it: if the host calls `rand` at that time, the order changes, but the solution only
//! by rounding. If memory is short, METIS prints a line on stderr. A process runs one call at a time, so that threads of
//! this library do not mix up handlers and random numbers.

use std::ffi::c_void;
use std::ptr::null_mut;
use std::sync::{Mutex, PoisonError};

use crate::error::{Error, Kind, Result};
use crate::platform::memory::{refusal, reserved};

/// METIS_NOPTIONS.
const OPTIONS: usize = 40;
/// METIS_OK, METIS_ERROR_MEMORY.
const DONE: i32 = 1;
const MEMORY: i32 = -3;

static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

#[link(name = "metis")]
extern "C" {
    /// Arrays of `idx_t`, of 32 or 64 bits by the build of the library.
    fn METIS_SetDefaultOptions(options: *mut c_void) -> i32;
    fn METIS_NodeND(
        nodes: *mut c_void,
        ptr: *mut c_void,
        adj: *mut c_void,
        weights: *mut c_void,
        options: *mut c_void,
        order: *mut c_void,
        rank: *mut c_void,
    ) -> i32;
}

/// Nodes in the order of their elimination; the neighbours of node i, without itself, are `adj[ptr[i]..ptr[i + 1]]`; at
/// least one node has a neighbour.
pub fn dissect(ptr: &[i32], adj: &[i32]) -> Result<Vec<usize>> {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let (mut options, wide) = default_options();
    if wide {
        order::<i64>(ptr, adj, &mut options)
    } else {
        order::<i32>(ptr, adj, &mut options)
    }
}

/// The default options, and whether `idx_t` has 64 bits. The options, including a fixed seed, are -1: all bits are set,
/// in all bytes of `idx_t`.
fn default_options() -> ([i64; OPTIONS], bool) {
    let mut options = [0; OPTIONS];
    // SAFETY: METIS writes 40 numbers of at most 8 bytes.
    unsafe { METIS_SetDefaultOptions(options.as_mut_ptr().cast()) };
    (options, options[OPTIONS - 1] != 0)
}

/// `T` is `idx_t`.
fn order<T>(ptr: &[i32], adj: &[i32], options: &mut [i64; OPTIONS]) -> Result<Vec<usize>>
where
    T: Copy + From<i32> + TryInto<usize>,
{
    const WHAT: &str = "the ordering of a body";
    let as_given = |values: &[i32]| -> Result<Vec<T>> {
        let mut copy = reserved(values.len(), WHAT)?;
        copy.extend(values.iter().map(|&value| T::from(value)));
        Ok(copy)
    };
    let (mut ptr, mut adj) = (as_given(ptr)?, as_given(adj)?);
    let nodes = ptr.len() - 1;
    // less than the number of edges, which fits 31 bits
    let mut count = T::from(nodes as i32);
    let mut order: Vec<T> = reserved(nodes, WHAT)?;
    order.resize(nodes, T::from(0));
    let mut rank = order.clone();
    // SAFETY: all arrays have the type and the length required by METIS; it writes only to the last two, and keeps no
    // pointer.
    let status = unsafe {
        METIS_NodeND(
            (&raw mut count).cast(),
            ptr.as_mut_ptr().cast(),
            adj.as_mut_ptr().cast(),
            null_mut(),
            options.as_mut_ptr().cast(),
            order.as_mut_ptr().cast(),
            rank.as_mut_ptr().cast(),
        )
    };
    match status {
        DONE => order.into_iter().map(|node| node.try_into().map_err(|_| failed(status))).collect(),
        MEMORY => Err(refusal(adj.len() * size_of::<T>(), WHAT)),
        _ => Err(failed(status)),
    }
}

fn failed(status: i32) -> Error {
    Error::new(Kind::Internal, format!("nested dissection by METIS failed with status {status}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::cholesky::analysis::dissection;
    use crate::linalg::cholesky::analysis::supernodes::Supernodes;
    use crate::linalg::sparse::graph::Graph;

    /// A cube of n^3 nodes; all nodes of an element are coupled.
    fn cube(n: i32) -> (Vec<i32>, Vec<i32>) {
        let (mut ptr, mut adj) = (vec![0], Vec::new());
        for i in 0..n * n * n {
            let (x, y, z) = (i % n, i / n % n, i / (n * n));
            for k in 0..27 {
                let (x, y, z) = (x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1);
                adj.extend(
                    (k != 13 && [x, y, z].iter().all(|v| (0..n).contains(v))).then(|| x + n * (y + n * z)),
                );
            }
            ptr.push(adj.len() as i32);
        }
        (ptr, adj)
    }

    #[test]
    fn the_width_of_its_numbers_is_that_of_its_header() {
        let header = std::fs::read_to_string("/usr/include/metis.h").unwrap();
        let width = header.lines().find_map(|line| line.trim().strip_prefix("#define IDXTYPEWIDTH")).unwrap();
        assert_eq!(default_options().1, width.trim() == "64");
    }

    #[test]
    fn the_fill_is_about_that_of_the_default() {
        let (ptr, adj) = cube(14);
        let full: Vec<Vec<u32>> = (0..ptr.len() - 1)
            .map(|i| {
                let mut row: Vec<u32> =
                    adj[ptr[i] as usize..ptr[i + 1] as usize].iter().map(|&j| j as u32).collect();
                row.push(i as u32);
                row.sort_unstable();
                row
            })
            .collect();
        let mut graph = Graph { ptr: vec![0], adj: full.concat() };
        full.iter().for_each(|row| graph.ptr.push(graph.ptr[graph.ptr.len() - 1] + row.len()));
        let fill = |order: Vec<usize>| Supernodes::of(&graph, &order).unwrap().1.values() as f64;
        let (own, default) =
            (fill(dissect(&ptr, &adj).unwrap()), fill(dissection::dissect(&ptr, &adj).unwrap()));
        assert!(own < 1.25 * default && default < 1.5 * own, "{own}, default {default}");
    }

    #[test]
    fn threads_at_the_same_time_get_the_same_order() {
        let (ptr, adj) = cube(9);
        let expected = dissect(&ptr, &adj).unwrap();
        std::thread::scope(|scope| {
            let runs: Vec<_> = (0..4).map(|_| scope.spawn(|| dissect(&ptr, &adj).unwrap())).collect();
            runs.into_iter().for_each(|run| assert_eq!(run.join().unwrap(), expected));
        });
    }
}
