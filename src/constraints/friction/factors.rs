//! What the lengths of the rows of a node tell of the factors by which the host has multiplied them.

use crate::constraints::RowSet;
use crate::error::{Error, Result};
use crate::numbers::rounding;
use crate::numbers::rows::FACTORS;

pub type Entries = Vec<(usize, f64)>;

/// Of row i, none if there is no such row.
pub fn entries(rows: &RowSet, i: usize) -> Entries {
    if i < rows.len() {
        rows.matrix.row(i).collect()
    } else {
        Vec::new()
    }
}

fn product(a: &Entries, b: &Entries) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.1 * b.1).sum()
}

fn length(row: &Entries) -> f64 {
    product(row, row).sqrt()
}

/// The ratio of the lengths of rows; those so short that they are rounding are dropped.
pub fn ratio(rows: &mut Vec<Entries>) -> f64 {
    let most = rows.iter().map(length).fold(0.0, f64::max);
    // a shorter row is what the host has left of one by rounding
    rows.retain(|row| length(row) > rounding::METHOD * most);
    most / rows.iter().map(length).fold(most, f64::min)
}

/// The host's factors are known only where supports have taken no entries: from rows on the same unknowns that are mostly
/// perpendicular. Of n directions of which some are held, fewer than n remain, and the rows depend on each other. Rows without
/// entries, and rows so short that they are rounding, say nothing.
pub fn check_factors(mut rows: Vec<Entries>, node: usize) -> Result<()> {
    let ratio = ratio(&mut rows);
    let unknowns = |row: &Entries| row.iter().map(|(j, _)| *j).collect::<Vec<_>>();
    let is_one = !(ratio > FACTORS);
    if is_one || rows.windows(2).any(|pair| unknowns(&pair[0]) != unknowns(&pair[1])) {
        return Ok(());
    }
    let cosine = |i: usize, j: usize| match (rows.get(i), rows.get(j)) {
        (Some(a), Some(b)) => product(a, b) / length(a) / length(b),
        _ => 0.0,
    };
    let [a, b, c] = [cosine(0, 1), cosine(1, 2), cosine(2, 0)];
    // the squared volume of the unit rows
    if 1.0 + 2.0 * a * b * c - a * a - b * b - c * c < 0.5 {
        return Ok(());
    }
    let what = "rows of this node have different factors: multiply the contact row and the tangential rows of a node by the same number";
    Err(Error::argument("val", what).node(node).value(ratio).limit(FACTORS))
}
