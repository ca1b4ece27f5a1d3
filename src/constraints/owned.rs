//! Rows in arrays of their own.

use crate::constraints::RowsInput;

/// Rows over unknowns, without bodies.
pub struct OwnedRows {
    ptr: Vec<usize>,
    dof: Vec<i64>,
    val: Vec<f64>,
    pub rhs: Vec<f64>,
}

impl Default for OwnedRows {
    fn default() -> Self {
        Self { ptr: vec![0], dof: Vec::new(), val: Vec::new(), rhs: Vec::new() }
    }
}

impl OwnedRows {
    pub fn len(&self) -> usize {
        self.rhs.len()
    }

    pub fn input(&self) -> RowsInput<'_> {
        RowsInput { ptr: &self.ptr, body: None, dof: &self.dof, val: &self.val, rhs: Some(&self.rhs) }
    }

    pub fn push(&mut self, entries: impl Iterator<Item = (usize, f64)>, rhs: f64) {
        for (place, v) in entries {
            self.dof.push(place as i64);
            self.val.push(v);
        }
        self.ptr.push(self.dof.len());
        self.rhs.push(rhs);
    }

    /// The next row, without entries so far.
    pub fn begin(&mut self, rhs: f64) {
        self.push(std::iter::empty(), rhs);
    }

    /// An entry of the last row.
    pub fn add(&mut self, place: usize, value: f64) {
        self.dof.push(place as i64);
        self.val.push(value);
        if let Some(end) = self.ptr.last_mut() {
            *end += 1;
        }
    }

    /// Drops all entries of the last row but those at some places.
    pub fn retain_in_last(&mut self, keeps: impl Fn(usize) -> bool) {
        let Some(last) = self.len().checked_sub(1) else { return };
        let kept: Vec<(usize, f64)> = self.row(last).filter(|(place, _)| keeps(*place)).collect();
        let start = self.ptr[last];
        self.dof.truncate(start);
        self.val.truncate(start);
        self.ptr[last + 1] = start;
        kept.into_iter().for_each(|(place, value)| self.add(place, value));
    }

    pub fn append(&mut self, more: &Self) {
        let start = self.dof.len();
        self.ptr.extend(more.ptr[1..].iter().map(|end| start + end));
        self.dof.extend(&more.dof);
        self.val.extend(&more.val);
        self.rhs.extend(&more.rhs);
    }

    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        (self.ptr[i]..self.ptr[i + 1]).map(|at| (self.dof[at] as usize, self.val[at]))
    }
}
