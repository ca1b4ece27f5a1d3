//! Rows over the unknowns of the host's table `u = T v + g`: a row `b u <= c` is `(bT) v <= c - b g`.

use std::sync::Arc;

use crate::constraints::dof_table::DofTable;
use crate::constraints::{Entries, OwnedRows, RowKind, RowsInput};
use crate::error::{Error, Result, INDEX};
use crate::linalg::vector::first_non_finite;
use crate::linalg::Csr;

/// The table, and the rows that name unknowns of it.
#[derive(Debug, Clone)]
pub struct Table {
    pub dofs: Arc<DofTable>,
    rows: [TabledRows; 3],
}

/// Rows of one kind as the host gave them.
#[derive(Debug, Clone)]
pub struct TabledRows {
    /// Their numbers, ascending.
    number: Vec<usize>,
    /// Entries over the unknowns of the table.
    matrix: Csr,
    /// c, h or s_old, length.
    rhs: Vec<f64>,
}

impl Default for TabledRows {
    fn default() -> Self {
        Self { number: Vec::new(), matrix: Csr::empty(0), rhs: Vec::new() }
    }
}

impl TabledRows {
    pub fn push(&mut self, number: usize, entries: impl Iterator<Item = (usize, f64)>, rhs: f64) {
        self.number.push(number);
        self.matrix.push_row(entries);
        self.rhs.push(rhs);
    }

    /// Rows of a later number, which are counted from `first` in `more`.
    pub fn append(&mut self, more: &Self, first: usize) {
        (0..more.number.len())
            .for_each(|k| self.push(first + more.number[k], more.matrix.row(k), more.rhs[k]));
    }
}

impl Table {
    /// A table for the rows of the previous one.
    pub fn new(dofs: DofTable, previous: Option<&Self>) -> Result<Self> {
        let rows = previous.map(|previous| previous.rows.clone()).unwrap_or_default();
        for (kind, rows) in RowKind::ALL.iter().zip(&rows) {
            if let Some(at) = rows.matrix.col.iter().position(|i| *i >= dofs.len()) {
                let row = rows.number[rows.matrix.ptr.partition_point(|&start| start <= at) - 1];
                let what = format!("a row names unknown {INDEX} of the table, which has {} now", dofs.len());
                let error = Error::argument("n", what).row(row).kind(*kind as usize);
                return Err(error.index(rows.matrix.col[at] as i64));
            }
        }
        Ok(Self { dofs: Arc::new(dofs), rows })
    }

    /// Rows whose entries name unknowns of the table.
    pub fn resolved(&self, rows: RowsInput<'_>) -> Result<OwnedRows> {
        let n = self.dofs.len();
        if let Some(at) = first_non_finite(rows.val) {
            let row = rows.ptr.partition_point(|&p| p <= at) - 1;
            return Err(Error::argument("val", "the entry is not a finite number").row(row).entry(at));
        }
        let mut resolved = OwnedRows::default();
        for row in 0..rows.ptr.len() - 1 {
            let mut entries = Vec::new();
            for at in rows.ptr[row]..rows.ptr[row + 1] {
                let known = usize::try_from(rows.dof[at]).ok().filter(|i| *i < n).ok_or_else(|| {
                    let what = format!("unknown {INDEX} is outside the {n} unknowns of the table");
                    Error::argument("dof", what).row(row).entry(at).index(rows.dof[at])
                })?;
                entries.push((known, rows.val[at]));
            }
            self.resolve(&entries, rows.rhs.map_or(0.0, |rhs| rhs[row]), &mut resolved);
        }
        Ok(resolved)
    }

    fn resolve(&self, row: &[(usize, f64)], rhs: f64, to: &mut OwnedRows) {
        let entries =
            row.iter().flat_map(|&(i, b)| self.dofs.terms.row(i).map(move |(place, t)| (place, b * t)));
        to.push(entries, self.dofs.right_hand_side(row.iter().copied(), rhs));
    }

    /// Takes note of rows from `first` on, which `resolved` has taken.
    pub fn keep(&mut self, kind: RowKind, first: usize, rows: RowsInput<'_>) {
        let own = &mut self.rows[kind as usize];
        for row in 0..rows.ptr.len() - 1 {
            let entries = (rows.ptr[row]..rows.ptr[row + 1]).map(|at| (rows.dof[at] as usize, rows.val[at]));
            own.push(first + row, entries, rows.rhs.map_or(0.0, |rhs| rhs[row]));
        }
    }

    /// `first` stands in place of the rows of a kind before row `end`.
    pub fn replace_before(&mut self, kind: RowKind, end: usize, mut first: TabledRows) {
        let own = &mut self.rows[kind as usize];
        for k in own.number.partition_point(|row| *row < end)..own.number.len() {
            first.push(own.number[k], own.matrix.row(k), own.rhs[k]);
        }
        *own = first;
    }

    /// Forgets the rows of a kind from `first` on.
    pub fn keep_before(&mut self, kind: RowKind, first: usize) {
        let own = &mut self.rows[kind as usize];
        let count = own.number.partition_point(|row| *row < first);
        own.number.truncate(count);
        own.rhs.truncate(count);
        own.matrix.truncate(count);
    }

    /// Number, entries and right-hand side of the rows of a kind, as given.
    pub fn rows(&self, kind: RowKind) -> impl Iterator<Item = (usize, Vec<(usize, f64)>, f64)> + '_ {
        let own = &self.rows[kind as usize];
        own.number.iter().enumerate().map(|(k, row)| (*row, own.matrix.row(k).collect(), own.rhs[k]))
    }

    pub fn has(&self, kind: RowKind, number: usize) -> bool {
        self.rows[kind as usize].number.binary_search(&number).is_ok()
    }

    /// Row `number` as given; no entries if it is no row of the table.
    pub fn entries(&self, kind: RowKind, number: usize) -> Entries {
        let own = &self.rows[kind as usize];
        own.number.binary_search(&number).map_or(Vec::new(), |k| own.matrix.row(k).collect())
    }

    /// Row `number` over the unknowns of K, if it is a row of the table.
    pub fn row(&self, kind: RowKind, number: usize, to: &mut OwnedRows) -> bool {
        let own = &self.rows[kind as usize];
        let Ok(k) = own.number.binary_search(&number) else { return false };
        self.resolve(&own.matrix.row(k).collect::<Vec<_>>(), own.rhs[k], to);
        true
    }

    /// Right-hand sides given for the rows from `first` on, for the unknowns of K.
    pub fn right_hand_sides(&self, kind: RowKind, first: usize, rhs: &[f64]) -> Vec<f64> {
        let mut all = rhs.to_vec();
        self.each_in(kind, first, rhs.len(), |own, k, at| {
            all[at] = self.dofs.right_hand_side(own.matrix.row(k), rhs[at]);
        });
        all
    }

    /// Takes note of right-hand sides of the rows from `first` on, as given.
    pub fn keep_right_hand_sides(&mut self, kind: RowKind, first: usize, rhs: &[f64]) {
        let mut kept = Vec::new();
        self.each_in(kind, first, rhs.len(), |_, k, at| kept.push((k, rhs[at])));
        kept.into_iter().for_each(|(k, rhs)| self.rows[kind as usize].rhs[k] = rhs);
    }

    /// `b g` of the rows of a kind is added to right-hand sides for the unknowns of K.
    pub fn add_constants(&self, kind: RowKind, rhs: &mut [f64]) {
        self.each_in(kind, 0, rhs.len(), |own, k, at| {
            rhs[at] += own.matrix.row(k).map(|(i, b)| b * self.dofs.constants[i]).sum::<f64>();
        });
    }

    fn each_in(
        &self,
        kind: RowKind,
        first: usize,
        count: usize,
        mut work: impl FnMut(&TabledRows, usize, usize),
    ) {
        let own = &self.rows[kind as usize];
        let from = own.number.partition_point(|row| *row < first);
        for (k, row) in own.number.iter().enumerate().skip(from).take_while(|(_, row)| **row - first < count)
        {
            work(own, k, row - first);
        }
    }
}
