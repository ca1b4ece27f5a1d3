//! Random numbers, equal in every run: Marsaglia's xorshift of 64 bits.

use crate::error::Result;
use crate::platform::memory::zeros;

const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

pub struct Random(u64);

impl Default for Random {
    fn default() -> Self {
        Self(SEED)
    }
}

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// One of 0..n, n at most 2^32.
    pub fn below(&mut self, n: usize) -> usize {
        (((self.bits() >> 32) * n as u64) >> 32) as usize
    }

    /// A number of size 1/2 to 3/2 and either sign. Signs alone would cancel along many motions of few dofs.
    fn number(&mut self) -> f64 {
        const UNIT: f64 = 1.0 / (1_u64 << 52) as f64;
        let bits = self.bits();
        let size = 0.5 + (bits >> 12) as f64 * UNIT;
        let sign = if bits & 1 == 0 { 1.0 } else { -1.0 };
        sign * size
    }

    /// The next n numbers, each multiplied by `scale` of its position.
    pub fn vector(&mut self, n: usize, scale: impl Fn(usize) -> f64) -> Result<Vec<f64>> {
        let mut values = zeros(n, "a probe")?;
        values.iter_mut().enumerate().for_each(|(i, v)| *v = self.number() * scale(i));
        Ok(values)
    }
}

/// The first n numbers in [-1/2, 1/2).
pub fn scattered(n: usize) -> Vec<f64> {
    let mut random = Random::default();
    (0..n).map(|_| (random.bits() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5).collect()
}
