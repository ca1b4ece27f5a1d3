//! Fill-reducing order of the unknowns: nested dissection of the graph of nodes.

use crate::error::{Error, Kind, Result};
use crate::linalg::graph::Graph;
use crate::linalg::memory::reserved;
#[cfg(feature = "metis")]
use crate::linalg::metis::dissect;
#[cfg(not(feature = "metis"))]
use feral as dissect;

/// The dofs that are not held, in the order of their elimination. The graph of nodes (dofs with
/// identical neighbours) is dissected instead of that of dofs: 3 x smaller in 3D, and supernodes stay whole.
pub fn nested_dissection(graph: &Graph, held: &[bool]) -> Result<Vec<usize>> {
    let (node, first) = graph.nodes()?;
    let order = order_nodes(graph, &node, &first)?;
    let mut rank = reserved(order.len(), "the ordering of a body")?;
    rank.resize(order.len(), 0);
    order.iter().enumerate().for_each(|(at, &node)| rank[node] = at);
    let mut dofs = reserved(node.len(), "the ordering of a body")?;
    dofs.extend((0..node.len()).filter(|&dof| !held[dof]));
    dofs.sort_unstable_by_key(|&dof| (rank[node[dof] as usize], dof));
    Ok(dofs)
}

/// Dissects the quotient graph of the nodes.
fn order_nodes(graph: &Graph, node: &[u32], first: &[usize]) -> Result<Vec<usize>> {
    if first.len() < 3 {
        return Ok((0..first.len()).collect());
    }
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

/// Nodes with more neighbours come last, as in AMD: to dissect around one takes the square of their number.
fn most_neighbours(nodes: usize) -> usize {
    (10 * nodes.isqrt()).max(1000)
}

/// Dissects the graph without the nodes of too many neighbours, which follow.
fn dissect_sparse(ptr: &[i32], adj: &[i32]) -> Result<Vec<usize>> {
    let nodes = ptr.len() - 1;
    let around = |i: usize| &adj[ptr[i] as usize..ptr[i + 1] as usize];
    let is_dense = |&i: &usize| around(i).len() > most_neighbours(nodes);
    let (dense, sparse): (Vec<usize>, Vec<usize>) = (0..nodes).partition(is_dense);
    if dense.is_empty() {
        return dissect(ptr, adj);
    }
    let mut number = vec![None; nodes];
    sparse.iter().enumerate().for_each(|(k, &i)| number[i] = Some(k as i32));
    let (mut from, mut to) = (vec![0], reserved(adj.len(), "the ordering of a body")?);
    for &i in &sparse {
        to.extend(around(i).iter().filter_map(|&j| number[j as usize]));
        from.push(to.len() as i32);
    }
    let order = if to.is_empty() { (0..sparse.len()).collect() } else { dissect(&from, &to)? };
    Ok(order.into_iter().map(|k| sparse[k]).chain(dense).collect())
}

/// The order by the crate feral-metis; the neighbours of node i, without itself, are `adj[ptr[i]..ptr[i + 1]]`.
#[cfg(any(test, not(feature = "metis")))]
pub fn feral(ptr: &[i32], adj: &[i32]) -> Result<Vec<usize>> {
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

    #[test]
    fn nodes_tied_to_all_others_are_eliminated_last() {
        let n = 60_000; // a chain; its first and its middle node have a spring to each of the others
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
