//! Hash keys of lists of numbers: equal for equal lists, rarely equal for different lists.

pub const START: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a, word by word, continuing from the key `before`; the shift moves the high bits of numbers with few digits down.
pub fn hash(before: u64, words: impl Iterator<Item = u64>) -> u64 {
    words.fold(before, |key, word| (key ^ word ^ (word >> 32)).wrapping_mul(0x0100_0000_01b3))
}
