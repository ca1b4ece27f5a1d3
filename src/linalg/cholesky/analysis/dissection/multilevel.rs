//! A small separator of a graph, found on successively coarser graphs (Karypis-Kumar (METIS)).

use super::bisection::Bisection;
use super::coarsening::{levels, Level};
use super::separator::{Separator, BETWEEN};
use super::weighted::Weighted;
use crate::linalg::random::Random;
use crate::numbers::linalg::HEAVIEST;

/// Nodes of the coarsest graph: an eighth of those of the graph, within these bounds.
const COARSEST: (usize, usize) = (40, 100);
/// Number of bisections tried on the coarsest graph; fewer if it has fewer nodes.
const TRIALS: usize = 5;
const TRIALS_OF_FEW: usize = 3;
const FEW: usize = 2000;
/// Larger graphs are first coarsened to an eighth; from there several runs with different pairs are tried.
const LARGE: usize = 3000;
const RUNS: usize = 4;

/// The best separator found; it depends only on the graph.
pub fn separator(graph: &Weighted) -> Option<Separator> {
    let random = &mut Random::default();
    if graph.count() < LARGE {
        return from_the_coarsest(graph, random);
    }
    let levels = levels(graph, graph.count() / 8, heaviest(graph), random);
    let coarse = levels.last().map_or(graph, |level| &level.graph);
    let found = (0..RUNS).filter_map(|_| from_the_coarsest(coarse, random));
    Some(refined(graph, &levels, found.min_by(|a, b| a.cost().total_cmp(&b.cost()))?))
}

/// Limit of the node weights: a coarse graph with much heavier nodes has no good halves.
fn heaviest(graph: &Weighted) -> i32 {
    (HEAVIEST * f64::from(graph.total()) / COARSEST.1 as f64).ceil() as i32
}

fn from_the_coarsest(graph: &Weighted, random: &mut Random) -> Option<Separator> {
    let few = (graph.count() / 8).clamp(COARSEST.0, COARSEST.1);
    let levels = levels(graph, few, heaviest(graph), random);
    let coarse = levels.last().map_or(graph, |level| &level.graph);
    let trials = if graph.count() < FEW { TRIALS_OF_FEW } else { TRIALS };
    let most = Separator::most(coarse);
    let found = (0..trials).map(|_| Bisection::grown(coarse, most, random)).min_by_key(|found| found.cut)?;
    let coarsest = Separator::new(coarse, found.with_separator(BETWEEN)).improved(coarse);
    Some(refined(graph, &levels, coarsest))
}

/// Projects the separator from the coarsest level to the graph and improves it on each level.
fn refined(graph: &Weighted, levels: &[Level], coarsest: Separator) -> Separator {
    let finer = |k: usize| if k == 0 { graph } else { &levels[k - 1].graph };
    (0..levels.len())
        .rev()
        .fold(coarsest, |found, k| found.on_finer(finer(k), &levels[k].node).improved(finer(k)))
}
