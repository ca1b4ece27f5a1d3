//! Coarser graphs: pairs of neighbours with heavy edges are merged to one node (Karypis-Kumar (METIS), Section 3.1).

use super::weighted::Weighted;
use crate::linalg::random::Random;

const NONE: u32 = u32::MAX;

/// A coarser graph, and the coarse node of every node of the finer graph.
pub struct Level {
    pub graph: Weighted,
    pub node: Vec<u32>,
}

/// Successively coarser graphs, until one has at most `few` nodes, or pairs become rare. No merged node is heavier than
/// `heaviest`.
pub fn levels(graph: &Weighted, few: usize, heaviest: i32, random: &mut Random) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    loop {
        let fine = levels.last().map_or(graph, |level| &level.graph);
        if fine.count() <= few {
            return levels;
        }
        let level = contracted(fine, &pairs(fine, heaviest, random));
        if 20 * level.graph.count() > 19 * fine.count() {
            return levels;
        }
        levels.push(level);
    }
}

/// The partner of every node, itself if none is available: the neighbour with the largest weight of the edge relative to
/// that of the node.
fn pairs(graph: &Weighted, heaviest: i32, random: &mut Random) -> Vec<u32> {
    let n = graph.count();
    let mut partner = vec![NONE; n];
    for v in visited(graph, random) {
        let v = v as usize;
        if partner[v] != NONE {
            continue;
        }
        // the best partner so far, the weight of its edge, and its own weight
        let (mut best, mut edge, mut node) = (v as u32, -1, 1);
        for k in graph.range(v) {
            let u = graph.adj[k] as usize;
            if partner[u] == NONE && graph.node[v] + graph.node[u] <= heaviest {
                let [against, rated] = [(edge, graph.node[u]), (graph.edge[k], node)].map(product);
                if rated > against {
                    (best, edge, node) = (u as u32, graph.edge[k], graph.node[u]);
                }
            }
        }
        partner[v] = best;
        partner[best as usize] = v as u32;
    }
    let alone = (0..n).filter(|&v| partner[v] as usize == v).count();
    if 10 * alone > 3 * n {
        pair_neighbours_of_one(graph, heaviest, &mut partner);
    }
    partner
}

fn product((a, b): (i32, i32)) -> i64 {
    i64::from(a) * i64::from(b)
}

/// All nodes in random order, nodes with few neighbours first, since they have fewer possible partners.
fn visited(graph: &Weighted, random: &mut Random) -> Vec<u32> {
    let n = graph.count();
    let mut order: Vec<u32> = (0..n as u32).collect();
    (1..n).rev().for_each(|k| order.swap(k, random.below(k + 1)));
    order.sort_by_key(|&v| graph.range(v as usize).len());
    order
}

/// Pairs nodes without partner if they have a common neighbour, as around a hub.
fn pair_neighbours_of_one(graph: &Weighted, heaviest: i32, partner: &mut [u32]) {
    for hub in 0..graph.count() {
        let mut open: Option<usize> = None;
        for v in graph.around(hub) {
            if partner[v] as usize != v {
                continue;
            }
            open = match open {
                Some(u) if graph.node[u] + graph.node[v] <= heaviest => {
                    (partner[u], partner[v]) = (v as u32, u as u32);
                    None
                }
                _ => Some(v),
            };
        }
    }
}

/// The graph of the pairs.
fn contracted(fine: &Weighted, partner: &[u32]) -> Level {
    let n = fine.count();
    let (mut node, mut first) = (vec![NONE; n], Vec::with_capacity(n));
    for v in 0..n {
        if node[v] == NONE {
            node[v] = first.len() as u32;
            node[partner[v] as usize] = node[v];
            first.push(v as u32);
        }
    }
    let mut graph = Weighted::with_room(first.len(), fine.adj.len());
    // 1 + the position of the last edge to each coarse node
    let mut put = vec![0_u32; first.len()];
    for (own, &v) in first.iter().enumerate() {
        let (v, other) = (v as usize, partner[v as usize] as usize);
        let mut weight = 0;
        for v in [v, other].into_iter().take(if other == v { 1 } else { 2 }) {
            weight += fine.node[v];
            for k in fine.range(v) {
                let to = node[fine.adj[k] as usize];
                graph.join(own, to, fine.edge[k], &mut put);
            }
        }
        graph.node.push(weight);
        graph.ptr.push(graph.adj.len() as u32);
    }
    graph.adj.shrink_to_fit();
    graph.edge.shrink_to_fit();
    Level { graph, node }
}

impl Weighted {
    /// Adds an edge to the node `own`, which is the last node.
    fn join(&mut self, own: usize, to: u32, weight: i32, put: &mut [u32]) {
        if to as usize == own {
            return;
        }
        let at = put[to as usize] as usize;
        if at > self.ptr[own] as usize {
            self.edge[at - 1] += weight;
        } else {
            self.adj.push(to);
            self.edge.push(weight);
            put[to as usize] = self.adj.len() as u32;
        }
    }
}
