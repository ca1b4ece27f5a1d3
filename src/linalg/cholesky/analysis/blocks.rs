//! Dofs that are eliminated together: the dofs of a node.

use std::ops::Range;

use crate::error::Result;
use crate::linalg::sparse::graph::Graph;
use crate::platform::memory::{filled, reserved};

const WHAT: &str = "the pattern of a Cholesky factor";

/// Consecutive dofs in the order that have equal neighbours, including each other.
pub struct Blocks {
    /// Their range in the given order.
    pub range: Vec<Range<usize>>,
    /// Position of the first column of every block, then n.
    pub start: Vec<usize>,
    ptr: Vec<usize>,
    adj: Vec<u32>,
}

impl Blocks {
    pub fn of(graph: &Graph, order: &[usize]) -> Result<Self> {
        let mut range: Vec<Range<usize>> = reserved(order.len(), WHAT)?;
        let mut block_of = filled(graph.order(), u32::MAX, WHAT)?;
        for (k, &dof) in order.iter().enumerate() {
            match range.last_mut() {
                Some(last) if graph.neighbours(dof) == graph.neighbours(order[k - 1]) => last.end = k + 1,
                _ => range.push(k..k + 1),
            }
            block_of[dof] = (range.len() - 1) as u32;
        }
        let mut seen = filled(range.len(), u32::MAX, WHAT)?;
        let (mut ptr, mut adj) = (reserved(range.len() + 1, WHAT)?, Vec::new());
        ptr.push(0);
        for (own, range) in range.iter().enumerate() {
            seen[own] = own as u32;
            for &dof in graph.neighbours(order[range.start]) {
                let other = block_of[dof as usize];
                if other != u32::MAX && seen[other as usize] != own as u32 {
                    seen[other as usize] = own as u32;
                    adj.push(other);
                }
            }
            ptr.push(adj.len());
        }
        let start = starts(&range)?;
        Ok(Self { range, start, ptr, adj })
    }

    pub fn count(&self) -> usize {
        self.range.len()
    }

    pub fn neighbours(&self, block: usize) -> &[u32] {
        &self.adj[self.ptr[block]..self.ptr[block + 1]]
    }

    /// Columns of a block.
    pub fn position(&self, block: usize) -> Range<usize> {
        self.start[block]..self.start[block + 1]
    }

    /// Dofs of a block.
    pub fn size(&self, block: usize) -> usize {
        self.position(block).len()
    }

    /// The blocks in another order.
    pub fn permuted(&self, sequence: &[usize]) -> Result<Self> {
        let mut new: Vec<u32> = filled(sequence.len(), 0, WHAT)?;
        sequence.iter().enumerate().for_each(|(at, &block)| new[block] = at as u32);
        let (mut ptr, mut adj) = (reserved(sequence.len() + 1, WHAT)?, reserved(self.adj.len(), WHAT)?);
        ptr.push(0);
        for &block in sequence {
            adj.extend(self.neighbours(block).iter().map(|&other| new[other as usize]));
            ptr.push(adj.len());
        }
        let mut range = reserved(sequence.len(), WHAT)?;
        range.extend(sequence.iter().map(|&block| self.range[block].clone()));
        let start = starts(&range)?;
        Ok(Self { range, start, ptr, adj })
    }
}

fn starts(ranges: &[Range<usize>]) -> Result<Vec<usize>> {
    let mut start = reserved(ranges.len() + 1, WHAT)?;
    start.push(0);
    for (k, range) in ranges.iter().enumerate() {
        start.push(start[k] + range.len());
    }
    Ok(start)
}
