//! Cuts a graph into two connected parts of given weights with few shared unknowns: it is coarsened by matching, cut when
//! it is small, and the cut is refined on each finer graph (Karypis and Kumar 1998).

use crate::error::Result;
use crate::linalg::partition::bisection::{bisected, improved, Target};
use crate::linalg::partition::levels::{coarsest, levels, refined, Level};
use crate::linalg::partition::Weighted;
use crate::numbers::cut::{SLACK, SLACK_BY_ELEMENT};
use crate::numbers::linalg::HEAVIEST;

/// A graph with at most this number of vertices is cut directly.
const SMALL: usize = 100;
/// Number of start vertices tried.
const TRIALS: usize = 12;
/// A round ends after this number of moves without a better cut.
const PATIENCE: usize = 100;

/// For each vertex 0 or 1: part 0 has about `fraction` of the weight.
pub fn halves(graph: &Weighted, fraction: f64) -> Result<Vec<u8>> {
    let levels = coarser(graph, SMALL)?;
    let coarse = coarsest(graph, &levels);
    let first = bisected(coarse, target(coarse, fraction), TRIALS)?;
    refined(graph, &levels, first, |graph, side| improved(graph, target(graph, fraction), side))
}

/// Coarser graphs, down to about `few` vertices, none much heavier than others.
pub fn coarser(graph: &Weighted, few: usize) -> Result<Vec<Level>> {
    levels(graph, few, HEAVIEST * graph.total() / few as f64, None)
}

fn target(graph: &Weighted, fraction: f64) -> Target {
    let total = graph.total();
    let largest = graph.weight.iter().copied().fold(0.0, f64::max);
    let slack = (SLACK * total * fraction.min(1.0 - fraction)).max(SLACK_BY_ELEMENT * largest);
    Target { goal: fraction * total, slack, patience: PATIENCE }
}
