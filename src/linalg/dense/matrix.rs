//! Small dense matrices: null spaces (n x r, r a handful) and coarse matrices (r x r).

use std::ops::Range;

use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm};
use crate::platform::memory::zeros;
use crate::ranks::wire_struct;

/// `rows x cols`, column-major.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Matrix {
    pub rows: usize,
    pub cols: usize,
    pub data: Vec<f64>,
}

wire_struct!(Matrix { rows, cols, data });

impl Matrix {
    pub fn zeros(rows: usize, cols: usize) -> Result<Self> {
        Ok(Self { rows, cols, data: zeros(rows.saturating_mul(cols), "a dense matrix")? })
    }

    /// With `entry(i, j)` in row i of column j.
    pub fn from_fn(rows: usize, cols: usize, entry: impl Fn(usize, usize) -> f64) -> Result<Self> {
        let mut matrix = Self::zeros(rows, cols)?;
        for j in 0..cols {
            matrix.col_mut(j).iter_mut().enumerate().for_each(|(i, v)| *v = entry(i, j));
        }
        Ok(matrix)
    }

    /// A range of consecutive columns.
    pub fn columns(&self, range: Range<usize>) -> Self {
        let data = self.data[range.start * self.rows..range.end * self.rows].to_vec();
        Self { rows: self.rows, cols: range.len(), data }
    }

    pub fn col(&self, j: usize) -> &[f64] {
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    pub fn col_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.data[j * self.rows..(j + 1) * self.rows]
    }

    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.data[i + j * self.rows]
    }

    pub fn set(&mut self, i: usize, j: usize, value: f64) {
        self.data[i + j * self.rows] = value;
    }

    /// Appends a column.
    pub fn push_col(&mut self, column: &[f64]) {
        debug_assert_eq!(column.len(), self.rows);
        self.data.extend_from_slice(column);
        self.cols += 1;
    }

    /// Appends the columns of a matrix with equally many rows.
    pub fn push_cols(&mut self, other: &Matrix) {
        (0..other.cols).for_each(|j| self.push_col(other.col(j)));
    }

    /// Appends the columns of a matrix with these rows; other rows are 0.
    pub fn push_part(&mut self, part: &Matrix, rows: &[usize]) {
        for j in 0..part.cols {
            let mut column = vec![0.0; self.rows];
            rows.iter().zip(part.col(j)).for_each(|(&row, v)| column[row] = *v);
            self.push_col(&column);
        }
    }

    /// `A T` in these rows, in the first columns; T is square.
    pub fn turn_rows(&mut self, turn: &Matrix) {
        let mut row = vec![0.0; turn.cols];
        for i in 0..self.rows {
            (0..turn.cols)
                .for_each(|b| row[b] = (0..turn.rows).map(|a| self.get(i, a) * turn.get(a, b)).sum());
            (0..turn.cols).for_each(|b| self.set(i, b, row[b]));
        }
    }

    /// `y += a A x`
    pub fn mul_add(&self, a: f64, x: &[f64], y: &mut [f64]) {
        for (j, x) in x.iter().enumerate() {
            axpy(a * x, self.col(j), y);
        }
    }

    /// `A' x`
    pub fn mul_transposed(&self, x: &[f64]) -> Vec<f64> {
        (0..self.cols).map(|j| dot(self.col(j), x)).collect()
    }

    /// Basis of the column space in which every vector has a 1 in a row where all others have 0: unconnected parts get
    /// separate vectors. Entries below `drop` times the largest are rounding. The columns must be independent.
    pub fn reduced(mut self, drop: f64) -> Self {
        let mut pivots = Vec::with_capacity(self.cols);
        for j in 0..self.cols {
            let size = |i: &usize| self.col(j)[*i].abs();
            let pivot = (0..self.rows).fold(0, |best, i| if size(&i) > size(&best) { i } else { best });
            let value = self.get(pivot, j);
            self.col_mut(j).iter_mut().for_each(|v| *v /= value);
            let column = self.col(j).to_vec();
            for other in (0..self.cols).filter(|other| *other != j) {
                let part = self.get(pivot, other);
                if part == 0.0 {
                    continue;
                }
                axpy(-part, &column, self.col_mut(other));
                self.set(pivot, other, 0.0);
            }
            pivots.push(pivot);
        }
        let mut order: Vec<usize> = (0..self.cols).collect();
        order.sort_unstable_by_key(|&j| pivots[j]);
        let mut sorted = Self { rows: self.rows, ..Self::default() };
        for j in order {
            let smallest = drop * self.col(j).iter().fold(0.0f64, |largest, v| largest.max(v.abs()));
            let kept = self.col(j).iter().map(|v| if v.abs() > smallest { *v } else { 0.0 });
            sorted.push_col(&kept.collect::<Vec<f64>>());
        }
        sorted
    }

    /// Orthonormal basis of the column space: Gram-Schmidt, twice, the longest remaining column first. Columns are left
    /// out if less than `drop` of their length is left.
    pub fn orthonormalised(self, drop: f64) -> Self {
        self.orthonormalised_in_order(drop).0
    }

    /// The same, with the column that each vector of the basis comes from.
    pub fn orthonormalised_in_order(mut self, drop: f64) -> (Self, Vec<usize>) {
        for j in 0..self.cols {
            let length = norm(self.col(j));
            if length > 0.0 {
                self.col_mut(j).iter_mut().for_each(|v| *v /= length);
            }
        }
        self.spanned(drop)
    }

    /// The same without scaling: columns are left out if no more than the length `drop` is left.
    pub fn spanned(mut self, drop: f64) -> (Self, Vec<usize>) {
        let (mut basis, mut order) = (Self { rows: self.rows, ..Self::default() }, Vec::new());
        let mut left: Vec<usize> = (0..self.cols).collect();
        while let Some(at) = longest(&self, &left) {
            let j = left.remove(at);
            let mut column = self.col(j).to_vec();
            for q in 0..basis.cols {
                let part = dot(basis.col(q), &column);
                axpy(-part, basis.col(q), &mut column);
            }
            let rest = norm(&column);
            if rest <= drop {
                break;
            }
            column.iter_mut().for_each(|v| *v /= rest);
            for &k in &left {
                let part = dot(&column, self.col(k));
                axpy(-part, &column, self.col_mut(k));
            }
            basis.push_col(&column);
            order.push(j);
        }
        (basis, order)
    }
}

/// Position in `among` of the longest column; the first if several are equal.
fn longest(matrix: &Matrix, among: &[usize]) -> Option<usize> {
    let mut best = None;
    for (at, &j) in among.iter().enumerate() {
        let length = norm(matrix.col(j));
        if best.is_none_or(|(_, longest)| length > longest) {
            best = Some((at, length));
        }
    }
    best.map(|(at, _)| at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dependent_column_is_left_out_of_the_basis() {
        let a = Matrix { rows: 3, cols: 3, data: vec![1., 0., 0., 1., 1., 0., 2., 1., 0.] };
        let q = a.orthonormalised(1e-10);
        assert_eq!(q.cols, 2);
        for i in 0..2 {
            for j in 0..2 {
                let expected = f64::from(u8::from(i == j));
                assert!((dot(q.col(i), q.col(j)) - expected).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_reduced_basis_takes_apart_what_was_mixed() {
        // the span of (1, 1, 0, 0) and (0, 0, 1, -2), combined
        let mixed = Matrix { rows: 4, cols: 2, data: vec![1.0, 1.0, 3.0, -6.0, -2.0, -2.0, 0.1, -0.2] };
        let reduced = mixed.reduced(1e-12);
        assert_eq!(reduced.data, [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, -0.5, 1.0]);
    }
}
