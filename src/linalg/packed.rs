//! Dense symmetric matrices, the lower triangle packed by rows: local dual operators F_p.

use crate::error::Result;
use crate::linalg::memory::zeros;
use crate::linalg::{Entries, Matrix, Operator};

/// Symmetric `m x m`; entry (i, j), j <= i, at `i (i + 1) / 2 + j`.
#[derive(Debug, Clone, PartialEq)]
pub struct Packed {
    order: usize,
    data: Vec<f64>,
}

impl Packed {
    /// Bytes a packed matrix of this order takes.
    pub fn bytes(order: usize) -> usize {
        order.saturating_mul(order + 1) / 2 * size_of::<f64>()
    }

    pub fn zeros(order: usize) -> Result<Self> {
        let len = order.saturating_mul(order + 1) / 2;
        Ok(Self { order, data: zeros(len, "an explicit dual operator")? })
    }

    /// `A_ij += value`, any order of i and j.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let (i, j) = (i.max(j), i.min(j));
        self.data[i * (i + 1) / 2 + j] += value;
    }

    /// `A <- -A`
    pub fn negate(&mut self) {
        self.data.iter_mut().for_each(|v| *v = -*v);
    }

    pub fn get(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        self.data[i * (i + 1) / 2 + j]
    }
}

impl Operator for Packed {
    fn order(&self) -> usize {
        self.order
    }

    /// `y = A x`, every entry read once.
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        let mut start = 0;
        for i in 0..self.order {
            let (row, diagonal) = (&self.data[start..start + i], self.data[start + i]);
            let xi = x[i];
            let mut sum = diagonal * xi;
            for ((a, x), y) in row.iter().zip(x).zip(y.iter_mut()) {
                sum += a * x;
                *y += a * xi;
            }
            y[i] += sum;
            start += i + 1;
        }
    }

    fn bytes_kept(&self) -> usize {
        size_of_val(&self.data[..])
    }
}

impl Entries for Packed {
    fn add_block(&self, rows: &[usize], block: &mut Matrix) -> Result<()> {
        for (l, &j) in rows.iter().enumerate() {
            let column = block.col_mut(l);
            rows.iter().enumerate().skip(l).for_each(|(k, &i)| column[k] += self.get(i, j));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_packed_product_equals_the_full_one() {
        let mut a = Packed::zeros(3).unwrap();
        for (i, j, v) in [(0, 0, 2.0), (0, 1, -1.0), (1, 1, 3.0), (2, 0, 5.0), (2, 2, 1.0)] {
            a.add(i, j, v);
        }
        let mut y = [0.0; 3];
        a.apply(&[1.0, 2.0, 3.0], &mut y);
        assert_eq!(y, [15.0, 5.0, 8.0]);
        assert_eq!(a.get(0, 2), 5.0);
    }
}
