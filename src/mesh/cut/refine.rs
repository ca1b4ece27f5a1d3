//! Moves single elements to a neighbouring piece while this reduces the shared unknowns, or makes the pieces more equal.

use super::incidence::{Incidence, NONE, WHAT};
use crate::error::Result;
use crate::linalg::partition::Weighted;
use crate::numbers::cut::{FULL, OVERFULL};
use crate::platform::interrupt;
use crate::platform::memory::filled;

const ROUNDS: usize = 8;

struct Refinement<'a> {
    incidence: &'a Incidence,
    graph: &'a Weighted,
    piece: &'a mut [u32],
    /// Unknowns of each piece.
    size: Vec<i64>,
    mean: f64,
    /// The element need not be examined: nothing around it has changed since it was found to be in the best piece.
    settled: Vec<bool>,
    /// Work array of `stays_connected`: the number of the search that last reached each element.
    met: Vec<u32>,
    question: u32,
    around: Vec<u32>,
}

pub fn refine(incidence: &Incidence, graph: &Weighted, piece: &mut [u32], count: usize) -> Result<()> {
    let (size, met) = (filled(count, 0, WHAT)?, filled(piece.len(), 0, WHAT)?);
    let (mean, settled, around) = (0.0, filled(piece.len(), false, WHAT)?, Vec::new());
    let mut refinement =
        Refinement { incidence, graph, piece, size, mean, settled, met, question: 0, around };
    refinement.measure();
    for _ in 0..ROUNDS {
        let mut moves = 0;
        for e in 0..graph.count() {
            if e % 4096 == 0 {
                interrupt::check()?;
            }
            if !refinement.settled[e] {
                let moved = refinement.improve(e);
                refinement.settled[e] = !moved;
                moves += usize::from(moved);
            }
        }
        if moves == 0 {
            break;
        }
    }
    Ok(())
}

impl Refinement<'_> {
    /// Computes the unknowns of the pieces.
    fn measure(&mut self) {
        let mut pieces: Vec<u32> = Vec::new();
        for n in 0..self.incidence.weight.len() as u32 {
            pieces.clear();
            pieces.extend(self.incidence.elements(n).iter().map(|&e| self.piece[e as usize]));
            pieces.sort_unstable();
            pieces.dedup();
            let weight = i64::from(self.incidence.weight[n as usize]);
            pieces.iter().for_each(|&p| self.size[p as usize] += weight);
        }
        self.mean = self.size.iter().sum::<i64>() as f64 / self.size.len().max(1) as f64;
    }

    /// Moves the element to the best other piece with which it shares a face, if there is one; returns whether it moved.
    fn improve(&mut self, e: usize) -> bool {
        let from = self.piece[e];
        let overfull = self.size[from as usize] as f64 > OVERFULL * self.mean;
        let mut best: Option<(i64, u32, i64, i64)> = None;
        let mut tried = NONE;
        for (f, _) in self.graph.around(e) {
            let to = self.piece[f];
            if to == from || to == tried {
                continue;
            }
            tried = to;
            let (leaves, comes) = self.changes(e, to);
            let after = self.size[to as usize] + comes;
            let room =
                (after as f64) < FULL * self.mean || overfull && after < self.size[from as usize] - leaves;
            let evens = after < self.size[from as usize];
            let gain = leaves - comes;
            // at most half of its unknowns: the element stands on a face of the other piece and forms no spike
            let overfull = overfull && -2 * gain <= i64::from(self.incidence.size(e));
            if room && (gain > 0 || gain == 0 && evens || overfull) && best.is_none_or(|b| gain > b.0) {
                best = Some((gain, to, leaves, comes));
            }
        }
        match best {
            Some((_, to, leaves, comes)) if self.stays_connected(e) => {
                self.piece[e] = to;
                self.size[from as usize] -= leaves;
                self.size[to as usize] += comes;
                self.unsettle(e);
                true
            }
            _ => false,
        }
    }

    fn unsettle(&mut self, e: usize) {
        for &n in self.incidence.nodes(e) {
            self.incidence.elements(n).iter().for_each(|&f| self.settled[f as usize] = false);
        }
    }

    /// Number of unknowns that the piece of `e` would lose, and number that `to` would gain.
    fn changes(&self, e: usize, to: u32) -> (i64, i64) {
        let (mut leaves, mut comes) = (0, 0);
        for &n in self.incidence.nodes(e) {
            let weight = i64::from(self.incidence.weight[n as usize]);
            let (mut stays, mut there) = (false, false);
            for &f in self.incidence.elements(n) {
                let p = self.piece[f as usize];
                stays |= p == self.piece[e] && f as usize != e;
                there |= p == to;
            }
            leaves += if stays { 0 } else { weight };
            comes += if there { 0 } else { weight };
        }
        (leaves, comes)
    }

    /// Whether the neighbours of `e` in its piece remain connected without `e`, through elements that share a node with
    /// it.
    fn stays_connected(&mut self, e: usize) -> bool {
        let own = self.piece[e];
        // 2 numbers per search: near `e`, and reached
        self.question += 2;
        let (near, reached) = (self.question - 1, self.question);
        for &n in self.incidence.nodes(e) {
            for &f in self.incidence.elements(n).iter().filter(|&&f| self.piece[f as usize] == own) {
                self.met[f as usize] = near;
            }
        }
        self.met[e] = 0;
        let Some((first, _)) = self.graph.around(e).find(|&(f, _)| self.piece[f] == own) else {
            return false;
        };
        self.met[first] = reached;
        self.around.push(first as u32);
        while let Some(i) = self.around.pop() {
            for (j, _) in self.graph.around(i as usize) {
                if self.met[j] == near {
                    self.met[j] = reached;
                    self.around.push(j as u32);
                }
            }
        }
        self.graph.around(e).all(|(f, _)| self.piece[f] != own || self.met[f] == reached)
    }
}
