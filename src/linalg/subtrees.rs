//! Independent subtrees of an elimination tree, for the threads of a pool.

use std::ops::Range;

use crate::linalg::elimination::NONE;
use crate::linalg::supernodes::Supernodes;

/// A supernode or subtree with less work than so many multiplications is not shared among threads.
pub const SHARED: f64 = 2e7;
/// Subtrees for every thread: enough that all of them have as much to do.
const SUBTREES: usize = 4;

/// Ranges of supernodes in ascending order, without the supernodes that all threads share afterwards; the whole forest
/// outside a pool.
pub fn subtrees(nodes: &Supernodes) -> Vec<Range<usize>> {
    let threads = if rayon::current_thread_index().is_some() { rayon::current_num_threads() } else { 1 };
    let whole: f64 = nodes.nodes().map(|node| node.work()).sum();
    let small = whole / (SUBTREES * threads) as f64;
    if threads < 2 || whole < SHARED * (SUBTREES * threads) as f64 {
        return vec![0..nodes.count(); 1];
    }
    let mut first: Vec<usize> = (0..nodes.count()).collect();
    let mut work: Vec<f64> = nodes.nodes().map(|node| node.work()).collect();
    for s in 0..nodes.count() {
        let parent = nodes.parent(s);
        if parent != NONE {
            first[parent] = first[parent].min(first[s]);
            work[parent] += work[s];
        }
    }
    // A subtree is taken whole when it is small and its parent's is not.
    let taken = |s: usize| work[s] <= small;
    let is_root = |s: &usize| taken(*s) && (nodes.parent(*s) == NONE || !taken(nodes.parent(*s)));
    (0..nodes.count()).filter(is_root).map(|s| first[s]..s + 1).collect()
}
