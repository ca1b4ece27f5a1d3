//! A small separator of a graph, found on successively coarser graphs (Karypis-Kumar (METIS)).

use super::separator::Separator;
use crate::error::Result;
use crate::linalg::partition::bisection::{bisected, Target};
use crate::linalg::partition::levels::{coarsest, levels, refined, Level};
use crate::linalg::partition::Weighted;
use crate::linalg::random::Random;
use crate::numbers::linalg::HEAVIEST;

/// Nodes of the coarsest graph: an eighth of those of the graph, within these bounds.
const COARSEST: (usize, usize) = (40, 100);
/// Number of bisections tried on the coarsest graph; fewer if it has fewer nodes.
const TRIALS: usize = 5;
const TRIALS_OF_FEW: usize = 3;
const FEW: usize = 2000;
/// A bisection ends after this number of moves without a better cut: the separator is improved later.
const PATIENCE: usize = 25;
/// Larger graphs are first coarsened to an eighth; from there several runs with different pairs are tried.
const LARGE: usize = 3000;
const RUNS: usize = 4;

/// The best separator found; it depends only on the graph.
pub fn separator(graph: &Weighted) -> Result<Separator> {
    let random = &mut Random::default();
    if graph.count() < LARGE {
        return from_the_coarsest(graph, random);
    }
    let levels = levels(graph, graph.count() / 8, heaviest(graph), Some(random))?;
    let coarse = coarsest(graph, &levels);
    let mut best = from_the_coarsest(coarse, random)?;
    for _ in 1..RUNS {
        let found = from_the_coarsest(coarse, random)?;
        if found.cost() < best.cost() {
            best = found;
        }
    }
    finer(graph, &levels, best)
}

/// Limit of the node weights: a coarse graph with much heavier nodes has no good halves.
fn heaviest(graph: &Weighted) -> f64 {
    HEAVIEST * graph.total() / COARSEST.1 as f64
}

fn from_the_coarsest(graph: &Weighted, random: &mut Random) -> Result<Separator> {
    let few = (graph.count() / 8).clamp(COARSEST.0, COARSEST.1);
    let levels = levels(graph, few, heaviest(graph), Some(random))?;
    let coarse = coarsest(graph, &levels);
    let trials = if graph.count() < FEW { TRIALS_OF_FEW } else { TRIALS };
    let goal = coarse.total() / 2.0;
    let target = Target { goal, slack: Separator::most(coarse) - goal, patience: PATIENCE };
    finer(graph, &levels, Separator::between(coarse, bisected(coarse, target, trials)?).improved(coarse))
}

/// Projects the separator from the coarsest level to the graph and improves it on each level.
fn finer(graph: &Weighted, levels: &[Level], coarsest: Separator) -> Result<Separator> {
    refined(graph, levels, coarsest, |graph, side| Ok(Separator::new(graph, side).improved(graph)))
}
