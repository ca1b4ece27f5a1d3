//! Two halves of a small graph with few edges between them: grown from a node, improved by the method of Fiduccia and
//! Mattheyses.

use std::collections::BinaryHeap;

use super::weighted::Weighted;
use crate::linalg::random::Random;

/// Number of moves continued beyond the best state.
const CLIMB: usize = 300;
const PASSES: usize = 8;

pub struct Bisection<'a> {
    graph: &'a Weighted,
    /// 0 or 1 for every node.
    side: Vec<u8>,
    weight: [i32; 2],
    /// Weight of the edges between the sides.
    pub cut: i32,
    /// Reduction of the cut if a node changes sides.
    gain: Vec<i32>,
    /// Candidates to leave each side, by an earlier gain; the present gain may be smaller.
    queue: [BinaryHeap<(i32, u32)>; 2],
    moved: Vec<bool>,
}

impl<'a> Bisection<'a> {
    /// Side 0 grows from a random node until it has half of the weight; no side exceeds `most`.
    pub fn grown(graph: &'a Weighted, most: i32, random: &mut Random) -> Self {
        let n = graph.count();
        let mut bisection = Self {
            graph,
            side: vec![1; n],
            weight: [0, graph.total()],
            cut: 0,
            gain: (0..n).map(|v| -graph.edge[graph.range(v)].iter().sum::<i32>()).collect(),
            queue: Default::default(),
            moved: vec![false; n],
        };
        while bisection.weight[0] < bisection.weight[1] {
            let next = bisection.first(1).or_else(|| bisection.unreached(random.below(n)));
            let Some(v) = next else { break };
            bisection.change(v, true);
        }
        (0..PASSES).find(|_| !bisection.improves(most));
        bisection
    }

    /// The first node of side 1 from `start` on.
    fn unreached(&self, start: usize) -> Option<usize> {
        (start..self.side.len()).chain(0..start).find(|&v| self.side[v] == 1)
    }

    /// The node of a side with the largest gain.
    fn first(&mut self, side: usize) -> Option<usize> {
        while let Some(&(gain, v)) = self.queue[side].peek() {
            let own = v as usize;
            let counts = self.side[own] as usize == side && !self.moved[own];
            if counts && gain == self.gain[own] {
                return Some(own);
            }
            self.queue[side].pop();
            if counts && gain > self.gain[own] {
                self.queue[side].push((self.gain[own], v));
            }
        }
        None
    }

    /// Moves a node to the other side; if `queued`, its former neighbours become candidates.
    fn change(&mut self, v: usize, queued: bool) {
        let (graph, from) = (self.graph, self.side[v] as usize);
        self.side[v] = 1 - from as u8;
        self.weight[from] -= graph.node[v];
        self.weight[1 - from] += graph.node[v];
        self.cut -= self.gain[v];
        self.gain[v] = -self.gain[v];
        for k in graph.range(v) {
            let u = graph.adj[k] as usize;
            if self.side[u] as usize != from {
                self.gain[u] -= 2 * graph.edge[k];
                continue;
            }
            self.gain[u] += 2 * graph.edge[k];
            if queued && !self.moved[u] {
                self.queue[from].push((self.gain[u], u as u32));
            }
        }
    }

    /// One pass: every node changes sides at most once; keeps the best state. Returns whether it is better than the
    /// first.
    fn improves(&mut self, most: i32) -> bool {
        let graph = self.graph;
        self.queue.iter_mut().for_each(BinaryHeap::clear);
        for v in 0..graph.count() {
            if self.is_at_the_cut(v) {
                self.queue[self.side[v] as usize].push((self.gain[v], v as u32));
            }
        }
        let before = self.quality(most);
        let (mut best, mut kept, mut moves) = (before, 0, Vec::new());
        while moves.len() <= kept + CLIMB {
            let Some(v) = self.next(most) else { break };
            self.moved[v] = true;
            self.change(v, true);
            moves.push(v);
            let reached = self.quality(most);
            if reached < best {
                (best, kept) = (reached, moves.len());
            }
        }
        moves.iter().for_each(|&v| self.moved[v] = false);
        moves.drain(kept..).rev().for_each(|v| self.change(v, false));
        best < before
    }

    /// The node to move: with the largest gain for which both sides stay light enough, or the heavier side becomes
    /// lighter.
    fn next(&mut self, most: i32) -> Option<usize> {
        let [a, b] = [0, 1].map(|side| {
            let v = self.first(side)?;
            let grown = self.weight[1 - side] + self.graph.node[v];
            (grown <= most.max(self.weight[side])).then_some(v)
        });
        let heavier = usize::from(self.weight[1] > self.weight[0]);
        let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
        let side = if self.weight[heavier] > most || self.gain[a] == self.gain[b] {
            heavier
        } else {
            usize::from(self.gain[b] > self.gain[a])
        };
        Some([a, b][side])
    }

    /// Smaller is better: weight above `most`, the cut, the difference of the sides.
    fn quality(&self, most: i32) -> (i32, i32, i32) {
        let [a, b] = self.weight;
        ((a.max(b) - most).max(0), self.cut, (a - b).abs())
    }

    fn is_at_the_cut(&self, v: usize) -> bool {
        self.graph.around(v).any(|u| self.side[u] != self.side[v])
    }

    /// The sides; the lighter of the two rows of nodes along the cut gets the label `between`.
    pub fn with_separator(mut self, between: u8) -> Vec<u8> {
        let row: Vec<usize> = (0..self.graph.count()).filter(|&v| self.is_at_the_cut(v)).collect();
        let mut weight = [0; 2];
        row.iter().for_each(|&v| weight[self.side[v] as usize] += self.graph.node[v]);
        let chosen = match weight[0].cmp(&weight[1]) {
            std::cmp::Ordering::Less => 0,
            std::cmp::Ordering::Greater => 1,
            std::cmp::Ordering::Equal => u8::from(self.weight[1] > self.weight[0]),
        };
        for v in row {
            if self.side[v] == chosen {
                self.side[v] = between;
            }
        }
        self.side
    }
}
