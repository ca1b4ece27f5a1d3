//! Symmetric sparse matrices: the lower triangle by rows.

use crate::error::Result;
use crate::linalg::memory::copied;
use crate::linalg::Operator;

/// Symmetric `n x n`; row i holds the entries with column <= i, ascending, the diagonal last.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetric {
    pub ptr: Vec<usize>,
    pub col: Vec<usize>,
    pub val: Vec<f64>,
}

impl Symmetric {
    pub fn order(&self) -> usize {
        self.ptr.len() - 1
    }

    /// Entries `(column, value)` of row `i` of the lower triangle, the diagonal last.
    pub fn lower_row(&self, i: usize) -> impl DoubleEndedIterator<Item = (usize, f64)> + '_ {
        let range = self.ptr[i]..self.ptr[i + 1];
        self.col[range.clone()].iter().copied().zip(self.val[range].iter().copied())
    }

    /// `K_ii`
    pub fn diagonal(&self, i: usize) -> f64 {
        self.val[self.ptr[i + 1] - 1]
    }

    /// `D_ii` of the metric in which all of K is measured: `K_ii`, or `without` for a dof that has no stiffness.
    pub fn metric(&self, i: usize, without: f64) -> f64 {
        let diagonal = self.diagonal(i);
        if diagonal > 0.0 {
            diagonal
        } else {
            without
        }
    }

    /// `a K`
    pub fn scaled(&self, a: f64) -> Result<Self> {
        let mut val = copied(&self.val, "a scaled stiffness matrix")?;
        val.iter_mut().for_each(|v| *v *= a);
        Ok(Self {
            ptr: copied(&self.ptr, "a scaled stiffness matrix")?,
            col: copied(&self.col, "a scaled stiffness matrix")?,
            val,
        })
    }

    /// `y = K x`
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        self.accumulate(x, y, |v| v);
    }

    /// `y = |K| |x|`: what rounding errors of `K x` are measured against.
    pub fn mul_abs(&self, x: &[f64], y: &mut [f64]) {
        self.accumulate(x, y, f64::abs);
    }

    fn accumulate(&self, x: &[f64], y: &mut [f64], of: impl Fn(f64) -> f64) {
        y.fill(0.0);
        for i in 0..self.order() {
            let (off, last) = (self.ptr[i], self.ptr[i + 1] - 1);
            let mut sum = of(self.val[last] * x[i]);
            for k in off..last {
                let j = self.col[k];
                sum += of(self.val[k] * x[j]);
                y[j] += of(self.val[k] * x[i]);
            }
            y[i] += sum;
        }
    }

    /// `max K_ii`
    pub fn largest_diagonal(&self) -> f64 {
        (0..self.order()).map(|i| self.diagonal(i)).fold(0.0, f64::max)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// [[2, -1, 0], [-1, 2, -1], [0, -1, 1]]
    fn chain() -> Symmetric {
        Symmetric { ptr: vec![0, 1, 3, 5], col: vec![0, 0, 1, 1, 2], val: vec![2.0, -1.0, 2.0, -1.0, 1.0] }
    }

    #[test]
    fn the_product_uses_both_triangles() {
        let mut y = [0.0; 3];
        chain().mul(&[1.0, 2.0, 4.0], &mut y);
        assert_eq!(y, [0.0, -1.0, 2.0]);
        chain().mul_abs(&[1.0, -2.0, 4.0], &mut y);
        assert_eq!(y, [4.0, 9.0, 6.0]);
    }
}
