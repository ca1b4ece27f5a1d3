//! A graph with weights of nodes and edges: the numbers of nodes and edges of a finer graph that they represent.

use std::ops::Range;

pub struct Weighted {
    /// The neighbours of node v are `adj[ptr[v]..ptr[v + 1]]`, with the weights of the edges in `edge`.
    pub ptr: Vec<u32>,
    pub adj: Vec<u32>,
    pub edge: Vec<i32>,
    /// Weights of the nodes.
    pub node: Vec<i32>,
}

impl Weighted {
    /// The graph with all weights 1; the neighbours of node i, without itself, are `adj[ptr[i]..ptr[i + 1]]`.
    pub fn of(ptr: &[i32], adj: &[i32]) -> Self {
        let unsigned = |values: &[i32]| values.iter().map(|&value| value as u32).collect();
        Self {
            ptr: unsigned(ptr),
            adj: unsigned(adj),
            edge: vec![1; adj.len()],
            node: vec![1; ptr.len() - 1],
        }
    }

    /// A graph without nodes, with room for this number of nodes and entries of `adj`.
    pub fn with_room(nodes: usize, entries: usize) -> Self {
        let mut ptr = Vec::with_capacity(nodes + 1);
        ptr.push(0);
        Self {
            ptr,
            adj: Vec::with_capacity(entries),
            edge: Vec::with_capacity(entries),
            node: Vec::with_capacity(nodes),
        }
    }

    pub fn count(&self) -> usize {
        self.node.len()
    }

    /// Range of the neighbours of a node in `adj` and `edge`.
    pub fn range(&self, v: usize) -> Range<usize> {
        self.ptr[v] as usize..self.ptr[v + 1] as usize
    }

    pub fn around(&self, v: usize) -> impl Iterator<Item = usize> + '_ {
        self.adj[self.range(v)].iter().map(|&u| u as usize)
    }

    /// Total weight of all nodes.
    pub fn total(&self) -> i32 {
        self.node.iter().sum()
    }

    /// The graph of the nodes whose side is `which`, and these nodes.
    pub fn part(&self, side: &[u8], which: u8) -> (Self, Vec<u32>) {
        let mut own = Vec::new();
        let (mut number, mut entries) = (vec![0; self.count()], 0);
        for v in (0..self.count()).filter(|&v| side[v] == which) {
            number[v] = own.len() as u32;
            own.push(v as u32);
            entries += self.around(v).filter(|&u| side[u] == which).count();
        }
        let mut part = Self::with_room(own.len(), entries);
        for &v in &own {
            let inside = self.range(v as usize).filter(|&k| side[self.adj[k] as usize] == which);
            for k in inside {
                part.adj.push(number[self.adj[k] as usize]);
                part.edge.push(self.edge[k]);
            }
            part.node.push(self.node[v as usize]);
            part.ptr.push(part.adj.len() as u32);
        }
        (part, own)
    }
}
