//! The laws of the nodes of an island for the rows of its dual, and the preconditioner on their faces.

use std::collections::HashMap;

use crate::dual::{Preconditioner, TurnedRow};
use crate::error::Result;
use crate::platform::memory::filled;
use crate::qp::friction::{Cones, Face, FacePreconditioner, Law, Node, OnFace};
use crate::setup::Ready;
use crate::solve::gaps::Gaps;

/// All laws on a subset of the rows of the dual, numbered within the subset: nodes with friction, half lines of other bounded rows.
/// With `lambda_n = a_n x_n`, a_n by its share, and `lambda_t = a_t x_t`: `|x_t| <= bound / a_t + mu (a_n / a_t) x_n`.
pub fn cones(ready: &Ready, gaps: &Gaps, rows: &[usize]) -> Result<Cones> {
    let mut place = filled(gaps.bounded.len(), None, "friction")?;
    rows.iter().enumerate().for_each(|(k, &row)| place[row] = Some(k));
    let (tangential, scaling) = (ready.rows.tangential, &ready.rows.scaling);
    let group_of = |row: usize| scaling.grouping.member[row].map(|(group, _)| group);
    // place and force of a normal row that carries a share of the force of its group
    let carries = |row: usize| {
        let group = group_of(row).filter(|&group| gaps.bounded[group] && gaps.share[row] > 0.0)?;
        Some((place[group]?, scaling.force_of(group, row) * gaps.share[row]))
    };
    let (mut nodes, mut first) = (Vec::new(), HashMap::new());
    for node in ready.island.friction.nodes.iter().filter(|node| node.has_friction()) {
        let tangents: Vec<usize> = node.rows().filter_map(|row| group_of(tangential + row)).collect();
        let by = tangents.first().map_or(1.0, |&group| scaling.force_of(group, gaps.holder[group]));
        let tangents: Vec<usize> = tangents.iter().filter_map(|&row| place[row]).collect();
        let normal = node.normal.and_then(carries);
        let coefficient = normal.map_or(0.0, |(_, force)| node.coefficient * (force / by));
        let (normal, next) = (normal.map(|(row, _)| row), nodes.len());
        let first = normal.map_or(next, |row| *first.entry(row).or_insert(next));
        nodes.push((first, Node::new(normal, &tangents, coefficient, node.bound / by)?));
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

/// The preconditioner of the bodies on a subset of the rows of the dual.
pub struct OfBodies<'a> {
    pub of: &'a Preconditioner,
    pub rows: &'a [usize],
}

/// M of one face, on its free coordinates.
impl FacePreconditioner for OfBodies<'_> {
    fn on<'a>(&'a self, face: &Face) -> Result<Box<dyn OnFace + 'a>> {
        let (mut free, mut rows) = (Vec::new(), Vec::new());
        for (k, at) in face.coordinates.iter().enumerate() {
            if let Law::Free { damping, .. } = at.law {
                free.push(k);
                rows.push(TurnedRow { rows: at.rows.map(|row| self.rows[row]), along: at.along, damping });
            }
        }
        let of_face = self.of.turned(&rows)?;
        Ok(Box::new(move |q: &[f64], z: &mut [f64]| {
            let own: Vec<f64> = free.iter().map(|&k| q[k]).collect();
            let mut image = vec![0.0; own.len()];
            of_face.apply(&own, &mut image)?;
            z.fill(0.0);
            free.iter().zip(image).for_each(|(&k, v)| z[k] = v);
            Ok(())
        }))
    }
}
