//! The graph of what is cut: elements, or groups of them, that are neighbours by a face.

use std::cmp::Reverse;

use super::incidence::{Incidence, Neighbours, NONE, WHAT};
use crate::error::Result;
use crate::platform::interrupt;
use crate::platform::memory::{filled, reserved};

/// The part of the most unknowns that an element shares with a neighbour from which on it has a face with another. An edge has
/// at most 2/3 of those of a face (linear tetrahedra), a triangle 3/4 of those of a quadrangle (pyramids, wedges).
const FACE: (u32, u32) = (3, 4);

/// The neighbours of `i` are `to[ptr[i]..ptr[i+1]]`, with how many unknowns they share in `edge`.
pub struct Graph {
    pub ptr: Vec<usize>,
    pub to: Vec<u32>,
    pub edge: Vec<u32>,
    /// Of the pieces the sums of these are to be equal.
    pub weight: Vec<f64>,
}

impl Graph {
    pub fn of(incidence: &Incidence) -> Result<Self> {
        let count = incidence.count();
        let mut room = Neighbours::room(count)?;
        let mut most: Vec<u32> = filled(count, 0, WHAT)?;
        for e in 0..count {
            if e % 4096 == 0 {
                interrupt::check()?;
            }
            let mut here = 0;
            incidence.neighbours(e, &mut room, |_, share| {
                here = here.max(share);
            });
            most[e] = here;
        }
        let (mut ptr, mut to, mut edge) = (reserved(count + 1, WHAT)?, Vec::new(), Vec::new());
        ptr.push(0);
        for e in 0..count {
            incidence.neighbours(e, &mut room, |f, share| {
                if FACE.1 * share >= FACE.0 * most[e].min(most[f as usize]) {
                    to.push(f);
                    edge.push(share);
                }
            });
            ptr.push(to.len());
        }
        Ok(Self { ptr, to, edge, weight: weights(incidence)? })
    }

    pub fn count(&self) -> usize {
        self.weight.len()
    }

    /// Neighbours with the unknowns shared.
    pub fn around(&self, i: usize) -> impl Iterator<Item = (usize, u32)> + '_ {
        let range = self.ptr[i]..self.ptr[i + 1];
        self.to[range.clone()].iter().map(|&j| j as usize).zip(self.edge[range].iter().copied())
    }

    /// Connected parts of those with one label: the part of each, numbered by their first, and the weights of the parts.
    pub fn parts(&self, label: &[u32]) -> Result<(Vec<u32>, Vec<f64>)> {
        let mut part: Vec<u32> = filled(self.count(), NONE, WHAT)?;
        let (mut weights, mut queue) = (Vec::new(), reserved(self.count(), WHAT)?);
        for first in 0..self.count() {
            if part[first] != NONE {
                continue;
            }
            let (number, mut weight) = (weights.len() as u32, 0.0);
            part[first] = number;
            queue.push(first as u32);
            while let Some(i) = queue.pop() {
                weight += self.weight[i as usize];
                for &j in &self.to[self.ptr[i as usize]..self.ptr[i as usize + 1]] {
                    if part[j as usize] == NONE && label[j as usize] == label[i as usize] {
                        part[j as usize] = number;
                        queue.push(j);
                    }
                }
            }
            weights.push(weight);
        }
        Ok((part, weights))
    }

    /// The graph of the vertices `some` alone, numbered in their order. `place` is room for a number of every vertex, all `NONE`
    /// before and after.
    pub fn of_some(&self, some: &[u32], place: &mut [u32]) -> Result<Self> {
        some.iter().enumerate().for_each(|(at, &i)| place[i as usize] = at as u32);
        let entries = some.iter().map(|&i| self.ptr[i as usize + 1] - self.ptr[i as usize]).sum();
        let (mut ptr, mut to) = (reserved(some.len() + 1, WHAT)?, reserved(entries, WHAT)?);
        let (mut edge, mut weight) = (reserved(entries, WHAT)?, reserved(some.len(), WHAT)?);
        ptr.push(0);
        for &i in some {
            for (j, share) in self.around(i as usize).filter(|&(j, _)| place[j] != NONE) {
                to.push(place[j]);
                edge.push(share);
            }
            ptr.push(to.len());
            weight.push(self.weight[i as usize]);
        }
        some.iter().for_each(|&i| place[i as usize] = NONE);
        Ok(Self { ptr, to, edge, weight })
    }
}

/// The unknowns of an element over the most elements that one of its nodes has: equal for equal elements, at the surface of the
/// body as inside.
fn weights(incidence: &Incidence) -> Result<Vec<f64>> {
    let mut weights = reserved(incidence.count(), WHAT)?;
    for e in 0..incidence.count() {
        let most = incidence.nodes(e).iter().map(|&n| incidence.elements(n).len()).max().unwrap_or(1);
        weights.push(f64::from(incidence.size(e).max(1)) / most.max(1) as f64);
    }
    Ok(weights)
}

/// How many of `pieces` each part gets: in proportion to its weight, at least one, at most as many as it has vertices.
pub fn shares(weights: &[f64], vertices: &[usize], pieces: usize) -> Vec<usize> {
    let total: f64 = weights.iter().sum();
    let wish = |part: usize| pieces as f64 * weights[part] / total;
    let mut shares: Vec<usize> =
        (0..weights.len()).map(|part| (wish(part) as usize).clamp(1, vertices[part])).collect();
    let mut left = pieces.saturating_sub(shares.iter().sum());
    let mut by_need: Vec<usize> = (0..weights.len()).collect();
    let need = |shares: &[usize], part: usize| wish(part) - shares[part] as f64;
    by_need.sort_by(|&a, &b| need(&shares, b).total_cmp(&need(&shares, a)));
    while left > 0 {
        let before = left;
        for &part in &by_need {
            if left > 0 && shares[part] < vertices[part] {
                shares[part] += 1;
                left -= 1;
            }
        }
        if left == before {
            break;
        }
    }
    // those rounded up to one are paid for by the largest
    by_need.sort_by_key(|&part| Reverse(shares[part]));
    let mut over = shares.iter().sum::<usize>().saturating_sub(pieces);
    while over > 0 {
        let Some(largest) =
            (0..shares.len()).filter(|&part| shares[part] > 1).max_by_key(|&part| shares[part])
        else {
            break;
        };
        shares[largest] -= 1;
        over -= 1;
    }
    shares
}
