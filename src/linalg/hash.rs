//! Hash keys of lists of numbers: equal for equal lists, rarely equal for different lists; and values kept once by their keys.

use std::collections::hash_map::{Entry, HashMap};
use std::hash::Hash;
use std::sync::Arc;

pub const START: u64 = 0xcbf2_9ce4_8422_2325;

/// Continues from the key `before`, word by word: both halves of a product of 128 bits, so that each bit of a word reaches all of the key,
/// also a sign alone.
pub fn hash(before: u64, words: impl Iterator<Item = u64>) -> u64 {
    words.fold(before, |key, word| {
        let product = u128::from(key ^ word) * 0x9e37_79b9_7f4a_7c15;
        ((product >> 64) as u64 ^ product as u64).wrapping_add(START)
    })
}

/// Values of many small parts, most of them equal: each is kept once.
pub struct Shared<T>(HashMap<u64, Arc<T>>);

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Self(HashMap::new())
    }
}

impl<T> Shared<T> {
    /// The value kept by this key if it is the `same`, otherwise this one.
    pub fn share(&mut self, key: u64, value: T, same: impl Fn(&T, &T) -> bool) -> Arc<T> {
        match self.0.entry(key) {
            Entry::Occupied(known) if same(known.get(), &value) => Arc::clone(known.get()),
            Entry::Occupied(_) => Arc::new(value),
            Entry::Vacant(free) => Arc::clone(free.insert(Arc::new(value))),
        }
    }
}

/// Equal bit by bit, including the sign of zero.
pub fn same_bits(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// The first equal member for every member.
pub fn classes<K: Eq + Hash>(
    count: usize,
    key: impl Fn(usize) -> K,
    same: impl Fn(usize, usize) -> bool,
) -> Vec<usize> {
    let mut first_of: HashMap<K, Vec<usize>> = HashMap::new();
    let class = |p: usize| {
        let firsts = first_of.entry(key(p)).or_default();
        firsts.iter().copied().find(|&q| same(p, q)).unwrap_or_else(|| {
            firsts.push(p);
            p
        })
    };
    (0..count).map(class).collect()
}
