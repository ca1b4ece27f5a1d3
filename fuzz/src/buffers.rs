//! Arrays for results: filled with a pattern that shows whether they were written; and a digest of what was.

/// FNV-1a over 64-bit words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digest(pub u64);

impl Digest {
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub fn feed(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0100_0000_01b3).rotate_left(23);
    }
}

impl Default for Digest {
    fn default() -> Self {
        Self::new()
    }
}

pub trait Cell: Copy {
    const PATTERN: Self;
    fn bits(self) -> u64;
}

impl Cell for f64 {
    const PATTERN: Self = f64::from_bits(0x7ff8_5a5a_a5a5_0001);
    fn bits(self) -> u64 {
        self.to_bits()
    }
}

impl Cell for i64 {
    const PATTERN: Self = 0x5a5a_a5a5_1234_4321;
    fn bits(self) -> u64 {
        self as u64
    }
}

impl Cell for i32 {
    const PATTERN: Self = 0x5a5a_1234;
    fn bits(self) -> u64 {
        self as u64
    }
}

impl Cell for u8 {
    const PATTERN: Self = 0x5a;
    fn bits(self) -> u64 {
        u64::from(self)
    }
}

/// Exactly as long as the call may write: one entry more is the sanitizer's.
pub struct Out<T> {
    pub cells: Vec<T>,
}

pub trait Written {
    fn untouched(&self) -> bool;
    fn feed(&self, digest: &mut Digest);
}

impl<T: Cell> Out<T> {
    pub fn new(n: usize) -> Self {
        Self { cells: vec![T::PATTERN; n] }
    }
}

impl<T: Cell> Written for Out<T> {
    fn untouched(&self) -> bool {
        self.cells.iter().all(|cell| cell.bits() == T::PATTERN.bits())
    }

    fn feed(&self, digest: &mut Digest) {
        self.cells.iter().for_each(|cell| digest.feed(cell.bits()));
    }
}
