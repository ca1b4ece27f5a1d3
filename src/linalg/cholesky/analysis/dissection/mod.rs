//! Nested dissection of large graphs: a separator comes last, after the two parts that it leaves, each ordered in the same
//! way; small parts by minimum degree.

mod bisection;
mod coarsening;
mod leaves;
mod multilevel;
mod separator;
mod weighted;

use separator::{Separator, BETWEEN};
use weighted::Weighted;

use crate::error::Result;
use crate::platform::memory::filled;

const WHAT: &str = "the ordering of a body";
/// Nodes that are not dissected.
const LEAF: usize = 120;

/// A part of the graph: its nodes, and where they begin in the order.
struct Part {
    graph: Weighted,
    own: Vec<u32>,
    begin: usize,
}

/// Nodes in the order of their elimination; the neighbours of node i, without itself, are `adj[ptr[i]..ptr[i + 1]]`. Parts
/// that no separator divides are left to `undivided`, which takes and gives the same.
pub fn dissect(
    ptr: &[i32],
    adj: &[i32],
    undivided: impl Fn(&[i32], &[i32]) -> Result<Vec<usize>>,
) -> Result<Vec<usize>> {
    let nodes = ptr.len() - 1;
    let mut order = filled(nodes, 0, WHAT)?;
    let mut number = filled(nodes, u32::MAX, WHAT)?;
    let whole = Part { graph: Weighted::of(ptr, adj), own: (0..nodes as u32).collect(), begin: 0 };
    let mut parts = vec![whole];
    while let Some(mut part) = parts.pop() {
        let size = part.own.len();
        if size <= LEAF {
            leaves::minimum_degree(ptr, adj, &mut part.own, &mut number);
        } else if let Some(found) = multilevel::separator(&part.graph).filter(divides) {
            parts.extend(part.divided(&found.side, &mut order));
            continue;
        } else {
            let (ptr, adj) = signed(&part.graph);
            part.own = undivided(&ptr, &adj)?.into_iter().map(|v| part.own[v]).collect();
        }
        put(part.own.into_iter(), &mut order[part.begin..part.begin + size]);
    }
    Ok(order)
}

impl Part {
    /// Both sides; what is between them is put at the end of the order of the part.
    fn divided(self, side: &[u8], order: &mut [usize]) -> [Part; 2] {
        let mut at = self.begin;
        let parts = [0, 1].map(|which| {
            let (graph, inside) = self.graph.part(side, which);
            let begin = at;
            at += inside.len();
            Part { graph, own: inside.into_iter().map(|v| self.own[v as usize]).collect(), begin }
        });
        let between = self.own.iter().zip(side).filter(|(_, &side)| side == BETWEEN);
        put(between.map(|(&v, _)| v), &mut order[at..self.begin + self.own.len()]);
        parts
    }
}

fn put(nodes: impl Iterator<Item = u32>, order: &mut [usize]) {
    order.iter_mut().zip(nodes).for_each(|(at, v)| *at = v as usize);
}

/// No part is empty, or nearly the whole.
fn divides(found: &Separator) -> bool {
    let [a, b, between] = found.weight.map(i64::from);
    a.min(b) > 0 && 20 * a.max(b) <= 19 * (a + b + between)
}

fn signed(graph: &Weighted) -> (Vec<i32>, Vec<i32>) {
    let signed = |values: &[u32]| values.iter().map(|&value| value as i32).collect();
    (signed(&graph.ptr), signed(&graph.adj))
}
