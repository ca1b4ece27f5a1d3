//! Sums of products in double-double arithmetic: Dot2 of Ogita, Rump, Oishi, "Accurate sum and dot product" (2005).

use crate::ranks::wire_struct;

/// A sum as accurate as if computed with 106 bits and rounded once, except if terms over- or underflow.
#[derive(Debug, Clone, Copy, Default)]
pub struct Twofold {
    sum: f64,
    /// Sum of the rounding errors of `sum` and of the products.
    lost: f64,
}

impl Twofold {
    #[inline(always)]
    pub fn add(&mut self, a: f64) {
        let sum = self.sum + a;
        let taken = sum - self.sum;
        self.lost += (self.sum - (sum - taken)) + (a - taken);
        self.sum = sum;
    }

    #[inline(always)]
    pub fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.add(product);
        self.lost += a.mul_add(b, -product);
    }

    pub fn add_twofold(&mut self, other: Self) {
        self.add(other.sum);
        self.lost += other.lost;
    }

    /// `x'y`
    pub fn dot(x: &[f64], y: &[f64]) -> f64 {
        let mut sum = Self::default();
        x.iter().zip(y).for_each(|(x, y)| sum.add_product(*x, *y));
        sum.value()
    }

    /// The sum in f64; if it is not finite, the value of f64 arithmetic.
    pub fn value(self) -> f64 {
        if self.sum.is_finite() {
            self.sum + self.lost
        } else {
            self.sum
        }
    }
}

wire_struct!(Twofold { sum, lost });

impl From<f64> for Twofold {
    fn from(sum: f64) -> Self {
        Self { sum, lost: 0.0 }
    }
}

/// `sum + lost += by`, lost below the rounding of the sum.
fn add_to(sum: &mut f64, lost: &mut f64, by: f64) {
    let mut all = Twofold { sum: *sum, lost: *lost };
    all.add(by);
    (*sum, *lost) = (all.sum, all.lost);
}

/// A vector in two doubles: the sum of `parts`, the second below the rounding of the first.
#[derive(Debug, Clone, Default)]
pub struct TwofoldVector {
    parts: [Vec<f64>; 2],
}

impl TwofoldVector {
    pub fn parts(&self) -> [&[f64]; 2] {
        [&self.parts[0], &self.parts[1]]
    }

    pub fn len(&self) -> usize {
        self.parts[0].len()
    }

    /// Rounded once.
    pub fn get(&self, i: usize) -> f64 {
        self.parts[0][i] + self.parts[1][i]
    }

    pub fn values(&self) -> Vec<f64> {
        (0..self.len()).map(|i| self.get(i)).collect()
    }

    pub fn add(&mut self, i: usize, by: f64) {
        let [sum, lost] = &mut self.parts;
        add_to(&mut sum[i], &mut lost[i], by);
    }

    /// `self += by`
    pub fn add_all(&mut self, by: &[f64]) {
        by.iter().enumerate().for_each(|(i, by)| self.add(i, *by));
    }

    pub fn set_to_zero(&mut self, i: usize) {
        (self.parts[0][i], self.parts[1][i]) = (0.0, 0.0);
    }
}

impl From<Vec<f64>> for TwofoldVector {
    fn from(v: Vec<f64>) -> Self {
        let rest = vec![0.0; v.len()];
        Self { parts: [v, rest] }
    }
}

#[cfg(test)]
mod tests {
    use super::{Twofold, TwofoldVector};

    #[test]
    fn a_vector_in_two_doubles_keeps_what_is_added_below_its_rounding() {
        let mut v = TwofoldVector::from(vec![1.0, 2.0]);
        (0..4).for_each(|_| v.add(0, 1e-17));
        assert_eq!((v.get(0), v.parts()[1][0]), (1.0, 4e-17));
        v.add(0, -1.0);
        assert_eq!(v.values(), [4e-17, 2.0]);
    }

    #[test]
    fn a_sum_that_cancels_keeps_what_is_left() {
        let mut sum = Twofold::from(1e16);
        [1.0, -1e16].into_iter().for_each(|a| sum.add(a));
        assert_eq!(sum.value(), 1.0);
        let mut square = Twofold::default();
        square.add_product(1e8 + 1.0, 1e8 - 1.0);
        square.add_product(-1e8, 1e8);
        assert_eq!(square.value(), -1.0);
    }

    #[test]
    fn a_long_sum_of_equal_terms_is_right_to_its_last_digit() {
        let n = 200_000;
        let (tenths, ones) = (vec![0.1; n], vec![1.0; n]);
        assert_eq!(Twofold::dot(&tenths, &ones), 0.1 * n as f64);
        let plain: f64 = tenths.iter().sum();
        assert!((plain - 0.1 * n as f64).abs() > 1000.0 * f64::EPSILON * plain, "{plain}");
    }

    #[test]
    fn what_is_not_finite_stays_so() {
        let mut sum = Twofold::from(f64::INFINITY);
        sum.add_product(1.0, -2.0);
        assert_eq!(sum.value(), f64::INFINITY);
    }
}
