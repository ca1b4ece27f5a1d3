//! Fill-reducing order of the unknowns: nested dissection of the graph of nodes, each connected part separately.

use crate::error::{Error, Kind, Result};
#[cfg(any(test, not(feature = "metis")))]
use crate::linalg::cholesky::analysis::dissection;
#[cfg(feature = "metis")]
use crate::linalg::cholesky::analysis::metis::dissect;
use crate::linalg::sparse::graph::{joined, Graph};
use crate::platform::memory::{filled, reserved};
#[cfg(not(feature = "metis"))]
use built_in as dissect;

/// The free dofs in the order of their elimination. The graph of nodes (dofs with identical neighbours) is dissected
/// instead of that of dofs: it is 3 x smaller in 3D, and supernodes are not split.
pub fn nested_dissection(graph: &Graph, held: &[bool]) -> Result<Vec<usize>> {
    let (node, first) = graph.nodes()?;
    let order = order_nodes(graph, &node, &first)?;
    let mut rank = filled(order.len(), 0, "the ordering of a body")?;
    order.iter().enumerate().for_each(|(at, &node)| rank[node] = at);
    let mut dofs = reserved(node.len(), "the ordering of a body")?;
    dofs.extend((0..node.len()).filter(|&dof| !held[dof]));
    dofs.sort_unstable_by_key(|&dof| (rank[node[dof] as usize], dof));
    Ok(dofs)
}

/// Dissects the quotient graph of the nodes.
fn order_nodes(graph: &Graph, node: &[u32], first: &[usize]) -> Result<Vec<usize>> {
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
    dissect_sparse(&ptr, &adj)
}

/// Nodes with more neighbours come last, as in AMD: dissection around such a node costs the square of their number.
fn most_neighbours(nodes: usize) -> usize {
    (10 * nodes.isqrt()).max(1000)
}

/// Dissects the graph without the nodes that have too many neighbours, and appends these.
fn dissect_sparse(ptr: &[i32], adj: &[i32]) -> Result<Vec<usize>> {
    let nodes = ptr.len() - 1;
    let is_dense = |&i: &usize| (ptr[i + 1] - ptr[i]) as usize > most_neighbours(nodes);
    let (dense, sparse): (Vec<usize>, Vec<usize>) = (0..nodes).partition(is_dense);
    if dense.is_empty() {
        return dissect_parts(ptr, adj);
    }
    let (from, to) = among(&sparse, ptr, adj, &mut vec![None; nodes])?;
    Ok(dissect_parts(&from, &to)?.into_iter().map(|k| sparse[k]).chain(dense).collect())
}

/// Dissects every connected part separately: the search for parts below a separator costs the product of the numbers of
/// parts and nodes. For single nodes, and for complete graphs, the order does not matter.
fn dissect_parts(ptr: &[i32], adj: &[i32]) -> Result<Vec<usize>> {
    let nodes = ptr.len() - 1;
    let around = |i: usize| adj[ptr[i] as usize..ptr[i + 1] as usize].iter().map(|&j| j as usize);
    let (part, count) = joined(nodes, (0..nodes).map(|i| std::iter::once(i).chain(around(i))));
    if count == 1 && !is_complete(nodes, adj) {
        return dissect(ptr, adj);
    }
    let mut order: Vec<usize> = reserved(nodes, "the ordering of a body")?;
    order.extend(0..nodes);
    order.sort_by_key(|&i| part[i]);
    let mut number = filled(nodes, None, "the ordering of a body")?;
    for own in order.chunk_by_mut(|&i, &j| part[i] == part[j]) {
        let (from, to) = among(own, ptr, adj, &mut number)?;
        if !is_complete(own.len(), &to) {
            let sequence: Vec<usize> = dissect(&from, &to)?.into_iter().map(|k| own[k]).collect();
            own.copy_from_slice(&sequence);
        }
    }
    Ok(order)
}

/// Whether all nodes are neighbours of each other.
fn is_complete(nodes: usize, adj: &[i32]) -> bool {
    adj.len() == nodes * nodes.saturating_sub(1)
}

/// The graph of some nodes; `number`: work array with an entry per node of the whole graph, none is set before and after.
fn among(
    own: &[usize],
    ptr: &[i32],
    adj: &[i32],
    number: &mut [Option<i32>],
) -> Result<(Vec<i32>, Vec<i32>)> {
    own.iter().enumerate().for_each(|(k, &i)| number[i] = Some(k as i32));
    let around = |i: usize| &adj[ptr[i] as usize..ptr[i + 1] as usize];
    let mut from = reserved(own.len() + 1, "the ordering of a body")?;
    let mut to = reserved(own.iter().map(|&i| around(i).len()).sum(), "the ordering of a body")?;
    from.push(0);
    for &i in own {
        to.extend(around(i).iter().filter_map(|&j| number[j as usize]));
        from.push(to.len() as i32);
    }
    own.iter().for_each(|&i| number[i] = None);
    Ok((from, to))
}

/// From this number of nodes on, the separators of feral-metis become too large: 1.2 times the work with METIS for a cube
/// of 50 thousand nodes, 1.5 times for 100 thousand.
#[cfg(any(test, not(feature = "metis")))]
const LARGE: usize = 10_000;

/// The order without METIS: small graphs by the crate feral-metis, large graphs by the library's own separators.
#[cfg(any(test, not(feature = "metis")))]
pub fn built_in(ptr: &[i32], adj: &[i32]) -> Result<Vec<usize>> {
    if ptr.len() <= LARGE {
        feral(ptr, adj)
    } else {
        dissection::dissect(ptr, adj, feral)
    }
}

/// The order by the crate feral-metis; the neighbours of node i, without itself, are `adj[ptr[i]..ptr[i + 1]]`.
#[cfg(any(test, not(feature = "metis")))]
fn feral(ptr: &[i32], adj: &[i32]) -> Result<Vec<usize>> {
    let failed = |why: String| Error::new(Kind::Internal, format!("nested dissection failed: {why}"));
    let pattern = feral_metis::CscPattern::new(ptr.len() - 1, ptr, adj);
    let pattern = pattern.ok_or_else(|| failed("no graph".into()))?;
    let order = feral_metis::metis_order(&pattern).map_err(|e| failed(format!("{e:?}")))?;
    Ok(order.into_iter().map(|node| node as usize).collect())
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
        let mut order = nested_dissection(&graph, &held).unwrap();
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
        nested_dissection(graph, &vec![false; graph.order()]).unwrap()
    }

    /// Ratios of times, each the least of three, measured alternately: other load of the machine affects both.
    #[test]
    fn lone_unknowns_cost_the_order_little_more_than_their_share() {
        let (with, without) = (grid(150, 2), grid(150, 0));
        let time = |graph: &Graph| {
            let begun = std::time::Instant::now();
            order_of(graph);
            begun.elapsed().as_secs_f64()
        };
        let (mut long, mut short) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..3 {
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
        let order = nested_dissection(&graph, &vec![false; n]).unwrap();
        assert_eq!(order[n - 2..], [0, n / 2]);
    }
}
