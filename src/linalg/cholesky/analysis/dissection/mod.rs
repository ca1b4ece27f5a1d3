//! Nested dissection: a separator is ordered last, after the two parts that it separates, which are
//! ordered recursively; small parts, and those that nothing divides, are ordered by minimum degree.

mod leaves;
mod multilevel;
mod separator;

use separator::{Separator, BETWEEN};

use crate::error::Result;
use crate::linalg::cholesky::analysis::minimum_degree::minimum_degree;
use crate::linalg::partition::{Weighted, NONE};
use crate::numbers::linalg::SHRINKS;
use crate::platform::memory::filled;

const WHAT: &str = "the ordering of a body";
/// Parts of up to this number of nodes are not dissected.
const LEAF: usize = 120;

/// A part of the graph: its nodes, and its start in the order.
struct Part {
    graph: Weighted,
    own: Vec<u32>,
    begin: usize,
}

/// Nodes in the order of their elimination; the neighbours of node i, without itself, are `adj[ptr[i]..ptr[i + 1]]`.
pub fn dissect(ptr: &[i32], adj: &[i32]) -> Result<Vec<usize>> {
    let nodes = ptr.len() - 1;
    let mut order = filled(nodes, 0, WHAT)?;
    let mut number = filled(nodes, NONE, WHAT)?;
    let whole = Part { graph: alike(ptr, adj)?, own: (0..nodes as u32).collect(), begin: 0 };
    let mut parts = vec![whole];
    while let Some(mut part) = parts.pop() {
        let size = part.own.len();
        if size <= LEAF {
            leaves::minimum_degree(ptr, adj, &mut part.own, &mut number);
        } else {
            let found = multilevel::separator(&part.graph)?;
            if divides(&found) {
                parts.extend(part.divided(&found.side, &mut order)?);
                continue;
            }
            let (ptr, adj) = signed(&part.graph);
            part.own = minimum_degree(&ptr, &adj)?.0.into_iter().map(|v| part.own[v]).collect();
        }
        put(part.own.into_iter(), &mut order[part.begin..part.begin + size]);
    }
    Ok(order)
}

impl Part {
    /// Both sides; the separator is put at the end of the order of the part.
    fn divided(self, side: &[u8], order: &mut [usize]) -> Result<[Part; 2]> {
        let mut at = self.begin;
        let mut place = filled(side.len(), NONE, WHAT)?;
        let mut part = |which: u8| -> Result<Part> {
            let mut own: Vec<u32> = (0..side.len() as u32).filter(|&v| side[v as usize] == which).collect();
            let graph = self.graph.of_some(&own, &mut place)?;
            own.iter_mut().for_each(|v| *v = self.own[*v as usize]);
            at += own.len();
            Ok(Part { graph, begin: at - own.len(), own })
        };
        let parts = [part(0)?, part(1)?];
        let between = self.own.iter().zip(side).filter(|(_, &side)| side == BETWEEN);
        put(between.map(|(&v, _)| v), &mut order[at..self.begin + self.own.len()]);
        Ok(parts)
    }
}

fn put(nodes: impl Iterator<Item = u32>, order: &mut [usize]) {
    order.iter_mut().zip(nodes).for_each(|(at, v)| *at = v as usize);
}

/// Whether no part is empty or nearly the whole graph.
fn divides(found: &Separator) -> bool {
    let [a, b, between] = found.weight;
    a.min(b) > 0.0 && a.max(b) <= SHRINKS * (a + b + between)
}

/// The graph with all weights 1.
fn alike(ptr: &[i32], adj: &[i32]) -> Result<Weighted> {
    let mut graph = Weighted::with_room(ptr.len() - 1, adj.len())?;
    graph.ptr.extend(ptr[1..].iter().map(|&end| end as usize));
    graph.adj.extend(adj.iter().map(|&u| u as u32));
    graph.edge.resize(adj.len(), 1);
    graph.weight.resize(ptr.len() - 1, 1.0);
    Ok(graph)
}

fn signed(graph: &Weighted) -> (Vec<i32>, Vec<i32>) {
    let ptr = graph.ptr.iter().map(|&end| end as i32).collect();
    (ptr, graph.adj.iter().map(|&u| u as i32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid with this number of nodes in each direction; all nodes of an element are coupled.
    fn grid(size: [i32; 3]) -> (Vec<i32>, Vec<i32>) {
        let [nx, ny, nz] = size;
        let (mut ptr, mut adj) = (vec![0], Vec::new());
        for i in 0..nx * ny * nz {
            let at = [i % nx, i / nx % ny, i / (nx * ny)];
            for k in (0..27).filter(|&k| k != 13) {
                let other = [at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1];
                if other.iter().zip(size).all(|(v, end)| (0..end).contains(v)) {
                    adj.push(other[0] + nx * (other[1] + ny * other[2]));
                }
            }
            ptr.push(adj.len() as i32);
        }
        (ptr, adj)
    }

    /// By hand: the separator of a box is at least the number of nodes of a plane.
    #[test]
    fn separators_of_boxes_are_planes() {
        for (size, plane) in [([20, 20, 20], 400.0), ([60, 11, 11], 121.0), ([50, 50, 2], 100.0)] {
            let (ptr, adj) = grid(size);
            let found = multilevel::separator(&alike(&ptr, &adj).unwrap()).unwrap();
            let [a, b, between] = found.weight;
            assert!(between == plane && 5.0 * (a - b).abs() <= a + b, "{size:?}: {:?}", found.weight);
        }
    }

    #[test]
    fn nothing_on_one_side_has_a_neighbour_on_the_other() {
        let (ptr, adj) = grid([17, 13, 12]);
        let graph = alike(&ptr, &adj).unwrap();
        let side = multilevel::separator(&graph).unwrap().side;
        let crosses = |v: usize| graph.neighbours(v).any(|u| side[u] + side[v] == 1);
        assert!(!(0..graph.count()).any(crosses));
    }

    #[test]
    fn every_node_is_ordered_once_also_in_parts_and_around_hubs() {
        let (ptr, adj) = grid([14, 12, 9]);
        let n = ptr.len() as i32 - 1;
        // two copies that are not connected
        let twice = |values: &[i32], by: i32| -> Vec<i32> {
            values.iter().copied().chain(values.iter().map(|value| value + by)).collect()
        };
        let mut both = twice(&ptr, ptr[n as usize]);
        both.remove(n as usize);
        // every tenth node is the hub of nine
        let star = |i: i32| if i % 10 == 0 { i + 1..i + 10 } else { i - i % 10..i - i % 10 + 1 };
        let stars: Vec<i32> = (0..3000).flat_map(star).collect();
        let mut ends = vec![0];
        (0..3000).for_each(|i| ends.push(ends[i as usize] + star(i).len() as i32));
        for (ptr, adj) in [(both, twice(&adj, n)), (ends, stars), (ptr, adj)] {
            let mut order = dissect(&ptr, &adj).unwrap();
            order.sort_unstable();
            assert!(order.into_iter().eq(0..ptr.len() - 1));
        }
    }

    #[test]
    fn parts_that_nothing_divides_have_an_order_too() {
        let n = 150;
        let ptr: Vec<i32> = (0..=n).map(|i| i * (n - 1)).collect();
        let adj: Vec<i32> = (0..n).flat_map(|i| (0..n).filter(move |&j| j != i)).collect();
        let mut order = dissect(&ptr, &adj).unwrap();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..n as usize));
    }

    /// Nodes 0 to 2 of a path; node 0 has three further neighbours, outside.
    #[test]
    fn neighbours_that_come_later_count_in_the_degree() {
        let ptr = [0, 4, 6, 7, 8, 9, 10];
        let adj = [1, 3, 4, 5, 0, 2, 1, 0, 0, 0];
        let (mut own, mut number) = ([0, 1, 2], [u32::MAX; 6]);
        leaves::minimum_degree(&ptr, &adj, &mut own, &mut number);
        assert_eq!((own, number), ([2, 1, 0], [u32::MAX; 6]));
    }
}
