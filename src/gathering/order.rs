//! The order of bodies, rows and nodes: by the numbers of the host, so that no bit depends on the ranks that have given them; without
//! numbers rank by rank.

use std::cmp::Ordering;
use std::collections::HashMap;

use crate::gathering::places::At;
use crate::gathering::told::{RowsTold, Told};

/// All of what ranks have so many of, rank by rank.
fn all(counts: impl Iterator<Item = usize>) -> Vec<At> {
    counts.enumerate().flat_map(|(rank, count)| (0..count).map(move |number| At { rank, number })).collect()
}

/// Bodies by their least numbers, then by their largest.
pub fn bodies(told: &[Told]) -> Vec<At> {
    let mut bodies = all(told.iter().map(|of| of.bodies.len()));
    bodies.sort_by_key(|at| {
        let body = &told[at.rank].bodies[at.number];
        body.numbers.map(|(least, most)| (least, most, body.order))
    });
    bodies
}

/// Rows of one kind by the numbers of their entries, then by values, right-hand sides and compliances; equal contact rows by their nodes.
pub fn rows(told: &[Told], kind: usize, is_numbered: bool) -> Vec<At> {
    let mut rows = all(told.iter().map(|of| of.rows[kind].len()));
    if is_numbered {
        let of_rows = |of: &Told| if kind == 0 { nodes_of_rows(of) } else { HashMap::new() };
        let nodes: Vec<HashMap<usize, usize>> = told.iter().map(of_rows).collect();
        let node = |at: &At| Some((&told[at.rank], *nodes[at.rank].get(&at.number)?));
        rows.sort_by(|a, b| {
            let of = |at: &At| (&told[at.rank].rows[kind], at.number);
            let by_node = || match (node(a), node(b)) {
                (Some(a), Some(b)) => compared_nodes(a, b),
                (a, b) => a.is_some().cmp(&b.is_some()),
            };
            compared(of(a), of(b)).then_with(by_node)
        });
    }
    rows
}

/// The node of every contact row that has one.
fn nodes_of_rows(of: &Told) -> HashMap<usize, usize> {
    of.nodes.iter().enumerate().filter_map(|(k, node)| Some((node.normal?, k))).collect()
}

/// By their tangential rows, then by their laws.
fn compared_nodes((a, k): (&Told, usize), (b, l): (&Told, usize)) -> Ordering {
    let mut each =
        a.nodes[k].rows().zip(b.nodes[l].rows()).map(|(i, j)| compared((&a.rows[2], i), (&b.rows[2], j)));
    let first = each.find(|order| *order != Ordering::Equal);
    let law = |of: &Told, k: usize| [of.nodes[k].coefficient, of.nodes[k].bound];
    let by_law = || {
        let mut each = law(a, k).into_iter().zip(law(b, l)).map(|(a, b)| a.total_cmp(&b));
        each.find(|order| *order != Ordering::Equal).unwrap_or(Ordering::Equal)
    };
    first.unwrap_or_else(by_law)
}

/// Nodes by their tangential rows and laws, then by their contact rows; `normal`: the place of a contact row in the order.
pub fn nodes(told: &[Told], is_numbered: bool, normal: impl Fn(At) -> usize) -> Vec<At> {
    let mut nodes = all(told.iter().map(|of| of.nodes.len()));
    if is_numbered {
        let normal = |at: &At| {
            let row = told[at.rank].nodes[at.number].normal;
            row.map(|number| normal(At { rank: at.rank, number }))
        };
        nodes.sort_by(|a, b| {
            let of = |at: &At| (&told[at.rank], at.number);
            compared_nodes(of(a), of(b)).then_with(|| normal(a).cmp(&normal(b)))
        });
    }
    nodes
}

fn compared((a, i): (&RowsTold, usize), (b, j): (&RowsTold, usize)) -> Ordering {
    let [one, other] = [a.row(i), b.row(j)];
    let by_number = one.iter().map(|of| of.number).cmp(other.iter().map(|of| of.number));
    let by_value = || {
        let mut each = one.iter().zip(other).map(|(a, b)| a.value.total_cmp(&b.value));
        each.find(|order| *order != Ordering::Equal).unwrap_or(Ordering::Equal)
    };
    let by_law = || {
        let rhs = a.rhs[i].total_cmp(&b.rhs[j]);
        rhs.then_with(|| a.compliance[i].total_cmp(&b.compliance[j]))
    };
    by_number.then_with(by_value).then_with(by_law)
}
