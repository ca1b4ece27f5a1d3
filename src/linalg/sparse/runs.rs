//! Sparse matrices by rows whose columns form runs, as in G', where the motions of a body are consecutive. A run stores
//! only its first column, and long loops are divided into parts.

use std::ops::Range;

use crate::error::Result;
use crate::linalg::vector::LONG;
use crate::linalg::Csr;
use crate::platform::memory::reserved;
use crate::platform::threads::{parts, parts_of};

/// Least number of rows in a part of a loop: shorter loops are one part, in the order of the rows.
const PART: usize = LONG;
/// Limit of columns in a run: the number of motions of a body in 3D.
const WIDTH: usize = 6;
/// Limit of parts: each keeps a separate sum over all columns.
const PARTS: usize = 16;

#[derive(Default)]
pub struct Runs {
    cols: usize,
    /// Row i has the runs `ptr[i]..ptr[i+1]`.
    ptr: Vec<usize>,
    /// First column of each run.
    column: Vec<u32>,
    /// Run k has the values `start[k]..start[k+1]`.
    start: Vec<usize>,
    val: Vec<f64>,
}

impl Runs {
    pub fn of(matrix: &Csr) -> Result<Self> {
        const WHAT: &str = "the coarse matrix";
        let count = begins(matrix).count();
        let (mut ptr, mut column) = (reserved(matrix.ptr.len(), WHAT)?, reserved(count, WHAT)?);
        let (mut start, mut val) = (reserved(count + 1, WHAT)?, reserved(matrix.val.len(), WHAT)?);
        ptr.push(0);
        for (row, at) in begins(matrix) {
            ptr.resize(row + 1, column.len());
            column.push(matrix.col[at] as u32);
            start.push(at);
        }
        ptr.resize(matrix.ptr.len(), column.len());
        start.push(matrix.val.len());
        val.extend_from_slice(&matrix.val);
        Ok(Self { cols: matrix.cols, ptr, column, start, val })
    }

    pub fn rows(&self) -> usize {
        self.ptr.len() - 1
    }

    /// Whether the matrix has these entries, bit by bit.
    pub fn is_of(&self, matrix: &Csr) -> bool {
        let columns = (0..self.rows()).map(|i| {
            let of = |k: usize| (self.column[k] as usize..).take(self.start[k + 1] - self.start[k]);
            (self.ptr[i]..self.ptr[i + 1]).flat_map(of)
        });
        (self.cols, self.rows(), self.val.len()) == (matrix.cols, matrix.rows(), matrix.val.len())
            && self.val.iter().zip(&matrix.val).all(|(a, b)| a.to_bits() == b.to_bits())
            && columns.enumerate().all(|(i, own)| own.eq(matrix.row(i).map(|(j, _)| j)))
    }

    /// Values of the runs of row i, each with its first column.
    #[inline]
    fn row(&self, i: usize) -> impl Iterator<Item = (&[f64], usize)> {
        (self.ptr[i]..self.ptr[i + 1])
            .map(|k| (&self.val[self.start[k]..self.start[k + 1]], self.column[k] as usize))
    }

    /// `(A x)_i`
    #[inline]
    pub fn row_dot(&self, i: usize, x: &[f64]) -> f64 {
        let mut sum = -0.0;
        for (values, column) in self.row(i) {
            let x = &x[column..column + values.len()];
            match (values.first_chunk::<WIDTH>(), x.first_chunk::<WIDTH>()) {
                (Some(values), Some(x)) => (0..WIDTH).for_each(|k| sum += values[k] * x[k]),
                _ => values.iter().zip(x).for_each(|(v, x)| sum += v * x),
            }
        }
        sum
    }

    /// `(|A| |x|)_i`
    pub fn row_dot_abs(&self, i: usize, x: &[f64]) -> f64 {
        let mut sum = -0.0;
        for (values, column) in self.row(i) {
            values.iter().zip(&x[column..]).for_each(|(v, x)| sum += (v * x).abs());
        }
        sum
    }

    #[inline]
    fn add_row(&self, i: usize, a: f64, y: &mut [f64]) {
        for (values, column) in self.row(i) {
            let y = &mut y[column..column + values.len()];
            match (values.first_chunk::<WIDTH>(), y.first_chunk_mut::<WIDTH>()) {
                (Some(values), Some(y)) => (0..WIDTH).for_each(|k| y[k] += a * values[k]),
                _ => y.iter_mut().zip(values).for_each(|(y, v)| *y += a * v),
            }
        }
    }

    /// Row ranges of the parts of a loop over all rows: equal for any number of threads.
    fn cut(&self) -> Vec<Range<usize>> {
        let rows = self.rows();
        let each = rows.div_ceil(PARTS).max(PART);
        (0..rows.div_ceil(each)).map(|k| k * each..rows.min((k + 1) * each)).collect()
    }

    /// `A' x`
    pub fn mul_transposed(&self, x: &[f64]) -> Vec<f64> {
        self.mul_transposed_add(1.0, x, vec![0.0; self.cols])
    }

    /// `y + a A' x`
    pub fn mul_transposed_add(&self, a: f64, x: &[f64], mut y: Vec<f64>) -> Vec<f64> {
        let cut = self.cut();
        let add = |rows: &Range<usize>, y: &mut [f64]| {
            rows.clone().filter(|&i| x[i] != 0.0).for_each(|i| self.add_row(i, a * x[i], y));
        };
        if let [rows] = &cut[..] {
            add(rows, &mut y);
            return y;
        }
        let images = parts(cut.len(), |k| {
            let mut image = vec![0.0; self.cols];
            add(&cut[k], &mut image);
            image
        });
        images.iter().for_each(|image| y.iter_mut().zip(image).for_each(|(y, v)| *y += v));
        y
    }

    /// `|A|' |x|`
    pub fn mul_transposed_abs(&self, x: &[f64]) -> Vec<f64> {
        let cut = self.cut();
        self.sum(parts(cut.len(), |k| {
            let mut y = vec![0.0; self.cols];
            for i in cut[k].clone() {
                for (values, column) in self.row(i) {
                    y[column..].iter_mut().zip(values).for_each(|(y, v)| *y += (x[i] * v).abs());
                }
            }
            y
        }))
    }

    /// Computes a vector over the rows, entry by entry.
    pub fn each_row(&self, of: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        let mut y = vec![0.0; self.rows()];
        self.change_rows(&mut y, |i, y| *y = of(i));
        y
    }

    /// Changes a vector over the rows, entry by entry.
    pub fn change_rows(&self, y: &mut [f64], change: impl Fn(usize, &mut f64) + Sync) {
        parts_of(self.pieces(y), |_, (rows, y)| rows.zip(y).for_each(|(i, y)| change(i, y)));
    }

    /// `rest = v - A x` on rows that are not held, other rows do not change; returns `A' rest` of these rows. Every row
    /// is read once for both.
    pub fn residual(&self, held: &[bool], v: &[f64], x: &[f64], rest: &mut [f64]) -> Vec<f64> {
        self.sum(parts_of(self.pieces(rest), |_, (rows, rest)| {
            let mut image = vec![0.0; self.cols];
            for (i, rest) in rows.zip(rest).filter(|(i, _)| !held[*i]) {
                *rest = v[i] - self.row_dot(i, x);
                self.add_row(i, *rest, &mut image);
            }
            image
        }))
    }

    /// A vector over the rows, divided into the parts.
    fn pieces<'a>(&self, mut y: &'a mut [f64]) -> Vec<(Range<usize>, &'a mut [f64])> {
        let piece = |rows: Range<usize>| {
            let (own, rest) = std::mem::take(&mut y).split_at_mut(rows.len());
            y = rest;
            (rows, own)
        };
        self.cut().into_iter().map(piece).collect()
    }

    fn sum(&self, images: Vec<Vec<f64>>) -> Vec<f64> {
        let mut images = images.into_iter();
        let mut sum = images.next().unwrap_or_else(|| vec![0.0; self.cols]);
        images.for_each(|image| sum.iter_mut().zip(image).for_each(|(sum, v)| *sum += v));
        sum
    }
}

/// The row of every run and its first entry.
fn begins(matrix: &Csr) -> impl Iterator<Item = (usize, usize)> + '_ {
    (0..matrix.rows()).flat_map(move |row| {
        let (entries, mut begin) = (matrix.ptr[row]..matrix.ptr[row + 1], None);
        entries.filter_map(move |at| {
            let goes_on = |begin: usize| at < begin + WIDTH && matrix.col[at] == matrix.col[at - 1] + 1;
            if begin.is_some_and(goes_on) {
                return None;
            }
            begin = Some(at);
            Some((row, at))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::threads::with_team;

    /// Rows with two runs, with one run, and without entries, repeated.
    fn matrix(rows: usize) -> Csr {
        let mut a = Csr::empty(9);
        for i in 0..rows {
            let value = |k: usize| (1.0 + (i * 9 + k) as f64).sin();
            let columns: &[usize] = [&[0, 1, 2, 5, 6][..], &[3, 4], &[]][i % 3];
            a.push_row(columns.iter().map(|&k| (k, value(k))));
        }
        a
    }

    #[test]
    fn products_have_the_bits_of_those_entry_by_entry() {
        let a = matrix(100);
        let runs = Runs::of(&a).unwrap();
        let (x, v): (Vec<f64>, Vec<f64>) =
            ((0..9).map(|k| (k as f64).cos()).collect(), (0..100).map(|i| (i as f64).sin()).collect());
        assert!((0..100).all(|i| runs.row_dot(i, &x).to_bits() == a.row_dot(i, &x).to_bits()));
        assert!((0..100).all(|i| runs.row_dot_abs(i, &x) == a.row_dot_abs(i, &x)));
        assert_eq!(runs.mul_transposed(&v), a.mul_transposed(&v));
        let mut terms = vec![0.0; 9];
        a.mul_transposed_abs_add(&v, &mut terms);
        assert_eq!(runs.mul_transposed_abs(&v), terms);
        let held: Vec<bool> = (0..100).map(|i| i % 5 == 2).collect();
        let mut rest = vec![7.0; 100];
        let image = runs.residual(&held, &v, &x, &mut rest);
        let expected: Vec<f64> =
            (0..100).map(|i| if held[i] { 7.0 } else { v[i] - a.row_dot(i, &x) }).collect();
        assert_eq!(rest, expected);
        let free: Vec<f64> = (0..100).map(|i| if held[i] { 0.0 } else { rest[i] }).collect();
        assert_eq!(image, a.mul_transposed(&free));
    }

    #[test]
    fn long_products_have_the_same_bits_on_any_number_of_threads() {
        let a = matrix(3 * PART + 5);
        let runs = Runs::of(&a).unwrap();
        let x: Vec<f64> = (0..a.rows()).map(|i| (i as f64).sin()).collect();
        let [one, two] = [1, 2].map(|threads| with_team(threads, || runs.mul_transposed(&x)));
        assert_eq!(one, two);
        let whole = a.mul_transposed(&x);
        assert!(one.iter().zip(&whole).all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs().max(1.0)));
    }
}
