//! Factors of `W_F = sum g_i g_i'` over the rows i of successive faces, which share most columns.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::cholesky::Renewal;
use crate::linalg::sparse::gram::Gram;
use crate::linalg::{Analysis, Cholesky, Csr, Symmetric};

pub struct FaceFactors {
    gram: Gram,
    renewal: Renewal,
    /// Rows that may change, or that may be outside a face.
    varying: Vec<bool>,
    /// Rows with entries that are read when a factor is renewed.
    needed: Vec<usize>,
    /// Factors made so far; those no longer in use are renewed.
    factors: Vec<Arc<Cholesky>>,
}

impl FaceFactors {
    /// `rows`: G', m x r.
    pub fn new(rows: &Csr, varying: Vec<bool>) -> Result<Self> {
        let gram = Gram::of(rows)?;
        let mut varies = vec![false; rows.cols];
        for i in (0..rows.rows()).filter(|&i| varying[i]) {
            rows.row(i).for_each(|(column, _)| varies[column] = true);
        }
        let renewal = Renewal::new(gram.pattern(), &varies)?;
        let is_needed = |&i: &usize| {
            let columns = &rows.col[rows.ptr[i]..rows.ptr[i + 1]];
            columns.iter().any(|&k| renewal.reads(k))
        };
        let needed = (0..rows.rows()).filter(is_needed).collect();
        Ok(Self { gram, renewal, varying, needed, factors: Vec::new() })
    }

    pub fn gram(&self) -> &Gram {
        &self.gram
    }

    pub fn analysis(&self) -> &Arc<Analysis> {
        &self.renewal.analysis
    }

    /// L of `by` times W_F after `complete`, which changes all matrices equally; if `hold` is positive, pivots up to
    /// `hold` are held. `Err`: W_F is singular.
    pub fn factor(
        &mut self,
        rows: &Csr,
        held: &[bool],
        (by, hold): (f64, f64),
        complete: impl Fn(&mut Symmetric),
    ) -> Result<std::result::Result<Arc<Cholesky>, usize>> {
        let is_common = (0..held.len()).all(|i| !held[i] || self.varying[i]);
        let free = self.factors.iter().position(|factor| is_common && Arc::strong_count(factor) == 1);
        let before = free.and_then(|at| Arc::try_unwrap(self.factors.swap_remove(at)).ok());
        let mut w = match &before {
            Some(_) => self.gram.sum_of(rows, self.needed.iter().copied().filter(|&i| !held[i]))?,
            None => self.gram.sum(rows, held)?,
        };
        complete(&mut w);
        if !is_common {
            return Ok(self.renewal.analysis.pivoted(&w, by, hold)?.map(Arc::new));
        }
        let found = self.renewal.factorize(before, &w, (by, hold))?.map(Arc::new);
        self.factors.extend(found.iter().cloned());
        Ok(found)
    }
}
