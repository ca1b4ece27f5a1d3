//! The entries of F, gathered from the operators of the bodies and the compliance of the rows.

use crate::dual::Dual;
use crate::linalg::{Entries, Matrix};

impl Entries for Dual {
    fn add_block(&self, rows: &[usize], block: &mut Matrix) {
        for s in &self.subdomains {
            // (number in the block, number in the body) of the rows both have
            let common = rows.iter().enumerate();
            let common: Vec<(usize, usize)> =
                common.filter_map(|(k, i)| Some((k, s.rows.binary_search(i).ok()?))).collect();
            for (at, &(l, j)) in common.iter().enumerate() {
                let column = block.col_mut(l);
                let entry = |i: usize| s.multiples.entry(i, j, |i, j| s.operator.get(i, j));
                common[at..].iter().for_each(|&(k, i)| column[k] += entry(i));
            }
        }
        rows.iter().enumerate().for_each(|(k, &i)| block.col_mut(k)[k] += self.compliance[i]);
    }
}
