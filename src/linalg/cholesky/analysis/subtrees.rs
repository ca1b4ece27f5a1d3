//! Independent subtrees of an elimination tree, and the work above them that the threads of a pool share.

use std::ops::Range;

use rayon::prelude::*;

use crate::linalg::cholesky::analysis::elimination::NONE;
use crate::linalg::cholesky::analysis::supernodes::Supernodes;
use crate::numbers::linalg::SHARED_WORK;

/// Subtrees per thread, for an even distribution of work.
const SUBTREES: usize = 4;
/// Number of subtrees if it must not depend on the threads.
const PARTS: usize = 16;

/// Whether the threads of the present pool shall share this work.
pub fn shared(work: f64) -> bool {
    work > SHARED_WORK && rayon::current_thread_index().is_some()
}

/// Runs all tasks, in parallel in the present pool or one after the other.
pub fn each<T: Send>(parallel: bool, tasks: Vec<T>, work: impl Fn(T) + Send + Sync) {
    if parallel && tasks.len() > 1 {
        tasks.into_par_iter().for_each(work);
    } else {
        tasks.into_iter().for_each(work);
    }
}

/// Ranges of supernodes in ascending order, without the supernodes above them, which all threads share afterwards; the
/// whole forest outside a pool.
pub fn subtrees(nodes: &Supernodes) -> Vec<Range<usize>> {
    let threads = if rayon::current_thread_index().is_some() { rayon::current_num_threads() } else { 1 };
    let several = if threads > 1 { of_equal_work(nodes, SUBTREES * threads) } else { None };
    several.unwrap_or_else(|| std::iter::once(0..nodes.count()).filter(|all| !all.is_empty()).collect())
}

/// Subtrees independent of the number of threads; none if there is little work.
pub fn parts(nodes: &Supernodes) -> Vec<Range<usize>> {
    of_equal_work(nodes, PARTS).unwrap_or_default()
}

/// Supernodes outside all subtrees.
pub fn outside<'a>(
    nodes: &Supernodes,
    subtrees: &'a [Range<usize>],
) -> impl Iterator<Item = usize> + Clone + 'a {
    let starts = subtrees.iter().map(|range| range.start).chain([nodes.count()]);
    let ends = [0].into_iter().chain(subtrees.iter().map(|range| range.end));
    ends.zip(starts).flat_map(|(end, start)| end..start)
}

/// About `count` subtrees: the largest with no more work than their share; `None` if they are too small.
fn of_equal_work(nodes: &Supernodes, count: usize) -> Option<Vec<Range<usize>>> {
    let mut work: Vec<f64> = nodes.nodes().map(|node| node.work()).collect();
    let most = work.iter().sum::<f64>() / count as f64;
    if most < SHARED_WORK {
        return None;
    }
    let mut first: Vec<usize> = (0..nodes.count()).collect();
    for s in 0..nodes.count() {
        let parent = nodes.parent(s);
        if parent != NONE {
            first[parent] = first[parent].min(first[s]);
            work[parent] += work[s];
        }
    }
    let small = |s: usize| work[s] <= most;
    let is_root = |s: &usize| small(*s) && (nodes.parent(*s) == NONE || !small(nodes.parent(*s)));
    Some((0..nodes.count()).filter(is_root).map(|s| first[s]..s + 1).collect())
}
