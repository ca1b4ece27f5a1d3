//! A separator between two sides of a graph, reduced by sweeps: one side advances, node by node, into the other.
//!
//! A separator of a solid cannot be improved locally: a plane that is tilted, or one layer off, becomes better only after
//! all of it has moved. Therefore a sweep goes in one direction (Karypis-Kumar (METIS), the refinement of METIS_NodeND),
//! for as many moves as a whole layer has nodes; if both sides advanced in turns, every node would move back and forth.

use std::collections::BinaryHeap;

use crate::linalg::partition::Weighted;
use crate::numbers::linalg::IMBALANCE;

/// The label of a node of the separator.
pub const BETWEEN: u8 = 2;
const SWEEPS: usize = 16;

pub struct Separator {
    /// 0, 1 or `BETWEEN` for every node.
    pub side: Vec<u8>,
    /// Weights of both sides and of the separator.
    pub weight: [f64; 3],
}

impl Separator {
    pub fn new(graph: &Weighted, side: Vec<u8>) -> Self {
        let mut weight = [0.0; 3];
        side.iter().zip(&graph.weight).for_each(|(&side, node)| weight[side as usize] += node);
        Self { side, weight }
    }

    /// Smaller is better: the weight of the separator, slightly increased by the difference of the sides.
    pub fn cost(&self) -> f64 {
        let [a, b, between] = self.weight;
        let difference = (a - b) / (a + b + 1.0);
        between * (1.0 + difference * difference)
    }

    /// The lighter of the two rows of nodes along the cut between the sides 0 and 1.
    pub fn between(graph: &Weighted, mut side: Vec<u8>) -> Self {
        let halves = Self::new(graph, side.clone()).weight;
        let is_at_the_cut = |&v: &usize| graph.neighbours(v).any(|u| side[u] != side[v]);
        let row: Vec<usize> = (0..graph.count()).filter(is_at_the_cut).collect();
        let mut weight = [0.0; 2];
        row.iter().for_each(|&v| weight[side[v] as usize] += graph.weight[v]);
        // of equal rows that on the heavier side
        let chosen = u8::from((weight[1], halves[0]) < (weight[0], halves[1]));
        for v in row {
            if side[v] == chosen {
                side[v] = BETWEEN;
            }
        }
        Self::new(graph, side)
    }

    /// Limit of the weight of a side of `graph`.
    pub fn most(graph: &Weighted) -> f64 {
        (IMBALANCE * graph.total() / 2.0).ceil()
    }

    /// Sweeps alternately to either side, until none improves the separator.
    pub fn improved(self, graph: &Weighted) -> Self {
        let between = (0..graph.count() as u32).filter(|&v| self.side[v as usize] == BETWEEN).collect();
        let mut sweeps = Sweeps {
            most: Self::most(graph),
            graph,
            between,
            beyond: vec![0.0; graph.count()],
            moved: vec![false; graph.count()],
            queue: BinaryHeap::new(),
            moves: Vec::new(),
            joined: Vec::new(),
            found: self,
        };
        let mut to = usize::from(sweeps.found.weight[0] > sweeps.found.weight[1]);
        let mut in_vain = 0;
        for _ in 0..SWEEPS {
            in_vain = if sweeps.improves(to) { 0 } else { in_vain + 1 };
            if in_vain == 2 {
                break;
            }
            to = 1 - to;
        }
        sweeps.found
    }
}

struct Sweeps<'a> {
    graph: &'a Weighted,
    most: f64,
    found: Separator,
    /// Nodes of the separator.
    between: Vec<u32>,
    /// For each node of the separator, the weight of its neighbours on the side that retreats.
    beyond: Vec<f64>,
    moved: Vec<bool>,
    /// Nodes of the separator by its reduction when they leave it; outdated entries are skipped.
    queue: BinaryHeap<(i32, u32)>,
    /// Nodes that left the separator, each with the previous length of `joined`.
    moves: Vec<(u32, usize)>,
    /// Nodes that joined the separator.
    joined: Vec<u32>,
}

impl Sweeps<'_> {
    /// One sweep: side `to` advances; keeps the best state. Returns whether it is better than the first.
    fn improves(&mut self, to: usize) -> bool {
        self.queue.clear();
        self.moves.clear();
        self.joined.clear();
        for k in 0..self.between.len() {
            self.measure(self.between[k] as usize, to);
        }
        let layer = 2 * self.between.len() + 30;
        let before = self.quality();
        let (mut best, mut kept) = (before, 0);
        while self.moves.len() <= kept + layer {
            let Some(v) = self.next() else { break };
            if self.found.weight[to] + self.graph.weight[v] > self.most {
                break;
            }
            self.advance(v, to);
            let reached = self.quality();
            if reached < best {
                (best, kept) = (reached, self.moves.len());
            }
        }
        self.moves.iter().for_each(|&(v, _)| self.moved[v as usize] = false);
        self.between.extend(&self.joined);
        self.take_back(kept, to);
        self.between.retain(|&v| self.found.side[v as usize] == BETWEEN);
        self.between.sort_unstable();
        self.between.dedup();
        best < before
    }

    /// Smaller is better.
    fn quality(&self) -> (f64, f64) {
        let [a, b, _] = self.found.weight;
        ((a.max(b) - self.most).max(0.0), self.found.cost())
    }

    fn next(&mut self) -> Option<usize> {
        while let Some((gain, v)) = self.queue.pop() {
            let v = v as usize;
            if self.found.side[v] == BETWEEN && !self.moved[v] && gain == self.gain(v) {
                return Some(v);
            }
        }
        None
    }

    /// Reduction of the separator if a node leaves it, a whole number like the weights of all nodes.
    fn gain(&self, v: usize) -> i32 {
        (self.graph.weight[v] - self.beyond[v]) as i32
    }

    fn enqueue(&mut self, v: usize) {
        if !self.moved[v] {
            self.queue.push((self.gain(v), v as u32));
        }
    }

    /// Recomputes `beyond` of a node of the separator.
    fn measure(&mut self, v: usize, to: usize) {
        let (graph, retreating) = (self.graph, 1 - to as u8);
        let neighbours = graph.neighbours(v).filter(|&u| self.found.side[u] == retreating);
        self.beyond[v] = neighbours.map(|u| graph.weight[u]).sum();
        self.enqueue(v);
    }

    /// Moves a node of the separator to side `to`; its neighbours on the other side join the separator.
    fn advance(&mut self, v: usize, to: usize) {
        let (graph, retreating) = (self.graph, 1 - to);
        let begin = self.joined.len();
        self.moves.push((v as u32, begin));
        self.moved[v] = true;
        self.found.give(graph.weight[v], BETWEEN as usize, to);
        self.found.side[v] = to as u8;
        for u in graph.neighbours(v) {
            if self.found.side[u] as usize == retreating {
                self.found.side[u] = BETWEEN;
                self.found.give(graph.weight[u], retreating, BETWEEN as usize);
                self.joined.push(u as u32);
            }
        }
        for k in begin..self.joined.len() {
            let u = self.joined[k] as usize;
            for w in graph.neighbours(u) {
                if self.found.side[w] == BETWEEN {
                    self.beyond[w] -= graph.weight[u];
                    self.enqueue(w);
                }
            }
        }
        // nodes that have just joined had no valid `beyond`: the updates of the loop above do not apply to them
        for k in begin..self.joined.len() {
            self.measure(self.joined[k] as usize, to);
        }
    }

    /// Undoes all moves except the first `kept`.
    fn take_back(&mut self, kept: usize, to: usize) {
        let graph = self.graph;
        for (v, begin) in self.moves.drain(kept..).rev() {
            self.found.side[v as usize] = BETWEEN;
            self.found.give(graph.weight[v as usize], to, BETWEEN as usize);
            for u in self.joined.drain(begin..) {
                self.found.side[u as usize] = 1 - to as u8;
                self.found.give(graph.weight[u as usize], BETWEEN as usize, 1 - to);
            }
        }
    }
}

impl Separator {
    fn give(&mut self, weight: f64, from: usize, to: usize) {
        self.weight[from] -= weight;
        self.weight[to] += weight;
    }
}

impl AsRef<[u8]> for Separator {
    fn as_ref(&self) -> &[u8] {
        &self.side
    }
}
