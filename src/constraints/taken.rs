//! What was taken from rows as rounding. Few sets of rows have any of it.

use crate::constraints::RowSet;

/// Of one set of rows.
#[derive(Debug, Clone, Default)]
pub struct Taken {
    /// Rows that lost all entries: repeated entries that cancelled, or that are rounding of the other rows of a node.
    pub entries: Vec<usize>,
    /// From the right-hand sides, >= 0, length; nothing beyond its end.
    pub rhs: Vec<f64>,
}

impl RowSet {
    /// What was taken from the right-hand side of row i as rounding, length.
    pub fn rounding(&self, i: usize) -> f64 {
        self.taken.as_ref().and_then(|taken| taken.rhs.get(i)).copied().unwrap_or(0.0)
    }

    /// Rows that lost all entries as rounding.
    pub fn cancelled(&self) -> &[usize] {
        self.taken.as_ref().map_or(&[], |taken| &taken.entries)
    }
}
