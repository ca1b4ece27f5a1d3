//! The laws of the nodes of an island for the rows of its dual, and the preconditioner on their faces.

use std::collections::HashMap;

use crate::constraints::FrictionNode;
use crate::dual::{Preconditioner, TurnedFace, TurnedRow};
use crate::error::Result;
use crate::platform::memory::filled;
use crate::qp::friction::{Cones, Face, FacePreconditioner, Law, Node, OnFace};
use crate::setup::Ready;
use crate::solve::gaps::Gaps;

/// A node in the rows of the dual: its normal row, if it carries a share of the force of its group, tangential rows, mu' and bound'.
struct DualNode {
    normal: Option<usize>,
    tangents: Vec<usize>,
    coefficient: f64,
    bound: f64,
}

/// With `lambda_n = a_n x_n`, a_n by its share, and `lambda_t = a_t x_t`: `|x_t| <= bound / a_t + mu (a_n / a_t) x_n`.
fn dual_node(ready: &Ready, gaps: &Gaps, node: &FrictionNode) -> DualNode {
    let (rows, scaling) = (&ready.rows, &ready.rows.scaling);
    let group_of = |row: usize| scaling.grouping.member[row].map(|(group, _)| group);
    let carries = |row: usize| {
        let group = group_of(row).filter(|&group| gaps.bounded[group] && gaps.share[row] > 0.0)?;
        Some((group, scaling.force_of(group, row) * gaps.share[row]))
    };
    let normal = node.normal.and_then(carries);
    let tangents: Vec<usize> = node.rows().filter_map(|row| group_of(rows.tangential + row)).collect();
    let by = tangents.first().map_or(1.0, |&group| scaling.force_of(group, gaps.holder[group]));
    let coefficient = normal.map_or(0.0, |(_, force)| node.coefficient * (force / by));
    DualNode { normal: normal.map(|(group, _)| group), tangents, coefficient, bound: node.bound / by }
}

/// All laws on a subset of the rows of the dual, numbered within the subset: nodes with friction, half lines of other
/// bounded rows.
pub fn cones(ready: &Ready, gaps: &Gaps, rows: &[usize]) -> Result<Cones> {
    let mut place = filled(gaps.bounded.len(), None, "friction")?;
    rows.iter().enumerate().for_each(|(k, &row)| place[row] = Some(k));
    let (mut nodes, mut first) = (Vec::new(), HashMap::new());
    for node in ready.island.friction.nodes.iter().filter(|node| node.has_friction()) {
        let DualNode { normal, tangents, coefficient, bound } = dual_node(ready, gaps, node);
        let tangents: Vec<usize> = tangents.iter().filter_map(|&row| place[row]).collect();
        let normal = normal.and_then(|row| place[row]);
        let coefficient = if normal.is_some() { coefficient } else { 0.0 };
        let next = nodes.len();
        let first = normal.map_or(next, |row| *first.entry(row).or_insert(next));
        nodes.push((first, Node::new(normal, &tangents, coefficient, bound)?));
    }
    // nodes that share a normal row come one after the other
    nodes.sort_by_key(|(first, _)| *first);
    let mut nodes: Vec<Node> = nodes.into_iter().map(|(_, node)| node).collect();
    for (k, &row) in rows.iter().enumerate() {
        if gaps.bounded[row] && !first.contains_key(&k) {
            nodes.push(Node::new(Some(k), &[], 0.0, 0.0)?);
        }
    }
    Cones::new(rows.len(), nodes)
}

/// Tangential rows of nodes whose friction bound at x is 0.
pub fn open_rows(ready: &Ready, gaps: &Gaps, x: &[f64]) -> Vec<usize> {
    let mut open = Vec::new();
    for node in &ready.island.friction.nodes {
        let node = dual_node(ready, gaps, node);
        let normal = node.normal.map_or(0.0, |row| x[row].max(0.0));
        if node.bound + node.coefficient * normal <= 0.0 {
            open.extend(node.tangents);
        }
    }
    open
}

/// The preconditioner of the bodies on a subset of the rows of the dual.
pub struct OfBodies<'a> {
    pub of: &'a Preconditioner,
    pub rows: &'a [usize],
}

/// M of one face, on its free coordinates.
struct OnFree<'a> {
    free: Vec<usize>,
    face: TurnedFace<'a>,
}

impl FacePreconditioner for OfBodies<'_> {
    fn on<'a>(&'a self, face: &Face) -> Result<Box<dyn OnFace + 'a>> {
        let (mut free, mut rows) = (Vec::new(), Vec::new());
        for (k, at) in face.coordinates.iter().enumerate() {
            if let Law::Free { damping, .. } = at.law {
                free.push(k);
                rows.push(TurnedRow { rows: at.rows.map(|row| self.rows[row]), along: at.along, damping });
            }
        }
        Ok(Box::new(OnFree { free, face: self.of.turned(&rows)? }))
    }
}

impl OnFace for OnFree<'_> {
    fn apply(&self, q: &[f64], z: &mut [f64]) -> Result<()> {
        let own: Vec<f64> = self.free.iter().map(|&k| q[k]).collect();
        let mut image = vec![0.0; own.len()];
        self.face.apply(&own, &mut image)?;
        z.fill(0.0);
        self.free.iter().zip(image).for_each(|(&k, v)| z[k] = v);
        Ok(())
    }
}
