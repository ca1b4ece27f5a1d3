//! Coarser graphs: pairs of neighbours with heavy edges are merged to one vertex (Karypis-Kumar (METIS), Section 3.1).

use super::{Weighted, NONE, WHAT};
use crate::error::Result;
use crate::linalg::random::Random;
use crate::numbers::linalg::SHRINKS;
use crate::platform::interrupt;
use crate::platform::memory::{filled, reserved};

/// A coarser graph, and its vertex for every vertex of the finer graph.
pub struct Level {
    pub graph: Weighted,
    pub coarse: Vec<u32>,
}

/// Successively coarser graphs, until one has at most `few` vertices, or pairs become rare. No merged vertex is heavier
/// than `heaviest`. Vertices are visited in random order, without `random` in their own.
pub fn levels(
    graph: &Weighted,
    few: usize,
    heaviest: f64,
    mut random: Option<&mut Random>,
) -> Result<Vec<Level>> {
    let mut levels: Vec<Level> = Vec::new();
    loop {
        interrupt::check()?;
        let fine = coarsest(graph, &levels);
        if fine.count() <= few {
            return Ok(levels);
        }
        let level = contracted(fine, &pairs(fine, heaviest, random.as_deref_mut())?)?;
        if level.graph.count() as f64 > SHRINKS * fine.count() as f64 {
            return Ok(levels);
        }
        levels.push(level);
    }
}

/// The last of the levels of a graph, or the graph itself.
pub fn coarsest<'a>(graph: &'a Weighted, levels: &'a [Level]) -> &'a Weighted {
    levels.last().map_or(graph, |level| &level.graph)
}

/// Takes labels of the coarsest vertices to the graph; `improved` changes them on each finer graph.
pub fn refined<L: Copy, T: AsRef<[L]>>(
    graph: &Weighted,
    levels: &[Level],
    coarsest: T,
    mut improved: impl FnMut(&Weighted, Vec<L>) -> Result<T>,
) -> Result<T> {
    let mut found = coarsest;
    for (k, level) in levels.iter().enumerate().rev() {
        let mut fine = reserved(level.coarse.len(), WHAT)?;
        fine.extend(level.coarse.iter().map(|&c| found.as_ref()[c as usize]));
        found = improved(self::coarsest(graph, &levels[..k]), fine)?;
    }
    Ok(found)
}

/// The partner of every vertex, itself if none is available: the neighbour with the largest weight of the edge relative to
/// that of the vertex.
fn pairs(graph: &Weighted, heaviest: f64, random: Option<&mut Random>) -> Result<Vec<u32>> {
    let n = graph.count();
    let mut partner = filled(n, NONE, WHAT)?;
    for v in visited(graph, random)? {
        let v = v as usize;
        if partner[v] != NONE {
            continue;
        }
        let (mut best, mut closest) = (v, 0.0);
        for (u, edge) in graph.around(v).filter(|&(u, _)| partner[u] == NONE) {
            let close = f64::from(edge) / graph.weight[u];
            if close > closest && graph.weight[v] + graph.weight[u] <= heaviest {
                (best, closest) = (u, close);
            }
        }
        partner[v] = best as u32;
        partner[best] = v as u32;
    }
    let alone = (0..n).filter(|&v| partner[v] as usize == v).count();
    if 10 * alone > 3 * n {
        pair_neighbours_of_one(graph, heaviest, &mut partner);
    }
    Ok(partner)
}

/// All vertices; in random order those with few neighbours come first, since they have fewer possible partners.
fn visited(graph: &Weighted, random: Option<&mut Random>) -> Result<Vec<u32>> {
    let n = graph.count();
    let mut order: Vec<u32> = reserved(n, WHAT)?;
    order.extend(0..n as u32);
    if let Some(random) = random {
        (1..n).rev().for_each(|k| order.swap(k, random.below(k + 1)));
        order.sort_by_key(|&v| graph.range(v as usize).len());
    }
    Ok(order)
}

/// Pairs vertices without partner if they have a common neighbour, as around a hub.
fn pair_neighbours_of_one(graph: &Weighted, heaviest: f64, partner: &mut [u32]) {
    for hub in 0..graph.count() {
        let mut open: Option<usize> = None;
        for v in graph.neighbours(hub) {
            if partner[v] as usize != v {
                continue;
            }
            open = match open {
                Some(u) if graph.weight[u] + graph.weight[v] <= heaviest => {
                    (partner[u], partner[v]) = (v as u32, u as u32);
                    None
                }
                _ => Some(v),
            };
        }
    }
}

/// The graph of the pairs.
fn contracted(fine: &Weighted, partner: &[u32]) -> Result<Level> {
    let n = fine.count();
    let (mut coarse, mut first) = (filled(n, NONE, WHAT)?, reserved(n, WHAT)?);
    for v in 0..n {
        if coarse[v] == NONE {
            coarse[v] = first.len() as u32;
            coarse[partner[v] as usize] = coarse[v];
            first.push(v);
        }
    }
    let mut graph = Weighted::with_room(first.len(), fine.adj.len())?;
    // 1 + the position of the last edge to each coarse vertex
    let mut put = filled(first.len(), 0, WHAT)?;
    for (own, &v) in first.iter().enumerate() {
        let (begun, other) = (graph.adj.len(), partner[v] as usize);
        let mut weight = 0.0;
        for v in [v, other].into_iter().take(if other == v { 1 } else { 2 }) {
            weight += fine.weight[v];
            for (u, edge) in fine.around(v).filter(|&(u, _)| coarse[u] as usize != own) {
                let at = &mut put[coarse[u] as usize];
                if *at > begun {
                    graph.edge[*at - 1] += edge;
                } else {
                    graph.adj.push(coarse[u]);
                    graph.edge.push(edge);
                    *at = graph.adj.len();
                }
            }
        }
        graph.weight.push(weight);
        graph.ptr.push(graph.adj.len());
    }
    graph.adj.shrink_to_fit();
    graph.edge.shrink_to_fit();
    Ok(Level { graph, coarse })
}
