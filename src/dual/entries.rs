//! The entries of F, gathered from the operators of the bodies and the compliance of the rows.

use crate::dual::{Dual, Subdomain};
use crate::error::Result;
use crate::linalg::{Csr, Entries, Matrix};

impl Entries for Dual {
    /// Entries that an implicit operator does not have are assembled for these rows alone.
    fn add_block(&self, rows: &[usize], block: &mut Matrix) -> Result<()> {
        for s in &self.subdomains {
            // (number in the block, number in the body) of the rows both have
            let common = rows.iter().enumerate();
            let common: Vec<(usize, usize)> =
                common.filter_map(|(k, i)| Some((k, s.rows.binary_search(i).ok()?))).collect();
            s.add_common(&common, block)?;
        }
        rows.iter().enumerate().for_each(|(k, &i)| block.col_mut(k)[k] += self.compliance[i]);
        Ok(())
    }
}

impl Subdomain {
    /// Adds the lower triangle of F_p on the rows common to block and body.
    fn add_common(&self, common: &[(usize, usize)], block: &mut Matrix) -> Result<()> {
        if let Some(explicit) = &self.operator {
            add(common, |k, l| explicit.get(common[k].1, common[l].1), block);
            return Ok(());
        }
        if common.is_empty() {
            return Ok(());
        }
        let mut selected = Csr::empty(self.matrix.cols);
        common.iter().for_each(|&(_, i)| selected.push_row(self.matrix.row(i)));
        let assembled = self.kplus.inverse_form(&selected)?;
        add(common, |k, l| assembled.get(k, l), block);
        Ok(())
    }
}

/// Adds entries (k, l), k >= l, of the common rows to the block.
fn add(common: &[(usize, usize)], entry: impl Fn(usize, usize) -> f64, block: &mut Matrix) {
    for (at, &(l, _)) in common.iter().enumerate() {
        let column = block.col_mut(l);
        common.iter().enumerate().skip(at).for_each(|(k, &(row, _))| column[row] += entry(k, at));
    }
}
