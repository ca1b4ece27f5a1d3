//! Double-double arithmetic: a number as the unevaluated sum of two f64, about 32 decimal digits.
//! Dekker 1971; Hida, Li, Bailey 2001 for the order of operations.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `hi + lo` with |lo| <= 1/2 ulp(hi).
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Dd {
    pub hi: f64,
    pub lo: f64,
}

/// s + e = a + b exactly, s = fl(a + b).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// The same where |a| >= |b|.
fn quick_two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    Dd { hi, lo: b - (hi - a) }
}

impl Dd {
    pub const ZERO: Dd = Dd { hi: 0.0, lo: 0.0 };

    /// a b, exact but for underflow.
    pub fn product(a: f64, b: f64) -> Dd {
        let hi = a * b;
        Dd { hi, lo: a.mul_add(b, -hi) }
    }

    pub fn abs(self) -> Dd {
        if self.hi < 0.0 {
            -self
        } else {
            self
        }
    }

    /// One step of Newton from the root in f64; 0 of what is not positive.
    pub fn sqrt(self) -> Dd {
        if self.hi <= 0.0 {
            return Dd::ZERO;
        }
        let root = self.hi.sqrt();
        let rest = self - Dd::product(root, root);
        Dd::from(root) + Dd::from(rest.hi / (2.0 * root))
    }

    /// The nearest f64.
    pub fn value(self) -> f64 {
        self.hi + self.lo
    }
}

impl From<f64> for Dd {
    fn from(value: f64) -> Dd {
        Dd { hi: value, lo: 0.0 }
    }
}

impl Neg for Dd {
    type Output = Dd;
    fn neg(self) -> Dd {
        Dd { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for Dd {
    type Output = Dd;
    fn add(self, other: Dd) -> Dd {
        let (high, rest) = two_sum(self.hi, other.hi);
        let (low, last) = two_sum(self.lo, other.lo);
        let sum = quick_two_sum(high, rest + low);
        quick_two_sum(sum.hi, sum.lo + last)
    }
}

impl Sub for Dd {
    type Output = Dd;
    fn sub(self, other: Dd) -> Dd {
        self + -other
    }
}

impl Mul for Dd {
    type Output = Dd;
    fn mul(self, other: Dd) -> Dd {
        let p = Dd::product(self.hi, other.hi);
        quick_two_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for Dd {
    type Output = Dd;
    fn div(self, other: Dd) -> Dd {
        let first = self.hi / other.hi;
        let rest = self - other * Dd::from(first);
        let second = rest.hi / other.hi;
        let last = (rest - other * Dd::from(second)).hi / other.hi;
        let sum = quick_two_sum(first, second);
        sum + Dd::from(last)
    }
}

/// sum_k a_k b_k, rounded once at the end.
pub fn dot(pairs: impl Iterator<Item = (f64, f64)>) -> Dd {
    pairs.fold(Dd::ZERO, |sum, (a, b)| sum + Dd::product(a, b))
}

#[cfg(test)]
mod tests {
    use super::{dot, Dd};
    use crate::random::Random;

    #[test]
    fn a_sum_that_cancels_keeps_what_is_left() {
        assert_eq!(dot([(1e16, 1.0), (1.0, 1.0), (-1e16, 1.0)].into_iter()).value(), 1.0);
        assert_eq!(dot([(1e8 + 1.0, 1e8 - 1.0), (-1e8, 1e8)].into_iter()).value(), -1.0);
    }

    /// (a / b) b = a and sqrt(a)^2 = a to 1e-30.
    #[test]
    fn quotients_and_roots_are_right_to_30_digits() {
        let mut random = Random::new(3);
        for _ in 0..1000 {
            let mut draw = || Dd::from(random.between(0.5, 2.0)) + Dd::from(1e-17 * random.normal());
            let (a, b) = (draw(), draw());
            assert!(((a / b) * b - a).value().abs() < 1e-30);
            assert!((a.sqrt() * a.sqrt() - a).value().abs() < 1e-30);
        }
    }
}
