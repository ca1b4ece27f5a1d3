//! Sparse matrices by rows: constraint rows B, H and the coarse matrix G'.

use crate::error::Result;
use crate::linalg::hash::{hash, same_bits, START};
use crate::platform::memory::{filled, zeros};

/// `rows x cols`; row i holds entries `ptr[i]..ptr[i+1]`, columns ascending.
#[derive(Debug, Clone, Default)]
pub struct Csr {
    pub cols: usize,
    pub ptr: Vec<usize>,
    pub col: Vec<usize>,
    pub val: Vec<f64>,
}

/// Equal bit by bit.
impl PartialEq for Csr {
    fn eq(&self, other: &Self) -> bool {
        let places = self.cols == other.cols && self.ptr == other.ptr && self.col == other.col;
        places && same_bits(&self.val, &other.val)
    }
}

impl Csr {
    /// A matrix without rows.
    pub fn empty(cols: usize) -> Self {
        Self { cols, ptr: vec![0], col: Vec::new(), val: Vec::new() }
    }

    /// A matrix without rows, with room for these numbers of rows and entries.
    pub fn with_room(cols: usize, rows: usize, entries: usize) -> Self {
        let mut ptr = Vec::with_capacity(rows + 1);
        ptr.push(0);
        Self { cols, ptr, col: Vec::with_capacity(entries), val: Vec::with_capacity(entries) }
    }

    pub fn rows(&self) -> usize {
        self.ptr.len() - 1
    }

    /// Hash key of the entries.
    pub fn key(&self) -> u64 {
        let places = self.ptr.iter().chain(&self.col).map(|&at| at as u64);
        hash(START, places.chain(self.val.iter().map(|v| v.to_bits())))
    }

    /// Appends one row; `entries` with ascending columns.
    pub fn push_row(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        for (col, val) in entries {
            self.col.push(col);
            self.val.push(val);
        }
        self.ptr.push(self.col.len());
    }

    /// Appends the rows of another matrix.
    pub fn append(&mut self, more: &Self) {
        let start = self.col.len();
        self.ptr.extend(more.ptr[1..].iter().map(|end| start + end));
        self.col.extend_from_slice(&more.col);
        self.val.extend_from_slice(&more.val);
    }

    /// Drops all rows but the first `count`.
    pub fn truncate(&mut self, count: usize) {
        self.ptr.truncate(count + 1);
        let entries = self.ptr.last().copied().unwrap_or(0);
        self.col.truncate(entries);
        self.val.truncate(entries);
    }

    /// Entries `(column, value)` of row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        let range = self.ptr[i]..self.ptr[i + 1];
        self.col[range.clone()].iter().copied().zip(self.val[range].iter().copied())
    }

    /// `(A x)_i`
    #[inline]
    pub fn row_dot(&self, i: usize, x: &[f64]) -> f64 {
        self.row(i).map(|(j, v)| v * x[j]).sum()
    }

    /// `(|A| |x|)_i`
    pub fn row_dot_abs(&self, i: usize, x: &[f64]) -> f64 {
        self.row(i).map(|(j, v)| (v * x[j]).abs()).sum()
    }

    /// `y = A x`
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        for (i, y) in y.iter_mut().enumerate() {
            *y = self.row_dot(i, x);
        }
    }

    /// `y += a A' x`
    pub fn mul_transposed_add(&self, a: f64, x: &[f64], y: &mut [f64]) {
        for (i, &x) in x.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            for (j, v) in self.row(i) {
                y[j] += a * x * v;
            }
        }
    }

    /// `A' x`
    pub fn mul_transposed(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.cols];
        self.mul_transposed_add(1.0, x, &mut y);
        y
    }

    /// `y += |A|' |x|`
    pub fn mul_transposed_abs_add(&self, x: &[f64], y: &mut [f64]) {
        for (i, x) in x.iter().enumerate() {
            for (j, v) in self.row(i) {
                y[j] += (x * v).abs();
            }
        }
    }

    /// `A'`
    pub fn transposed(&self) -> Result<Self> {
        let entries = || (0..self.rows()).flat_map(|i| self.row(i).map(move |(j, v)| (i, j, v)));
        let (ptr, col, val) = by_columns(self.cols, entries, "a transposed matrix")?;
        Ok(Self { cols: self.rows(), ptr, col, val })
    }
}

/// Sorts entries (row, column, value) by their n columns, in their given order within each column: start of each column,
/// rows, values.
pub fn by_columns<R: Copy + Default, I: Iterator<Item = (R, usize, f64)>>(
    n: usize,
    entries: impl Fn() -> I,
    what: &str,
) -> Result<(Vec<usize>, Vec<R>, Vec<f64>)> {
    let mut ptr = filled(n + 1, 0, what)?;
    entries().for_each(|(_, column, _)| ptr[column + 1] += 1);
    (0..n).for_each(|j| ptr[j + 1] += ptr[j]);
    let (mut row, mut val) = (filled(ptr[n], R::default(), what)?, zeros(ptr[n], what)?);
    for (i, j, v) in entries() {
        row[ptr[j]] = i;
        val[ptr[j]] = v;
        ptr[j] += 1;
    }
    // every start was advanced to the next one
    ptr.copy_within(0..n, 1);
    ptr[0] = 0;
    Ok((ptr, row, val))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_with_a_matrix_and_its_transpose_agree_with_hand() {
        let mut a = Csr::empty(3);
        a.push_row([(0, 1.0), (2, -2.0)]);
        a.push_row([(1, 3.0)]);
        let mut y = [0.0; 2];
        a.mul(&[1.0, 2.0, 3.0], &mut y);
        assert_eq!(y, [-5.0, 6.0]);
        let mut z = [1.0; 3];
        a.mul_transposed_add(2.0, &[1.0, -1.0], &mut z);
        assert_eq!(z, [3.0, -5.0, -3.0]);
        let t = a.transposed().unwrap();
        assert_eq!((t.rows(), t.row_dot(2, &[1.0, 1.0])), (3, -2.0));
    }
}
