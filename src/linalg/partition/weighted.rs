//! A graph with weights of vertices and edges.

use std::ops::Range;

use super::{NONE, WHAT};
use crate::error::Result;
use crate::platform::memory::{filled, reserved};

/// The neighbours of `v`, without itself, are `adj[ptr[v]..ptr[v + 1]]`, with the weights of the edges in `edge`.
pub struct Weighted {
    pub ptr: Vec<usize>,
    pub adj: Vec<u32>,
    pub edge: Vec<u32>,
    /// Weights of the vertices.
    pub weight: Vec<f64>,
}

impl Weighted {
    /// A graph without vertices, with room for this number of vertices and entries of `adj`.
    pub fn with_room(vertices: usize, entries: usize) -> Result<Self> {
        let mut ptr = reserved(vertices + 1, WHAT)?;
        ptr.push(0);
        let (adj, edge) = (reserved(entries, WHAT)?, reserved(entries, WHAT)?);
        Ok(Self { ptr, adj, edge, weight: reserved(vertices, WHAT)? })
    }

    pub fn count(&self) -> usize {
        self.weight.len()
    }

    /// Weight of all vertices.
    pub fn total(&self) -> f64 {
        self.weight.iter().sum()
    }

    /// Range of the neighbours of a vertex in `adj` and `edge`.
    pub fn range(&self, v: usize) -> Range<usize> {
        self.ptr[v]..self.ptr[v + 1]
    }

    pub fn neighbours(&self, v: usize) -> impl Iterator<Item = usize> + '_ {
        self.adj[self.range(v)].iter().map(|&u| u as usize)
    }

    /// Neighbours and the weights of the edges to them.
    pub fn around(&self, v: usize) -> impl Iterator<Item = (usize, u32)> + '_ {
        self.neighbours(v).zip(self.edge[self.range(v)].iter().copied())
    }

    /// Connected parts of the vertices with equal labels: the part of each vertex, numbered by first vertices, and the
    /// weights of the parts.
    pub fn parts(&self, label: &[u32]) -> Result<(Vec<u32>, Vec<f64>)> {
        let mut part: Vec<u32> = filled(self.count(), NONE, WHAT)?;
        let (mut weights, mut queue) = (Vec::new(), reserved(self.count(), WHAT)?);
        for first in 0..self.count() {
            if part[first] != NONE {
                continue;
            }
            let (number, mut weight) = (weights.len() as u32, 0.0);
            part[first] = number;
            queue.push(first);
            while let Some(i) = queue.pop() {
                weight += self.weight[i];
                for j in self.neighbours(i) {
                    if part[j] == NONE && label[j] == label[i] {
                        part[j] = number;
                        queue.push(j);
                    }
                }
            }
            weights.push(weight);
        }
        Ok((part, weights))
    }

    /// The graph of the vertices `some`, numbered in their order. `place`: work array with an entry per vertex, `NONE`
    /// before and after.
    pub fn of_some(&self, some: &[u32], place: &mut [u32]) -> Result<Self> {
        some.iter().zip(0..).for_each(|(&v, at)| place[v as usize] = at);
        let entries = some.iter().map(|&v| self.range(v as usize).len()).sum();
        let mut part = Self::with_room(some.len(), entries)?;
        for &v in some {
            for (u, edge) in self.around(v as usize).filter(|&(u, _)| place[u] != NONE) {
                part.adj.push(place[u]);
                part.edge.push(edge);
            }
            part.ptr.push(part.adj.len());
            part.weight.push(self.weight[v as usize]);
        }
        some.iter().for_each(|&v| place[v as usize] = NONE);
        Ok(part)
    }
}
