//! Symmetric sparse matrices: the lower triangle by rows; and a multiple of such a matrix without a copy.

use std::array;
use std::sync::{Arc, OnceLock};

use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{as_arrays, as_arrays_mut};
use crate::linalg::{Array, Matrix, Operator};
use crate::platform::memory::{copied, reserved};

/// Number of columns processed in one pass over the matrix.
const TOGETHER: usize = 8;

/// Symmetric `n x n`; row i holds the entries with column <= i, ascending, the diagonal last.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetric {
    pub ptr: Vec<usize>,
    /// 32 bits: a matrix has less than 2^32 rows.
    pub col: Array<u32>,
    pub val: Array<f64>,
    /// The metric of a matrix that is no semidefinite one by some entry; of others it is the diagonal, and this is empty.
    raised: OnceLock<Vec<f64>>,
}

impl Symmetric {
    pub fn new(ptr: Vec<usize>, col: impl Into<Array<u32>>, val: impl Into<Array<f64>>) -> Self {
        Self { ptr, col: col.into(), val: val.into(), raised: OnceLock::new() }
    }

    /// Replaces the values, and returns the old ones.
    pub fn replace_values(&mut self, val: impl Into<Array<f64>>) -> Array<f64> {
        self.raised = OnceLock::new();
        std::mem::replace(&mut self.val, val.into())
    }

    /// A matrix without rows.
    pub fn empty() -> Self {
        Self::new(vec![0], Vec::new(), Vec::new())
    }

    /// An empty matrix with this capacity.
    pub fn with_room(rows: usize, entries: usize, what: &str) -> Result<Self> {
        let mut ptr = reserved(rows + 1, what)?;
        ptr.push(0);
        Ok(Self::new(ptr, reserved(entries, what)?, reserved(entries, what)?))
    }

    /// Appends a row of the lower triangle, columns ascending.
    pub fn push_row(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        let (col, val) = (self.col.to_mut(), self.val.to_mut());
        for (j, v) in entries {
            col.push(j as u32);
            val.push(v);
        }
        self.ptr.push(col.len());
    }

    pub fn order(&self) -> usize {
        self.ptr.len() - 1
    }

    /// Entries `(column, value)` of row `i` of the lower triangle, the diagonal last.
    pub fn lower_row(&self, i: usize) -> impl DoubleEndedIterator<Item = (usize, f64)> + '_ {
        let range = self.ptr[i]..self.ptr[i + 1];
        self.col[range.clone()].iter().map(|&j| j as usize).zip(self.val[range].iter().copied())
    }

    /// `K_ii`
    pub fn diagonal(&self, i: usize) -> f64 {
        self.val[self.ptr[i + 1] - 1]
    }

    /// `D_ii` of the metric for K: `K_ii`, or `without` for a dof without stiffness. For soft motions, which may leave 0 or
    /// less on the diagonal, `|K_ii|`, but no less than `K_ij^2 <= 4 D_ii D_jj` requires.
    pub fn metric(&self, i: usize, without: f64) -> f64 {
        let raised = self.raised.get_or_init(|| self.raised()).get(i);
        let value = raised.copied().unwrap_or_else(|| self.diagonal(i).abs());
        Some(value).filter(|value| *value > 0.0).unwrap_or(without)
    }

    fn raised(&self) -> Vec<f64> {
        let own = |i: usize| self.diagonal(i).abs();
        let mut raised = Vec::new();
        for i in 0..self.order() {
            for (j, v) in self.lower_row(i).map(|(j, v)| (j, v.abs())).filter(|entry| entry.0 < i) {
                let (low, high) = (own(i).min(own(j)), own(i).max(own(j)));
                if v > 2.0 * low && v * (v / high) > 4.0 * low {
                    if raised.is_empty() {
                        raised.extend((0..self.order()).map(own));
                    }
                    raised[i] = raised[i].max(v * (v / own(j)).min(1.0));
                    raised[j] = raised[j].max(v * (v / own(i)).min(1.0));
                }
            }
        }
        raised
    }

    /// Bytes that the library keeps for the matrix.
    pub fn bytes(&self) -> usize {
        self.ptr.capacity() * size_of::<usize>() + self.col.bytes() + self.val.bytes()
    }

    /// A copy; `what` names it in errors.
    pub fn copied(&self, what: &str) -> Result<Self> {
        Ok(Self::new(copied(&self.ptr, what)?, copied(&self.col, what)?, copied(&self.val, what)?))
    }

    /// `y = K x`
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        self.accumulate(1.0, x, y);
    }

    /// `y = K x` and `terms = |K| |x|`, to which rounding errors of `K x` are relative.
    pub fn mul_with_terms(&self, x: &[f64], y: &mut [f64], terms: &mut [f64]) {
        self.accumulate_with_terms(1.0, x, y, terms);
    }

    /// `y = by K x`
    fn accumulate(&self, by: f64, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for i in 0..self.order() {
            let (off, last) = (self.ptr[i], self.ptr[i + 1] - 1);
            let mut sum = by * self.val[last] * x[i];
            for (&j, &k_ij) in self.col[off..last].iter().zip(&self.val[off..last]) {
                let (j, k_ij) = (j as usize, by * k_ij);
                sum += k_ij * x[j];
                y[j] += k_ij * x[i];
            }
            y[i] += sum;
        }
    }

    /// `y += by K x` in double-double arithmetic; `by` is a power of two.
    pub fn add_twofold(&self, by: f64, x: &[f64], y: &mut [Twofold]) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("fma") {
            // SAFETY: the processor has FMA
            return unsafe { self.add_twofold_by_fma(by, x, y) };
        }
        self.add_twofold_by(by, x, y);
    }

    /// The instruction in place of a call for every product: equal bits.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "fma")]
    unsafe fn add_twofold_by_fma(&self, by: f64, x: &[f64], y: &mut [Twofold]) {
        self.add_twofold_by(by, x, y);
    }

    #[inline(always)]
    fn add_twofold_by(&self, by: f64, x: &[f64], y: &mut [Twofold]) {
        for i in 0..self.order() {
            let last = self.ptr[i + 1] - 1;
            for at in self.ptr[i]..last {
                let (j, k_ij) = (self.col[at] as usize, by * self.val[at]);
                y[i].add_product(k_ij, x[j]);
                y[j].add_product(k_ij, x[i]);
            }
            y[i].add_product(by * self.val[last], x[i]);
        }
    }

    /// `y = by K x`, `terms = |by K| |x|`
    fn accumulate_with_terms(&self, by: f64, x: &[f64], y: &mut [f64], terms: &mut [f64]) {
        y.fill(0.0);
        terms.fill(0.0);
        self.accumulate_rows::<1>(by, as_arrays(x).0, as_arrays_mut(y).0, as_arrays_mut(terms).0);
    }

    /// As `accumulate_with_terms`, for several columns, given and returned by rows; y and terms are zero on entry. The
    /// vector instructions of the processor give equal bits.
    fn accumulate_rows<const N: usize>(
        &self,
        by: f64,
        x: &[[f64; N]],
        y: &mut [[f64; N]],
        terms: &mut [[f64; N]],
    ) {
        #[cfg(target_arch = "x86_64")]
        if N > 1 && std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2
            return unsafe { self.accumulate_rows_by_avx2(by, x, y, terms) };
        }
        self.accumulate_rows_by(by, x, y, terms);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    unsafe fn accumulate_rows_by_avx2<const N: usize>(
        &self,
        by: f64,
        x: &[[f64; N]],
        y: &mut [[f64; N]],
        terms: &mut [[f64; N]],
    ) {
        self.accumulate_rows_by(by, x, y, terms);
    }

    #[inline(always)]
    fn accumulate_rows_by<const N: usize>(
        &self,
        by: f64,
        x: &[[f64; N]],
        y: &mut [[f64; N]],
        terms: &mut [[f64; N]],
    ) {
        for i in 0..self.order() {
            let (off, last) = (self.ptr[i], self.ptr[i + 1] - 1);
            let (diagonal, x_i) = (by * self.val[last], x[i]);
            let mut sum: [f64; N] = array::from_fn(|c| diagonal * x_i[c]);
            let mut size = sum.map(f64::abs);
            for (&j, &k_ij) in self.col[off..last].iter().zip(&self.val[off..last]) {
                let k_ij = by * k_ij;
                let (x_j, y_j, t_j) = (x[j as usize], &mut y[j as usize], &mut terms[j as usize]);
                for c in 0..N {
                    let (own, mate) = (k_ij * x_j[c], k_ij * x_i[c]);
                    sum[c] += own;
                    size[c] += own.abs();
                    y_j[c] += mate;
                    t_j[c] += mate.abs();
                }
            }
            for c in 0..N {
                y[i][c] += sum[c];
                terms[i][c] += size[c];
            }
        }
    }

    /// `max D_ii` of the metric, `max K_ii` without soft motions.
    pub fn largest_diagonal(&self) -> f64 {
        (0..self.order()).map(|i| self.metric(i, 0.0)).fold(0.0, f64::max)
    }
}

impl Operator for Symmetric {
    fn order(&self) -> usize {
        self.ptr.len() - 1
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.mul(x, y);
    }

    fn bytes_kept(&self) -> usize {
        size_of_val(&self.ptr[..]) + size_of_val(&self.col[..]) + size_of_val(&self.val[..])
    }
}

/// `by K`: gives the bits of a copy with every entry multiplied, without a copy. A power of two `by` changes only
/// exponents.
#[derive(Debug, Clone)]
pub struct Multiple {
    pub matrix: Arc<Symmetric>,
    pub by: f64,
}

impl From<Symmetric> for Multiple {
    fn from(matrix: Symmetric) -> Self {
        Self { matrix: Arc::new(matrix), by: 1.0 }
    }
}

impl Multiple {
    pub fn order(&self) -> usize {
        self.matrix.order()
    }

    /// Entries of row `i` of the lower triangle, the diagonal last.
    pub fn lower_row(&self, i: usize) -> impl DoubleEndedIterator<Item = (usize, f64)> + '_ {
        self.matrix.lower_row(i).map(|(j, v)| (j, self.by * v))
    }

    /// The metric of the multiple; `without` is not multiplied.
    pub fn metric(&self, i: usize, without: f64) -> f64 {
        Some(self.by * self.matrix.metric(i, 0.0)).filter(|diagonal| *diagonal > 0.0).unwrap_or(without)
    }

    /// Square roots of the metric, 1 for a dof without stiffness.
    pub fn roots(&self) -> Result<Vec<f64>> {
        let mut roots = reserved(self.order(), "the metric of a body")?;
        roots.extend((0..self.order()).map(|i| self.metric(i, 1.0).sqrt()));
        Ok(roots)
    }

    /// `y = by K x`
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        self.matrix.accumulate(self.by, x, y);
    }

    /// `y = by K x`, `terms = |by K| |x|`
    pub fn mul_with_terms(&self, x: &[f64], y: &mut [f64], terms: &mut [f64]) {
        self.matrix.accumulate_with_terms(self.by, x, y, terms);
    }

    /// `by K X` and `|by K| |X|` of the columns of X, n x r each.
    pub fn mul_columns(&self, x: &Matrix) -> Result<(Matrix, Matrix)> {
        const WHAT: &str = "products with a stiffness matrix";
        let (mut y, mut terms) = (Matrix::zeros(x.rows, x.cols)?, Matrix::zeros(x.rows, x.cols)?);
        let mut rows: [Vec<[f64; TOGETHER]>; 3] =
            [reserved(x.rows, WHAT)?, reserved(x.rows, WHAT)?, reserved(x.rows, WHAT)?];
        for first in (0..x.cols).step_by(TOGETHER) {
            let columns = first..x.cols.min(first + TOGETHER);
            rows.iter_mut().for_each(|rows| {
                rows.clear();
                rows.resize(x.rows, [0.0; TOGETHER]);
            });
            let [given, image, sizes] = &mut rows;
            for (c, j) in columns.clone().enumerate() {
                given.iter_mut().zip(x.col(j)).for_each(|(row, v)| row[c] = *v);
            }
            self.matrix.accumulate_rows(self.by, given, image, sizes);
            for (c, j) in columns.enumerate() {
                y.col_mut(j).iter_mut().zip(image.iter()).for_each(|(v, row)| *v = row[c]);
                terms.col_mut(j).iter_mut().zip(sizes.iter()).for_each(|(v, row)| *v = row[c]);
            }
        }
        Ok((y, terms))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// [[2, -1, 0], [-1, 2, -1], [0, -1, 1]]
    fn chain() -> Symmetric {
        Symmetric::new(vec![0, 1, 3, 5], vec![0, 0, 1, 1, 2], vec![2.0, -1.0, 2.0, -1.0, 1.0])
    }

    #[test]
    fn the_product_uses_both_triangles() {
        let mut y = [0.0; 3];
        chain().mul(&[1.0, 2.0, 4.0], &mut y);
        assert_eq!(y, [0.0, -1.0, 2.0]);
        let mut terms = [0.0; 3];
        chain().mul_with_terms(&[1.0, -2.0, 4.0], &mut y, &mut terms);
        assert_eq!((y, terms), ([4.0, -9.0, 6.0], [4.0, 9.0, 6.0]));
    }

    #[test]
    fn a_product_in_twice_the_digits_keeps_what_cancels() {
        let mut left = [Twofold::from(1e16), Twofold::default(), Twofold::from(-1e16)];
        chain().add_twofold(-1.0, &[1e16 / 2.0, 0.5, -1e16], &mut left);
        assert_eq!(left.map(Twofold::value), [0.5, -1e16 / 2.0 - 1.0, 0.5]);
    }

    /// Also if a value of the copy underflows.
    #[test]
    fn a_multiple_has_the_bits_of_a_copy() {
        for by in [0.5_f64.powi(37), 0.5_f64.powi(1070), 3.0] {
            let mut copy = chain();
            copy.val.iter_mut().for_each(|v| *v = by * (*v / 3.0));
            let mut matrix = chain();
            matrix.val.iter_mut().for_each(|v| *v /= 3.0);
            let multiple = Multiple { by, ..matrix.into() };
            let x = [0.3, -2e150, 7.1];
            let (mut y, mut terms) = ([[0.0; 3]; 2], [[0.0; 3]; 2]);
            copy.mul_with_terms(&x, &mut y[0], &mut terms[0]);
            multiple.mul_with_terms(&x, &mut y[1], &mut terms[1]);
            assert_eq!((y[0], terms[0]), (y[1], terms[1]));
            multiple.mul(&x, &mut y[1]);
            assert_eq!(y[0], y[1]);
            for i in 0..3 {
                assert_eq!(multiple.metric(i, 1.0), copy.metric(i, 1.0));
                assert!(multiple.lower_row(i).eq(copy.lower_row(i)));
            }
        }
    }

    #[test]
    fn products_with_many_columns_have_the_bits_of_those_with_one() {
        let multiple = Multiple { by: 0.25, ..chain().into() };
        for cols in [0, 1, TOGETHER, 2 * TOGETHER + 1] {
            let mut x = Matrix::zeros(3, cols).unwrap();
            x.data.iter_mut().enumerate().for_each(|(at, v)| *v = (at as f64).sin());
            let (y, terms) = multiple.mul_columns(&x).unwrap();
            let (mut image, mut sizes) = ([0.0; 3], [0.0; 3]);
            for j in 0..cols {
                multiple.mul_with_terms(x.col(j), &mut image, &mut sizes);
                assert_eq!((y.col(j), terms.col(j)), (&image[..], &sizes[..]));
            }
        }
    }
}
