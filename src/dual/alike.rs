//! Equal dual problems of many small islands, of which one is kept.

use std::sync::Arc;

use crate::dual::elsewhere::Form;
use crate::dual::{Dual, Subdomain};
use crate::linalg::hash::{hash, same_bits, START};
use crate::linalg::{Operator, Packed};

impl Dual {
    /// Whether both are made of the same: then every bit of this one is that of the other.
    pub fn same(&self, other: &Self) -> bool {
        let pairs = || self.subdomains.iter().zip(&other.subdomains);
        self.subdomains.len() == other.subdomains.len()
            && same_bits(&self.compliance, &other.compliance)
            && pairs().all(|(a, b)| a.same(b))
    }

    /// Hash key of the rows and K+ of all bodies.
    pub fn key(&self) -> u64 {
        let of = |s: &Subdomain| [s.matrix.key(), Arc::as_ptr(&s.kplus) as u64];
        hash(START, self.subdomains.iter().flat_map(of))
    }
}

impl Subdomain {
    fn same(&self, other: &Self) -> bool {
        let numbers = |s: &Self| (s.modes.clone(), s.work, s.size.to_bits(), s.by.to_bits());
        let entries = |a: &Packed, b: &Packed| {
            let same = |i, j| a.get(i, j).to_bits() == b.get(i, j).to_bits();
            (0..a.order()).all(|i| (0..=i).all(|j| same(i, j)))
        };
        numbers(self) == numbers(other)
            && Arc::ptr_eq(&self.kplus, &other.kplus)
            && self.rows == other.rows
            && self.matrix == other.matrix
            && match (&self.operator, &other.operator) {
                (Some(Form::Own(a)), Some(Form::Own(b))) => entries(a, b),
                // made of the same K+ and rows
                (Some(Form::Elsewhere(_)), Some(Form::Elsewhere(_))) => true,
                (a, b) => a.is_none() && b.is_none(),
            }
    }
}
