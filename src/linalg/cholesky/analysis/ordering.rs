//! Fill-reducing order of the unknowns, each connected part of the graph of nodes separately: by minimum degree, and where
//! elimination in this order is expensive, by nested dissection.

use crate::error::{Error, Kind, Result};
#[cfg(not(feature = "metis"))]
use crate::linalg::cholesky::analysis::dissection::dissect;
#[cfg(feature = "metis")]
use crate::linalg::cholesky::analysis::metis::dissect;
use crate::linalg::cholesky::analysis::minimum_degree::minimum_degree;
use crate::linalg::sparse::graph::{joined, Graph};
use crate::numbers::linalg::DISSECTION;
use crate::platform::memory::{filled, reserved};

const WHAT: &str = "the ordering of a body";

/// The free dofs in the order of their elimination. The graph of nodes (dofs with identical neighbours) is ordered
/// instead of that of dofs: it is 3 x smaller in 3D, and supernodes are not split.
pub fn order_of_elimination(graph: &Graph, held: &[bool]) -> Result<Vec<usize>> {
    let (node, first) = graph.nodes()?;
    let order = Nodes::of(graph, &node, &first)?.order()?;
    let mut rank = filled(order.len(), 0, WHAT)?;
    order.iter().enumerate().for_each(|(at, &node)| rank[node] = at);
    let mut dofs = reserved(node.len(), WHAT)?;
    dofs.extend((0..node.len()).filter(|&dof| !held[dof]));
    dofs.sort_unstable_by_key(|&dof| (rank[node[dof] as usize], dof));
    Ok(dofs)
}

/// The quotient graph of nodes: the neighbours of each, without itself, and the numbers of dofs.
struct Nodes {
    ptr: Vec<i32>,
    adj: Vec<i32>,
    dofs: Vec<u32>,
}

impl Nodes {
    fn of(graph: &Graph, node: &[u32], first: &[usize]) -> Result<Self> {
        let too_large = || Error::new(Kind::Overflow, "the graph of a body exceeds 2^31 edges");
        let (mut ptr, mut adj, mut row) = (vec![0i32], Vec::new(), Vec::new());
        for (own, &dof) in first.iter().enumerate() {
            row.clear();
            row.extend(graph.neighbours(dof).iter().map(|&j| node[j as usize] as i32));
            row.sort_unstable();
            row.dedup();
            adj.extend(row.iter().filter(|&&other| other as usize != own));
            ptr.push(i32::try_from(adj.len()).map_err(|_| too_large())?);
        }
        let mut dofs = filled(first.len(), 0, WHAT)?;
        node.iter().for_each(|&node| dofs[node as usize] += 1);
        Ok(Self { ptr, adj, dofs })
    }

    fn count(&self) -> usize {
        self.dofs.len()
    }

    fn around(&self, i: usize) -> &[i32] {
        &self.adj[self.ptr[i] as usize..self.ptr[i + 1] as usize]
    }

    /// Whether all nodes are neighbours of each other.
    fn is_complete(&self) -> bool {
        self.adj.len() == self.count() * self.count().saturating_sub(1)
    }

    /// Nodes with more neighbours come last, as in AMD: dissection around such a node costs the square of their number.
    fn most_neighbours(&self) -> usize {
        (10 * self.count().isqrt()).max(1000)
    }

    /// Orders the graph without the nodes that have too many neighbours, and appends these.
    fn order(&self) -> Result<Vec<usize>> {
        let is_dense = |&i: &usize| self.around(i).len() > self.most_neighbours();
        let (dense, sparse): (Vec<usize>, Vec<usize>) = (0..self.count()).partition(is_dense);
        if dense.is_empty() {
            return self.order_parts();
        }
        let rest = self.among(&sparse, &mut vec![None; self.count()])?;
        Ok(rest.order_parts()?.into_iter().map(|k| sparse[k]).chain(dense).collect())
    }

    /// Orders every connected part separately: the search for parts below a separator costs the product of the numbers of
    /// parts and nodes. For complete graphs, as of one or two nodes, the order does not matter.
    fn order_parts(&self) -> Result<Vec<usize>> {
        let nodes = self.count();
        let with = |i: usize| std::iter::once(i).chain(self.around(i).iter().map(|&j| j as usize));
        let (part, count) = joined(nodes, (0..nodes).map(with));
        if count == 1 && !self.is_complete() {
            return self.order_part();
        }
        let mut order: Vec<usize> = reserved(nodes, WHAT)?;
        order.extend(0..nodes);
        order.sort_by_key(|&i| part[i]);
        let mut number = filled(nodes, None, WHAT)?;
        for own in order.chunk_by_mut(|&i, &j| part[i] == part[j]).filter(|own| own.len() > 2) {
            let alone = self.among(own, &mut number)?;
            if !alone.is_complete() {
                let sequence: Vec<usize> = alone.order_part()?.into_iter().map(|k| own[k]).collect();
                own.copy_from_slice(&sequence);
            }
        }
        Ok(order)
    }

    fn order_part(&self) -> Result<Vec<usize>> {
        let Self { ptr, adj, dofs } = self;
        let (order, of_nodes) = minimum_degree(ptr, adj)?;
        let each = dofs.iter().map(|&n| f64::from(n)).sum::<f64>() / self.count() as f64;
        if of_nodes * each.powi(3) <= DISSECTION * adj.len() as f64 {
            return Ok(order);
        }
        dissect(ptr, adj)
    }

    /// The graph of some nodes; `number`: work array with an entry per node of the whole graph, none is set before and after.
    fn among(&self, own: &[usize], number: &mut [Option<i32>]) -> Result<Self> {
        own.iter().enumerate().for_each(|(k, &i)| number[i] = Some(k as i32));
        let mut ptr = reserved(own.len() + 1, WHAT)?;
        let mut adj = reserved(own.iter().map(|&i| self.around(i).len()).sum(), WHAT)?;
        ptr.push(0);
        for &i in own {
            adj.extend(self.around(i).iter().filter_map(|&j| number[j as usize]));
            ptr.push(adj.len() as i32);
        }
        own.iter().for_each(|&i| number[i] = None);
        Ok(Self { ptr, adj, dofs: own.iter().map(|&i| self.dofs[i]).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Symmetric;

    #[test]
    fn every_free_dof_is_eliminated_exactly_once() {
        let n = 400;
        let (mut ptr, mut col) = (vec![0], Vec::new());
        for i in 0..n as u32 {
            col.extend((i >= 20).then(|| i - 20));
            col.extend((i % 20 > 0).then(|| i - 1));
            col.push(i);
            ptr.push(col.len());
        }
        let val = vec![1.0; col.len()];
        let mut held = vec![false; n];
        held[7] = true;
        let graph = Graph::of(&Symmetric::new(ptr, col, val)).unwrap();
        let mut order = order_of_elimination(&graph, &held).unwrap();
        order.sort_unstable();
        assert_eq!(order, (0..n).filter(|&i| i != 7).collect::<Vec<_>>());
    }

    /// A grid of n x n nodes, each joined to its neighbours and to `lone` further unknowns.
    fn grid(n: usize, lone: usize) -> Graph {
        let (mut ptr, mut col) = (vec![0], Vec::new());
        let (by, numbered) = (1 + lone, |i: usize| (i * (1 + lone)) as u32);
        for k in 0..by * n * n {
            let i = k / by;
            if k % by > 0 {
                col.push(k as u32);
            } else {
                col.extend((i >= n).then(|| numbered(i - n)));
                col.extend((i % n > 0).then(|| numbered(i - 1)));
                col.push(numbered(i));
            }
            ptr.push(col.len());
        }
        let val = vec![1.0; col.len()];
        Graph::of(&Symmetric::new(ptr, col, val)).unwrap()
    }

    fn order_of(graph: &Graph) -> Vec<usize> {
        order_of_elimination(graph, &vec![false; graph.order()]).unwrap()
    }

    /// By hand: an entry per node and one per edge, whatever the numbers of the nodes.
    #[test]
    fn a_chain_is_ordered_without_fill() {
        let n = 1000;
        let place = |k: usize| (k * 381) % n;
        let mut rows = vec![Vec::new(); n];
        (1..n).map(|k| (place(k), place(k - 1))).for_each(|(a, b)| rows[a.max(b)].push(a.min(b) as u32));
        let (mut ptr, mut col) = (vec![0], Vec::new());
        for (i, mut row) in rows.into_iter().enumerate() {
            row.push(i as u32);
            row.sort_unstable();
            col.extend(row);
            ptr.push(col.len());
        }
        let val = vec![1.0; col.len()];
        let graph = Graph::of(&Symmetric::new(ptr, col, val)).unwrap();
        let order = order_of(&graph);
        let mut rank = vec![0; n];
        order.iter().enumerate().for_each(|(at, &i)| rank[i] = at);
        // eliminated with two neighbours left, a node would join them
        let later = |i: usize| graph.neighbours(i).iter().filter(|&&j| rank[j as usize] > rank[i]).count();
        assert!((0..n).all(|i| later(i) <= 1));
    }

    /// Ratios of times, each the least of twelve, measured alternately: other load of the machine affects both.
    #[test]
    fn lone_unknowns_cost_the_order_little_more_than_their_share() {
        let (with, without) = (grid(150, 2), grid(150, 0));
        let time = |graph: &Graph| {
            let begun = std::time::Instant::now();
            order_of(graph);
            begun.elapsed().as_secs_f64()
        };
        let (mut long, mut short) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..12 {
            (long, short) = (long.min(time(&with)), short.min(time(&without)));
        }
        assert!(long < 3.0 * short, "{long:.3} s with lone unknowns, {short:.3} s without");
    }

    #[test]
    fn every_part_has_the_order_that_it_has_alone() {
        let (alone, n) = (grid(40, 0), 1600);
        let order = order_of(&alone);
        // interleaved parts: unknown i of part p is 3 i + p; the unknowns of part 1 have no neighbours
        let (mut ptr, mut adj) = (vec![0], Vec::new());
        for k in 0..3 * n as u32 {
            let (i, p) = (k as usize / 3, k % 3);
            let of_part = |&j: &u32| if p == 1 { k } else { 3 * j + p };
            adj.extend(alone.neighbours(i).iter().map(of_part));
            adj.dedup();
            ptr.push(adj.len());
        }
        let together = order_of(&Graph { ptr, adj });
        for p in [0, 2] {
            let own: Vec<usize> = together.iter().filter(|k| *k % 3 == p).map(|k| k / 3).collect();
            assert!(own == order, "part {p}");
        }
        let mut all = together;
        all.sort_unstable();
        assert!(all.into_iter().eq(0..3 * n));
    }

    #[test]
    fn nodes_tied_to_all_others_are_eliminated_last() {
        let n = 60_000; // a chain; a spring joins its first and its middle node to each of the others
        let (mut ptr, mut col) = (vec![0], Vec::new());
        for i in 0..n as u32 {
            let mut row = vec![0, i.saturating_sub(1), i];
            row.extend((i > n as u32 / 2).then_some(n as u32 / 2));
            row.extend(if i == n as u32 / 2 { 0..i } else { 0..0 });
            row.sort_unstable();
            row.dedup();
            col.extend(row);
            ptr.push(col.len());
        }
        let val = vec![1.0; col.len()];
        let graph = Graph::of(&Symmetric::new(ptr, col, val)).unwrap();
        let order = order_of_elimination(&graph, &vec![false; n]).unwrap();
        assert_eq!(order[n - 2..], [0, n / 2]);
    }
}
