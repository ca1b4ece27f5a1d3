//! Cuts a graph into two connected parts of given weights with few shared unknowns: it is coarsened by matching, cut when
//! it is small, and the cut is refined on each finer graph (Karypis and Kumar 1998).

use std::collections::BinaryHeap;

use super::coarse::{coarsen, projected};
use super::graph::Graph;
use super::incidence::WHAT;
use crate::error::Result;
use crate::numbers::cut::{SLACK, SLACK_BY_ELEMENT};
use crate::platform::interrupt;
use crate::platform::memory::filled;

/// A graph with at most this number of vertices is cut directly.
const SMALL: usize = 100;
/// Number of start vertices tried.
const TRIALS: usize = 12;
/// A round ends after this number of moves without a better cut.
const PATIENCE: usize = 100;
const ROUNDS: usize = 4;

/// For each vertex whether it is in the second part; the first part has about `fraction` of the weight.
pub fn halves(graph: Graph, fraction: f64) -> Result<Vec<bool>> {
    let levels = coarsen(graph, SMALL)?;
    let mut side = Vec::new();
    for (at, level) in levels.iter().enumerate().rev() {
        interrupt::check()?;
        if at + 1 == levels.len() {
            side = from_scratch(&level.graph, fraction)?;
        } else {
            side = projected(&side, &level.coarse)?;
            Refinement::of(&level.graph, &mut side, fraction)?.run();
        }
    }
    Ok(side)
}

fn from_scratch(graph: &Graph, fraction: f64) -> Result<Vec<bool>> {
    let (mut best, mut least) = (Vec::new(), (f64::INFINITY, i64::MAX));
    let trials = graph.count().min(TRIALS);
    for trial in 0..trials {
        let mut side = grown(graph, trial * graph.count() / trials, fraction)?;
        let mut refinement = Refinement::of(graph, &mut side, fraction)?;
        refinement.run();
        let found = (refinement.excess(), refinement.cut());
        if found < least {
            (best, least) = (side, found);
        }
    }
    Ok(best)
}

/// Grows the first part from a start vertex, each time by the vertex that increases the cut least.
fn grown(graph: &Graph, start: usize, fraction: f64) -> Result<Vec<bool>> {
    let mut side = filled(graph.count(), true, WHAT)?;
    let mut gain: Vec<i64> = filled(graph.count(), 0, WHAT)?;
    let goal = fraction * graph.weight.iter().sum::<f64>();
    let (mut weight, mut next) = (0.0, start);
    loop {
        weight += graph.weight[next];
        side[next] = false;
        for (j, share) in graph.around(next) {
            gain[j] += i64::from(share);
        }
        let total = |i: usize| graph.around(i).map(|(_, share)| i64::from(share)).sum::<i64>();
        let free = (0..graph.count()).filter(|&i| side[i]);
        let Some(best) = free.max_by_key(|&i| (gain[i] > 0, 2 * gain[i] - total(i))) else { break };
        if weight + 0.5 * graph.weight[best] > goal {
            break;
        }
        next = best;
    }
    Ok(side)
}

/// Moves of single vertices, the best first, including moves that make the cut worse for a time (Fiduccia and Mattheyses
/// 1982).
struct Refinement<'a> {
    graph: &'a Graph,
    side: &'a mut [bool],
    gain: Vec<i64>,
    moved: Vec<bool>,
    /// Weight of the first part, and its target.
    weight: f64,
    goal: f64,
    slack: f64,
}

impl<'a> Refinement<'a> {
    fn of(graph: &'a Graph, side: &'a mut [bool], fraction: f64) -> Result<Self> {
        let total: f64 = graph.weight.iter().sum();
        let weight = (0..graph.count()).filter(|&i| !side[i]).map(|i| graph.weight[i]).sum();
        let largest = graph.weight.iter().copied().fold(0.0, f64::max);
        let slack = (SLACK * total * fraction.min(1.0 - fraction)).max(SLACK_BY_ELEMENT * largest);
        let (gain, moved) = (filled(graph.count(), 0, WHAT)?, filled(graph.count(), false, WHAT)?);
        Ok(Self { graph, side, gain, moved, weight, goal: fraction * total, slack })
    }

    fn run(&mut self) {
        for _ in 0..ROUNDS {
            if !self.round() {
                break;
            }
        }
    }

    /// By how much the deviation from the target weight exceeds the permitted deviation.
    fn excess(&self) -> f64 {
        ((self.weight - self.goal).abs() - self.slack).max(0.0)
    }

    fn cut(&self) -> i64 {
        let across = |i: usize| self.graph.around(i).filter(move |&(j, _)| self.side[i] != self.side[j]);
        (0..self.graph.count()).flat_map(across).map(|(_, share)| i64::from(share)).sum()
    }

    fn gain(&self, i: usize) -> (i64, bool) {
        let (mut gain, mut outside) = (0, false);
        for (j, share) in self.graph.around(i) {
            outside |= self.side[j] != self.side[i];
            gain += if self.side[j] == self.side[i] { -i64::from(share) } else { i64::from(share) };
        }
        (gain, outside)
    }

    fn flip(&mut self, i: usize) {
        let weight = self.graph.weight[i];
        self.weight += if self.side[i] { weight } else { -weight };
        self.side[i] = !self.side[i];
    }

    /// Whether the cut or the weights improved.
    fn round(&mut self) -> bool {
        // among equal gains the latest is first: moves continue near the previous one
        let mut heap = BinaryHeap::new();
        let mut pushed = self.graph.count();
        for i in 0..self.graph.count() {
            let (gain, outside) = self.gain(i);
            self.gain[i] = gain;
            self.moved[i] = false;
            if outside {
                heap.push((gain, heap.len(), i as u32));
            }
        }
        let (mut moves, mut kept): (Vec<usize>, usize) = (Vec::new(), 0);
        let (mut cut, mut best) = (0_i64, (self.excess(), 0_i64));
        while let Some((gain, _, i)) = heap.pop() {
            let i = i as usize;
            if self.moved[i] || gain != self.gain[i] || !self.may_move(i) {
                continue;
            }
            self.flip(i);
            self.moved[i] = true;
            moves.push(i);
            cut -= gain;
            for (j, share) in self.graph.around(i) {
                if !self.moved[j] {
                    let change = 2 * i64::from(share);
                    self.gain[j] += if self.side[j] == self.side[i] { -change } else { change };
                    heap.push((self.gain[j], pushed, j as u32));
                    pushed += 1;
                }
            }
            if (self.excess(), cut) < best {
                (best, kept) = ((self.excess(), cut), moves.len());
            }
            if moves.len() > kept + PATIENCE {
                break;
            }
        }
        moves[kept..].iter().for_each(|&i| self.flip(i));
        kept > 0
    }

    /// From the side that is too heavy, or from either side if the weights are near the target.
    fn may_move(&self, i: usize) -> bool {
        let weight = if self.side[i] { self.graph.weight[i] } else { -self.graph.weight[i] };
        let (before, after) = ((self.weight - self.goal).abs(), (self.weight + weight - self.goal).abs());
        after <= self.slack || after < before
    }
}
