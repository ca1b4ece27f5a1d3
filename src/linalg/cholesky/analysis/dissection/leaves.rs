//! The order of a few nodes by minimum degree, which also counts neighbours that are eliminated later.

use crate::linalg::partition::NONE;

/// Limit of outside neighbours that are counted.
const OUTSIDE: usize = 1024;

/// The elimination graph of a few nodes: for each node a row of bits, one per neighbour, with outside neighbours after
/// all nodes.
struct Rows {
    nodes: usize,
    /// Numbers of 64 bits in a row.
    words: usize,
    bits: Vec<u64>,
}

/// Sorts the nodes `own` into the order of their elimination; their other neighbours are eliminated later. `number`: work
/// array with an entry per node of the graph, all `u32::MAX` before and after.
pub fn minimum_degree(ptr: &[i32], adj: &[i32], own: &mut [u32], number: &mut [u32]) {
    let mut rows = Rows::of(ptr, adj, own, number);
    let mut degree: Vec<u32> = (0..own.len()).map(|v| rows.degree(v)).collect();
    let mut order = Vec::with_capacity(own.len());
    // repeats until all nodes are eliminated
    while let Some(v) = (0..own.len()).filter(|&v| degree[v] != NONE).min_by_key(|&v| degree[v]) {
        order.push(own[v]);
        degree[v] = NONE;
        rows.eliminate(v, &mut degree);
    }
    own.copy_from_slice(&order);
}

impl Rows {
    fn of(ptr: &[i32], adj: &[i32], own: &[u32], number: &mut [u32]) -> Self {
        let around = |v: u32| &adj[ptr[v as usize] as usize..ptr[v as usize + 1] as usize];
        own.iter().enumerate().for_each(|(k, &v)| number[v as usize] = k as u32);
        let mut outside = Vec::new();
        for &u in own.iter().flat_map(|&v| around(v)) {
            if number[u as usize] == NONE && outside.len() < OUTSIDE {
                number[u as usize] = (own.len() + outside.len()) as u32;
                outside.push(u as u32);
            }
        }
        let words = (own.len() + outside.len()).div_ceil(64);
        let mut rows = Self { nodes: own.len(), words, bits: vec![0; own.len() * words] };
        for (v, &node) in own.iter().enumerate() {
            let known = around(node).iter().map(|&u| number[u as usize]).filter(|&u| u != NONE);
            known.for_each(|u| rows.bits[v * words + u as usize / 64] |= 1 << (u % 64));
        }
        own.iter().chain(&outside).for_each(|&v| number[v as usize] = NONE);
        rows
    }

    fn degree(&self, v: usize) -> u32 {
        self.bits[v * self.words..(v + 1) * self.words].iter().map(|word| word.count_ones()).sum()
    }

    /// Makes all neighbours of v neighbours of each other, and removes v.
    fn eliminate(&mut self, v: usize, degree: &mut [u32]) {
        let (at, bit) = (v / 64, 1_u64 << (v % 64));
        let pivot = self.bits[v * self.words..(v + 1) * self.words].to_vec();
        for u in (0..self.nodes).filter(|u| pivot[u / 64] >> (u % 64) & 1 == 1) {
            let row = &mut self.bits[u * self.words..(u + 1) * self.words];
            row.iter_mut().zip(&pivot).for_each(|(word, more)| *word |= more);
            row[at] &= !bit;
            row[u / 64] &= !(1 << (u % 64));
            degree[u] = self.degree(u);
        }
    }
}
