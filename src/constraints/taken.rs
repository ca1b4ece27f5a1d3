//! What few sets of rows have: what was taken from them as rounding, and names of unknowns.

use crate::constraints::RowSet;

/// Of one set of rows.
#[derive(Debug, Clone, Default)]
pub struct Taken {
    /// Rows that lost all entries: repeated entries that cancelled, or that are rounding of the other rows of a node.
    pub entries: Vec<usize>,
    /// From the right-hand sides, >= 0, length; nothing beyond its end.
    pub rhs: Vec<f64>,
    /// Rows whose unknowns the host has named by numbers, which other ranks may have, too; nothing beyond its end.
    pub named: Vec<bool>,
}

impl RowSet {
    /// What was taken from the right-hand side of row i as rounding, length.
    pub fn rounding(&self, i: usize) -> f64 {
        self.taken.as_ref().and_then(|taken| taken.rhs.get(i)).copied().unwrap_or(0.0)
    }

    /// The host has named the unknowns of row i by numbers.
    pub fn is_named(&self, i: usize) -> bool {
        self.taken.as_ref().and_then(|taken| taken.named.get(i)).copied().unwrap_or(false)
    }

    /// Takes note that the unknowns of the rows from `first` on were named by numbers.
    pub fn name(&mut self, first: usize) {
        let rows = self.len();
        let named = &mut self.taken.get_or_insert_default().named;
        named.resize(first, false);
        named.resize(rows, true);
    }

    /// Takes over what was taken from those rows of another set that are also rows of this set.
    pub fn keep_taken(&mut self, of: &Self, is_same: impl Fn(usize) -> bool) {
        let Some(taken) = &of.taken else { return };
        let own = self.taken.get_or_insert_default();
        own.entries.extend(taken.entries.iter().filter(|row| is_same(**row)));
        own.named.clone_from(&taken.named);
    }

    /// Rows that lost all entries as rounding.
    pub fn cancelled(&self) -> &[usize] {
        self.taken.as_ref().map_or(&[], |taken| &taken.entries)
    }
}
