//! Bytes read as decisions; zeros, the plain choice, once they are used up.

pub struct Bytes<'a> {
    rest: &'a [u8],
}

/// Numbers that no model wants.
const WILD: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN_POSITIVE,
    5e-324,
    -0.0,
    1e154,
    -1e300,
    1e-200,
    1e16,
    -1e-8,
];

impl<'a> Bytes<'a> {
    pub fn new(data: &'a [u8]) -> Self {
        Self { rest: data }
    }

    pub fn used_up(&self) -> bool {
        self.rest.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.rest.split_first() else { return 0 };
        self.rest = rest;
        *first
    }

    /// One of `0..n`.
    pub fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n.max(1)
    }

    /// True for so many of 256 bytes, and not once they are used up.
    pub fn chance(&mut self, of_256: u8) -> bool {
        self.byte() > 255 - of_256
    }

    /// A multiple of 1/8 between -16 and 16.
    pub fn number(&mut self) -> f64 {
        f64::from(self.byte() as i8) / 8.0
    }

    /// A multiple of 1/8 from 1/8 to 32.
    pub fn positive(&mut self) -> f64 {
        (f64::from(self.byte()) + 1.0) / 8.0
    }

    pub fn wild(&mut self) -> f64 {
        WILD[self.below(WILD.len())]
    }

    /// Up to `most` bytes as they are.
    pub fn take(&mut self, most: usize) -> &'a [u8] {
        let (taken, rest) = self.rest.split_at(most.min(self.rest.len()));
        self.rest = rest;
        taken
    }
}
