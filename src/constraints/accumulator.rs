//! A sparse sum of rows that tracks its rounding.

use crate::error::Result;
use crate::platform::memory::zeros;

/// A sum is rounding if it is below this part of its terms.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A sum of rows, entry by entry.
pub struct Accumulator {
    value: Vec<f64>,
    /// Sums of the absolute values of the terms.
    terms: Vec<f64>,
    /// Columns that have terms.
    columns: Vec<usize>,
}

impl Accumulator {
    pub fn new(cols: usize) -> Result<Self> {
        Ok(Self {
            value: zeros(cols, "a sum of rows")?,
            terms: zeros(cols, "a sum of rows")?,
            columns: Vec::new(),
        })
    }

    /// Resets the sum to zero.
    pub fn reset(&mut self) {
        for j in self.columns.drain(..) {
            (self.value[j], self.terms[j]) = (0.0, 0.0);
        }
    }

    pub fn add(&mut self, j: usize, v: f64) {
        // a product that underflows is no term
        if self.terms[j] == 0.0 && v != 0.0 {
            self.columns.push(j);
        }
        self.value[j] += v;
        self.terms[j] += v.abs();
    }

    /// Subtracts the part along a unit row and returns its coefficient; 0 if it is rounding.
    pub fn clear(&mut self, row: impl Iterator<Item = (usize, f64)> + Clone, metric: &[f64]) -> f64 {
        let (mut part, mut terms) = (0.0, 0.0);
        for (j, v) in row.clone() {
            let term = v * self.value[j] / metric[j];
            part += term;
            terms += term.abs();
        }
        if part.abs() <= ROUNDING * terms {
            return 0.0;
        }
        row.for_each(|(j, v)| self.add(j, -part * v));
        part
    }

    /// Squared length in the metric `D^-1`.
    pub fn square(&self, metric: &[f64]) -> f64 {
        self.columns.iter().map(|&j| self.value[j] * self.value[j] / metric[j]).sum()
    }

    /// The entries divided by `length`, ascending, without those that are rounding.
    pub fn divided(&mut self, length: f64) -> Vec<(usize, f64)> {
        self.columns.sort_unstable();
        let kept = self.columns.iter().filter(|&&j| self.value[j].abs() > ROUNDING * self.terms[j]);
        kept.map(|&j| (j, self.value[j] / length)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_that_have_underflowed_repeat_no_column() {
        let mut sum = Accumulator::new(2).unwrap();
        [(1, 0.0), (0, 0.0), (1, 2.0), (0, 3.0)].into_iter().for_each(|(j, v)| sum.add(j, v));
        assert_eq!(sum.divided(1.0), [(0, 3.0), (1, 2.0)]);
    }
}
