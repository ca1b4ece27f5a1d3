//! Sparse matrices by rows: constraint rows B, H and the coarse matrix G'.

use crate::error::Result;
use crate::platform::memory::{reserved, zeros};

/// `rows x cols`; row i holds entries `ptr[i]..ptr[i+1]`, columns ascending.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Csr {
    pub cols: usize,
    pub ptr: Vec<usize>,
    pub col: Vec<usize>,
    pub val: Vec<f64>,
}

impl Csr {
    /// No rows yet.
    pub fn empty(cols: usize) -> Self {
        Self { cols, ptr: vec![0], col: Vec::new(), val: Vec::new() }
    }

    pub fn rows(&self) -> usize {
        self.ptr.len() - 1
    }

    /// Appends one row; `entries` with ascending columns.
    pub fn push_row(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        for (col, val) in entries {
            self.col.push(col);
            self.val.push(val);
        }
        self.ptr.push(self.col.len());
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
        let mut ptr = reserved(self.cols + 1, "a transposed matrix")?;
        ptr.resize(self.cols + 1, 0);
        for &j in &self.col {
            ptr[j + 1] += 1;
        }
        for j in 0..self.cols {
            ptr[j + 1] += ptr[j];
        }
        let mut next = ptr.clone();
        let mut col = reserved(self.col.len(), "a transposed matrix")?;
        col.resize(self.col.len(), 0);
        let mut val = zeros(self.val.len(), "a transposed matrix")?;
        for i in 0..self.rows() {
            for (j, v) in self.row(i) {
                col[next[j]] = i;
                val[next[j]] = v;
                next[j] += 1;
            }
        }
        Ok(Self { cols: self.rows(), ptr, col, val })
    }
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
