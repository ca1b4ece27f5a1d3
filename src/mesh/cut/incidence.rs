//! The nodes of the elements. A node is a set of unknowns that belong to the same elements; it is found from the unknowns
//! alone.

use super::Elements;
use crate::error::{Error, Kind, Result};
pub use crate::linalg::partition::NONE;
use crate::platform::memory::{filled, reserved};

pub const WHAT: &str = "the cut of a body";
/// An unknown of more elements than this (shared by a whole surface) is in every piece, and does not identify faces.
const MOST_AT_A_NODE: usize = 500;

/// The nodes of element `e` are `node[ptr[e]..ptr[e+1]]`, the elements of node `n` are `element[by[n]..by[n+1]]`,
/// ascending.
pub struct Incidence {
    ptr: Vec<usize>,
    node: Vec<u32>,
    by: Vec<usize>,
    element: Vec<u32>,
    /// Unknowns of each node.
    pub weight: Vec<u32>,
}

/// Work array for the neighbours of one element: those that share a node with it, and how many unknowns they share.
pub struct Neighbours {
    pub met: Vec<u32>,
    pub share: Vec<u32>,
}

impl Neighbours {
    pub fn room(elements: usize) -> Result<Self> {
        Ok(Self { met: reserved(elements, WHAT)?, share: filled(elements, 0, WHAT)? })
    }
}

impl Incidence {
    pub fn of(elements: &Elements) -> Result<Self> {
        check(elements)?;
        let count = elements.ptr.len() - 1;
        let key = keys(elements)?;
        let mut of: Vec<u32> = filled(elements.unknowns, NONE, WHAT)?;
        let (mut ptr, mut node) = (reserved(count + 1, WHAT)?, reserved(elements.dof.len(), WHAT)?);
        let mut weight: Vec<u32> = reserved(elements.unknowns, WHAT)?;
        let mut last: Vec<u32> = filled(elements.unknowns, NONE, WHAT)?;
        let mut new = Vec::new();
        ptr.push(0);
        for e in 0..count {
            let unknowns = &elements.dof[elements.ptr[e]..elements.ptr[e + 1]];
            new.extend(unknowns.iter().filter(|&&d| of[d as usize] == NONE).map(|&d| (key[d as usize], d)));
            new.sort_unstable();
            new.dedup();
            for alike in new.chunk_by(|a, b| a.0 == b.0) {
                alike.iter().for_each(|&(_, d)| of[d as usize] = weight.len() as u32);
                weight.push(alike.len() as u32);
            }
            new.clear();
            for &d in unknowns {
                let n = of[d as usize];
                if last[n as usize] != e as u32 {
                    last[n as usize] = e as u32;
                    node.push(n);
                }
            }
            ptr.push(node.len());
        }
        Self::with(ptr, node, weight)
    }

    /// The incidence of the elements `kept`, numbered in their order, without nodes that very many of them share.
    pub fn of_some(&self, kept: &[u32]) -> Result<Self> {
        let mut degree: Vec<u32> = filled(self.weight.len(), 0, WHAT)?;
        let each = |e: &u32| self.nodes(*e as usize).iter();
        kept.iter().flat_map(each).for_each(|&n| degree[n as usize] += 1);
        let (mut ptr, mut node) = (reserved(kept.len() + 1, WHAT)?, reserved(self.node.len(), WHAT)?);
        ptr.push(0);
        for e in kept {
            node.extend(each(e).filter(|&&n| degree[n as usize] as usize <= MOST_AT_A_NODE));
            ptr.push(node.len());
        }
        let mut weight = reserved(self.weight.len(), WHAT)?;
        weight.extend_from_slice(&self.weight);
        Self::with(ptr, node, weight)
    }

    fn with(ptr: Vec<usize>, node: Vec<u32>, weight: Vec<u32>) -> Result<Self> {
        let mut by = filled(weight.len() + 1, 0, WHAT)?;
        node.iter().for_each(|&n| by[n as usize + 1] += 1);
        (0..weight.len()).for_each(|n| by[n + 1] += by[n]);
        let mut next: Vec<usize> = reserved(by.len(), WHAT)?;
        next.extend_from_slice(&by);
        let mut element = filled(node.len(), 0, WHAT)?;
        for e in 0..ptr.len() - 1 {
            for &n in &node[ptr[e]..ptr[e + 1]] {
                element[next[n as usize]] = e as u32;
                next[n as usize] += 1;
            }
        }
        Ok(Self { ptr, node, by, element, weight })
    }

    /// Number of elements.
    pub fn count(&self) -> usize {
        self.ptr.len() - 1
    }

    pub fn nodes(&self, e: usize) -> &[u32] {
        &self.node[self.ptr[e]..self.ptr[e + 1]]
    }

    pub fn elements(&self, n: u32) -> &[u32] {
        &self.element[self.by[n as usize]..self.by[n as usize + 1]]
    }

    /// Unknowns of the element.
    pub fn size(&self, e: usize) -> u32 {
        self.nodes(e).iter().map(|&n| self.weight[n as usize]).sum()
    }

    /// Calls `see` with every other element that shares a node with `e`, in the order of their first common node, and the
    /// number of unknowns shared.
    pub fn neighbours(&self, e: usize, room: &mut Neighbours, mut see: impl FnMut(u32, u32)) {
        for &n in self.nodes(e).iter().filter(|&&n| self.elements(n).len() <= MOST_AT_A_NODE) {
            for &f in self.elements(n).iter().filter(|&&f| f as usize != e) {
                if room.share[f as usize] == 0 {
                    room.met.push(f);
                }
                room.share[f as usize] += self.weight[n as usize];
            }
        }
        for f in room.met.drain(..) {
            see(f, std::mem::take(&mut room.share[f as usize]));
        }
    }
}

fn check(elements: &Elements) -> Result<()> {
    let refused = |text: &str| Err(Error::new(Kind::Argument("elements"), text));
    let (ptr, dof) = (elements.ptr, elements.dof);
    if ptr.first() != Some(&0) || ptr.last() != Some(&dof.len()) || ptr.windows(2).any(|p| p[0] > p[1]) {
        return refused("the lists of unknowns of the elements are not consecutive from 0 to the end");
    }
    if ptr.len() > NONE as usize || elements.unknowns > NONE as usize {
        return Err(Error::new(Kind::Overflow, "a body has more than 2^32 elements or unknowns"));
    }
    if dof.iter().any(|&d| d as usize >= elements.unknowns) {
        return refused("an element has an unknown outside the body");
    }
    Ok(())
}

/// A hash of the elements of each unknown: equal for the unknowns of a node, different otherwise, except for an accident
/// of probability 2^-64, which would only make the cut worse.
fn keys(elements: &Elements) -> Result<Vec<u64>> {
    let mut key: Vec<u64> = filled(elements.unknowns, 0, WHAT)?;
    let mut last: Vec<u32> = filled(elements.unknowns, NONE, WHAT)?;
    for e in 0..elements.ptr.len() - 1 {
        let mixed = mixed(e as u64 + 1);
        for &d in &elements.dof[elements.ptr[e]..elements.ptr[e + 1]] {
            if last[d as usize] != e as u32 {
                last[d as usize] = e as u32;
                key[d as usize] = key[d as usize].wrapping_add(mixed);
            }
        }
    }
    Ok(key)
}

/// The finaliser of splitmix64: a pseudo-random number for each x.
pub fn mixed(x: u64) -> u64 {
    let x = x.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
