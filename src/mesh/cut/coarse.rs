//! Coarser graphs: each vertex is merged with the neighbour that shares the most unknowns with it.

use super::graph::Graph;
use super::incidence::{NONE, WHAT};
use crate::error::Result;
use crate::numbers::cut::SHRINKS;
use crate::numbers::linalg::HEAVIEST;
use crate::platform::interrupt;
use crate::platform::memory::{filled, reserved};

/// A graph, and for each vertex its vertex in the next coarser graph; empty for the coarsest.
pub struct Level {
    pub graph: Graph,
    pub coarse: Vec<u32>,
}

/// Coarsens a graph until at most `enough` vertices are left, or no further merging is possible.
pub fn coarsen(graph: Graph, enough: usize) -> Result<Vec<Level>> {
    let most = HEAVIEST * graph.weight.iter().sum::<f64>() / enough as f64;
    let mut levels = vec![Level { graph, coarse: Vec::new() }];
    while let Some(level) = levels.last_mut().filter(|level| level.graph.count() > enough) {
        interrupt::check()?;
        let (coarse, count) = matched(&level.graph, most)?;
        if count as f64 > SHRINKS * level.graph.count() as f64 {
            break;
        }
        let graph = contracted(&level.graph, &coarse, count)?;
        level.coarse = coarse;
        levels.push(Level { graph, coarse: Vec::new() });
    }
    Ok(levels)
}

/// Copies values of the vertices of the coarser graph to the vertices of this graph.
pub fn projected<T: Copy>(values: &[T], coarse: &[u32]) -> Result<Vec<T>> {
    let mut fine = reserved(coarse.len(), WHAT)?;
    fine.extend(coarse.iter().map(|&c| values[c as usize]));
    Ok(fine)
}

/// The pair of every vertex, and the number of pairs. First come neighbours that share the largest part of their
/// unknowns, light before heavy, in the order of the host, whose neighbours tend to be consecutive.
fn matched(graph: &Graph, most: f64) -> Result<(Vec<u32>, usize)> {
    let mut coarse: Vec<u32> = filled(graph.count(), NONE, WHAT)?;
    let mut count = 0;
    for i in 0..graph.count() {
        if coarse[i] != NONE {
            continue;
        }
        let (mut best, mut closest) = (i, 0.0);
        for (j, share) in graph.around(i).filter(|&(j, _)| coarse[j] == NONE) {
            let close = f64::from(share) / graph.weight[j];
            if close > closest && graph.weight[i] + graph.weight[j] <= most {
                (best, closest) = (j, close);
            }
        }
        coarse[i] = count;
        coarse[best] = count;
        count += 1;
    }
    Ok((coarse, count as usize))
}

fn contracted(graph: &Graph, coarse: &[u32], count: usize) -> Result<Graph> {
    let mut members: Vec<[u32; 2]> = filled(count, [NONE; 2], WHAT)?;
    for i in 0..graph.count() {
        let pair = &mut members[coarse[i] as usize];
        pair[usize::from(pair[0] != NONE)] = i as u32;
    }
    let (mut ptr, mut weight) = (reserved(count + 1, WHAT)?, reserved(count, WHAT)?);
    let (mut to, mut edge): (Vec<u32>, Vec<u32>) =
        (reserved(graph.to.len(), WHAT)?, reserved(graph.to.len(), WHAT)?);
    let mut place: Vec<usize> = filled(count, usize::MAX, WHAT)?;
    ptr.push(0);
    for (c, pair) in members.iter().enumerate() {
        let begun = to.len();
        let mut sum = 0.0;
        for &i in pair.iter().filter(|&&i| i != NONE) {
            sum += graph.weight[i as usize];
            for (j, share) in graph.around(i as usize) {
                let d = coarse[j] as usize;
                if d == c {
                    continue;
                }
                if place[d] == usize::MAX || place[d] < begun {
                    place[d] = to.len();
                    to.push(d as u32);
                    edge.push(share);
                } else {
                    edge[place[d]] += share;
                }
            }
        }
        weight.push(sum);
        ptr.push(to.len());
    }
    Ok(Graph { ptr, to, edge, weight })
}
