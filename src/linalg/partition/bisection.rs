//! Two sides of a graph with few edges between them, improved by the method of Fiduccia and Mattheyses: moves of single
//! vertices, the best first, including moves that make the cut worse for a time.

use std::collections::BinaryHeap;

use super::{Weighted, WHAT};
use crate::error::Result;
use crate::platform::memory::filled;

const PASSES: usize = 8;

/// The weight that side 0 shall have, by how much it may deviate, and the number of moves continued beyond the best state.
#[derive(Clone, Copy)]
pub struct Target {
    pub goal: f64,
    pub slack: f64,
    pub patience: usize,
}

/// 0 or 1 for every vertex: the best of several sides 0, each grown from another vertex.
pub fn bisected(graph: &Weighted, target: Target, trials: usize) -> Result<Vec<u8>> {
    let (trials, mut best) = (trials.min(graph.count()), None);
    for trial in 0..trials {
        let found = Bisection::grown(graph, target, trial * graph.count() / trials)?.improved();
        if best.as_ref().is_none_or(|best: &Bisection| found.quality() < best.quality()) {
            best = Some(found);
        }
    }
    Ok(best.map_or_else(Vec::new, |best| best.side))
}

/// The sides after single vertices have moved.
pub fn improved(graph: &Weighted, target: Target, side: Vec<u8>) -> Result<Vec<u8>> {
    Ok(Bisection::of(graph, target, side)?.improved().side)
}

struct Bisection<'a> {
    graph: &'a Weighted,
    target: Target,
    side: Vec<u8>,
    /// Weight of side 0.
    weight: f64,
    /// Weight of the edges between the sides.
    cut: i64,
    /// Reduction of the cut if a vertex changes sides.
    gain: Vec<i64>,
    /// Candidates by their gain, the latest of equal ones first, so that moves continue near the previous one; outdated
    /// entries are skipped.
    queue: BinaryHeap<(i64, u32, u32)>,
    /// Entries of the queue so far in this pass.
    queued: u32,
    moved: Vec<bool>,
}

impl<'a> Bisection<'a> {
    fn of(graph: &'a Weighted, target: Target, side: Vec<u8>) -> Result<Self> {
        let n = graph.count();
        let (mut gain, mut twice) = (filled(n, 0, WHAT)?, 0);
        for v in 0..n {
            for (u, edge) in graph.around(v) {
                let across = side[u] != side[v];
                gain[v] += if across { i64::from(edge) } else { -i64::from(edge) };
                twice += if across { i64::from(edge) } else { 0 };
            }
        }
        let weight = (0..n).filter(|&v| side[v] == 0).map(|v| graph.weight[v]).sum();
        let (queue, moved) = (BinaryHeap::new(), filled(n, false, WHAT)?);
        Ok(Self { graph, target, side, weight, cut: twice / 2, gain, queue, queued: 0, moved })
    }

    /// Side 0 grows from a vertex, each time by the one that increases the cut least.
    fn grown(graph: &'a Weighted, target: Target, start: usize) -> Result<Self> {
        let n = graph.count();
        let mut bisection = Self::of(graph, target, filled(n, 1, WHAT)?)?;
        // where no edge leads on, as in a graph of several parts
        let mut others = (start..n).chain(0..start);
        let mut next = Some(start);
        while let Some(v) = next {
            bisection.change(v, true);
            let reached = bisection.first(|own, v| own.side[v] == 1);
            let found = reached.or_else(|| others.find(|&v| bisection.side[v] == 1));
            next = found.filter(|&v| bisection.weight + 0.5 * graph.weight[v] <= target.goal);
        }
        Ok(bisection)
    }

    fn improved(mut self) -> Self {
        (0..PASSES).find(|_| !self.improves());
        self
    }

    /// One pass: every vertex changes sides at most once; keeps the best state. Returns whether it is better than the
    /// first.
    fn improves(&mut self) -> bool {
        self.queue.clear();
        self.queued = 0;
        for v in 0..self.graph.count() {
            if self.graph.neighbours(v).any(|u| self.side[u] != self.side[v]) {
                self.enqueue(v);
            }
        }
        let before = self.quality();
        let (mut best, mut kept, mut moves) = (before, 0, Vec::new());
        while moves.len() <= kept + self.target.patience {
            let Some(v) = self.first(Self::may_move) else { break };
            self.moved[v] = true;
            self.change(v, true);
            moves.push(v);
            let reached = self.quality();
            if reached < best {
                (best, kept) = (reached, moves.len());
            }
        }
        moves.iter().for_each(|&v| self.moved[v] = false);
        moves.drain(kept..).rev().for_each(|v| self.change(v, false));
        best < before
    }

    /// Smaller is better: the deviation beyond the permitted one, the cut.
    fn quality(&self) -> (f64, i64) {
        let deviation = (self.weight - self.target.goal).abs();
        ((deviation - self.target.slack).max(0.0), self.cut)
    }

    /// The candidate with the largest gain.
    fn first(&mut self, counts: impl Fn(&Self, usize) -> bool) -> Option<usize> {
        while let Some((gain, _, v)) = self.queue.pop() {
            let v = v as usize;
            if self.moved[v] || gain < self.gain[v] {
                continue;
            }
            if gain > self.gain[v] {
                self.enqueue(v);
            } else if counts(self, v) {
                return Some(v);
            }
        }
        None
    }

    /// From the side that is too heavy, or from either side if the weights are near the target.
    fn may_move(&self, v: usize) -> bool {
        let after = (self.weight_after(v) - self.target.goal).abs();
        after <= self.target.slack || after < (self.weight - self.target.goal).abs()
    }

    /// Weight of side 0 if a vertex changes sides.
    fn weight_after(&self, v: usize) -> f64 {
        if self.side[v] == 0 {
            self.weight - self.graph.weight[v]
        } else {
            self.weight + self.graph.weight[v]
        }
    }

    fn enqueue(&mut self, v: usize) {
        self.queue.push((self.gain[v], self.queued, v as u32));
        self.queued += 1;
    }

    /// Moves a vertex to the other side; if `queued`, its neighbours become candidates.
    fn change(&mut self, v: usize, queued: bool) {
        let graph = self.graph;
        self.weight = self.weight_after(v);
        self.side[v] = 1 - self.side[v];
        self.cut -= self.gain[v];
        self.gain[v] = -self.gain[v];
        for (u, edge) in graph.around(v) {
            let change = 2 * i64::from(edge);
            if self.side[u] == self.side[v] {
                self.gain[u] -= change;
                continue;
            }
            self.gain[u] += change;
            if queued && !self.moved[u] {
                self.enqueue(u);
            }
        }
    }
}
