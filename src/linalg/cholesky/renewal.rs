//! Factors of matrices with equal patterns that differ only in some columns: the supernodes of these columns and their
//! ancestors are factorised again; all others are kept, with their updates.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::cholesky::analysis::elimination::NONE;
use crate::linalg::cholesky::numeric::multifrontal::{self, Kept};
use crate::linalg::{Analysis, Cholesky, Symmetric};
use crate::numbers::linalg::{READ_OF_L, SOLUTIONS};

pub struct Renewal {
    pub analysis: Arc<Analysis>,
    /// Supernodes that are factorised again, ascending, including all their ancestors.
    renewed: Vec<usize>,
    /// Positions of their columns.
    is_renewed: Vec<bool>,
    kept: Option<Kept>,
}

impl Renewal {
    /// `varying`: the unknowns whose columns differ. They are ordered last if that makes factorisations and solves
    /// together cheaper.
    pub fn new(pattern: &Symmetric, varying: &[bool]) -> Result<Self> {
        let natural = Self::of(Analysis::new(pattern, &vec![false; varying.len()])?, varying);
        let (mut order, last): (Vec<usize>, Vec<usize>) =
            natural.analysis.order.iter().partition(|&&unknown| !varying[unknown]);
        if order.is_empty() || last.is_empty() {
            return Ok(natural);
        }
        order.extend(last);
        let apart = Self::of(Analysis::of_leading(pattern, &order)?, varying);
        Ok(if apart.cost() < natural.cost() { apart } else { natural })
    }

    fn of(analysis: Analysis, varying: &[bool]) -> Self {
        let (nodes, order) = (&analysis.nodes, &analysis.order);
        let varies = |s: usize| order[nodes.node(s).begin..nodes.node(s).end()].iter().any(|&i| varying[i]);
        let mut anew: Vec<bool> = (0..nodes.count()).map(varies).collect();
        for s in 0..nodes.count() {
            if anew[s] && nodes.parent(s) != NONE {
                anew[nodes.parent(s)] = true;
            }
        }
        let is_renewed = nodes.nodes().zip(&anew).flat_map(|(node, &anew)| vec![anew; node.width]).collect();
        let renewed = (0..nodes.count()).filter(|&s| anew[s]).collect();
        Self { analysis: Arc::new(analysis), renewed, is_renewed, kept: None }
    }

    /// Multiplications of a factorisation with its solves.
    fn cost(&self) -> f64 {
        let nodes = &self.analysis.nodes;
        let work: f64 = self.renewed.iter().map(|&s| nodes.node(s).work()).sum();
        work + READ_OF_L * SOLUTIONS * nodes.values() as f64
    }

    /// Whether renewing a factor reads entries in the row or column of an unknown.
    pub fn reads(&self, unknown: usize) -> bool {
        self.is_renewed[self.analysis.position[unknown]]
    }

    /// L of `by` times a matrix; if `hold` is positive, pivots up to `hold` are held. Renews `factor`, of another such
    /// matrix, or factorises completely. `Err`: the position of a pivot that is not positive.
    pub fn factorize(
        &mut self,
        factor: Option<Cholesky>,
        matrix: &Symmetric,
        (by, hold): (f64, f64),
    ) -> Result<std::result::Result<Cholesky, usize>> {
        let (analysis, is_renewed) = (&self.analysis, &self.is_renewed);
        let nodes = &analysis.nodes;
        match (factor, &self.kept) {
            (Some(mut factor), Some(kept)) => {
                let _room = analysis.factorisation_headroom()?;
                let columns = analysis.columns(matrix, by, |at| is_renewed[at])?;
                let done =
                    multifrontal::renew(nodes, &columns, hold, &self.renewed, kept, &mut factor.values)?;
                Ok(done.map(|()| factor))
            }
            _ if self.renewed.len() == nodes.count() => analysis.pivoted(matrix, by, hold),
            _ => {
                let _room = analysis.factorisation_headroom()?;
                let columns = analysis.columns(matrix, by, |_| true)?;
                let done = multifrontal::factorize_keeping(nodes, &columns, hold, &self.renewed)?;
                Ok(done.map(|(values, kept)| {
                    self.kept = Some(kept);
                    Cholesky { analysis: Arc::clone(analysis), values, held: Vec::new() }
                }))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::random::scattered;

    /// A grid of n x n unknowns; the diagonal of its first row of unknowns differs by `shift`.
    fn grid(n: usize, shift: f64) -> Symmetric {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n * n {
            for j in [(i >= n).then(|| i - n), (i % n > 0).then(|| i - 1)].into_iter().flatten() {
                col.push(j as u32);
                val.push(-1.0);
            }
            col.push(i as u32);
            val.push(4.0 + 0.1 * (i % 7) as f64 + if i < n { shift } else { 0.0 });
            ptr.push(col.len());
        }
        Symmetric::new(ptr, col, val)
    }

    fn factor(renewal: &mut Renewal, factor: Option<Cholesky>, k: &Symmetric, hold: f64) -> Cholesky {
        renewal.factorize(factor, k, (1.0, hold)).unwrap().unwrap()
    }

    #[test]
    fn a_renewed_factor_has_the_bits_of_a_fresh_one_and_reads_the_columns_that_differ_alone() {
        for (n, hold) in [(5, 0.0), (30, 0.0), (30, 1e-8)] {
            let varying: Vec<bool> = (0..n * n).map(|i| i < n).collect();
            let mut renewal = Renewal::new(&grid(n, 0.0), &varying).unwrap();
            let mut own = factor(&mut renewal, None, &grid(n, 0.0), hold);
            for shift in scattered(3) {
                let mut k = grid(n, shift);
                let fresh = factor(&mut renewal, None, &k, hold);
                for i in 0..n * n {
                    let unread = |j: usize| !renewal.reads(i) && !renewal.reads(j);
                    for at in k.ptr[i]..k.ptr[i + 1] {
                        let j = k.col[at] as usize;
                        k.val[at] = if unread(j) { f64::NAN } else { k.val[at] };
                    }
                }
                own = factor(&mut renewal, Some(own), &k, hold);
                assert!(own.values[..] == fresh.values[..], "{n} {hold} {shift}");
            }
        }
    }

    #[test]
    fn unknowns_that_differ_come_last_where_many_others_are_spared_by_it() {
        let n = 60;
        let varying: Vec<bool> = (0..n * n).map(|i| i < n).collect();
        let renewal = Renewal::new(&grid(n, 0.0), &varying).unwrap();
        let nodes = &renewal.analysis.nodes;
        assert!(5 * renewal.renewed.len() < nodes.count(), "{} of {}", renewal.renewed.len(), nodes.count());
        let all = Renewal::new(&grid(n, 0.0), &vec![true; n * n]).unwrap();
        assert_eq!(all.renewed.len(), all.analysis.nodes.count());
    }

    #[test]
    fn a_singular_matrix_is_refused_and_the_next_one_is_factorised() {
        let (n, varying) = (12, (0..144).map(|i| i < 12).collect::<Vec<_>>());
        let mut renewal = Renewal::new(&grid(n, 0.0), &varying).unwrap();
        let own = factor(&mut renewal, None, &grid(n, 0.0), 0.0);
        assert!(renewal.factorize(Some(own), &grid(n, -9.0), (1.0, 0.0)).unwrap().is_err());
        let fresh = factor(&mut renewal, None, &grid(n, 1.0), 0.0);
        assert!(fresh.smallest_pivot() > 0.0);
    }
}
