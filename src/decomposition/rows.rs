//! The host's rows over the unknowns of the pieces, and the rows that glue the copies of an unknown together.

use std::sync::Arc;

use crate::constraints::{Friction, RowSet};
use crate::error::Result;
use crate::linalg::Csr;
use crate::model::{HostModel, Joint, Parts};

use super::copies::Copies;

const WHAT: &str = "the rows of pieces";

/// Contact rows of the host; its equality rows, followed by the glue of joints and the glue of pieces; its nodes with
/// friction.
pub fn rows(
    host: &HostModel,
    joints: &[Joint],
    parts: &Parts,
    copies: &[Option<Copies>],
) -> Result<(RowSet, RowSet, Friction)> {
    let place = |j: usize| {
        let body = parts.offsets[1..].partition_point(|end| *end <= j);
        let dof = j - parts.offsets[body];
        match &copies[body] {
            Some(copies) => copies.first_stiff(parts, dof),
            None => parts.starts[parts.first[body]] + dof,
        }
    };
    let (contact, mut equalities) =
        (moved(&host.contact, parts, place)?, moved(&host.equalities, parts, place)?);
    let matrix = Arc::make_mut(&mut equalities.matrix);
    for Joint { ends: [before, after], .. } in joints {
        matrix.push_row([(place(*before), 1.0), (place(*after), -1.0)]);
    }
    for copies in copies.iter().flatten() {
        let pairs = |dof| copies.all(dof).zip(copies.all(dof).skip(1));
        for (before, after) in (0..copies.order()).flat_map(pairs) {
            let [before, after] = [before, after].map(|(part, i)| parts.starts[part] + i);
            matrix.push_row([(before, 1.0), (after, -1.0)]);
        }
    }
    let all = matrix.rows();
    equalities.rhs.resize(all, 0.0);
    Arc::make_mut(&mut equalities.compliance).resize(all, 0.0);
    let mut friction = host.friction.copied(WHAT)?;
    friction.rows = moved(&host.friction.rows, parts, place)?;
    Ok((contact, equalities, friction))
}

/// The rows with every unknown replaced by `place` of it.
fn moved(rows: &RowSet, parts: &Parts, place: impl Fn(usize) -> usize) -> Result<RowSet> {
    let mut moved = rows.copied(WHAT)?;
    let unknowns = parts.starts.last().copied().unwrap_or(0);
    let mut matrix = Csr::with_room(unknowns, rows.len(), rows.matrix.val.len());
    for i in 0..rows.len() {
        let mut entries: Vec<(usize, f64)> = rows.matrix.row(i).map(|(j, v)| (place(j), v)).collect();
        entries.sort_unstable_by_key(|entry| entry.0);
        matrix.push_row(entries);
    }
    moved.matrix = Arc::new(matrix);
    Ok(moved)
}
