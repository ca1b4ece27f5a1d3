//! Products with F, body by body: with an assembled `F_p = B_p K_p+ B_p'` (explicit), or by two triangular solves, `F_p x
//! = B_p (K_p+ (B_p'x))` (implicit). Also entries of F, gathered from the operators of the bodies and the compliance of
//! the rows.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::Arc;

use crate::body::Asking;
use crate::dual::elsewhere::{Each, Form};
use crate::dual::multiples::Multiples;
use crate::dual::{Dual, InParallel, Ledger, Subdomain};
use crate::error::{Error, Kind, Result};
use crate::linalg::{Csr, Entries, Matrix, Operator};
use crate::platform::tally;

/// Multiplications of a step per row, besides those of its product.
const VECTORS: usize = 100;

impl Subdomain {
    /// `F_p x`, x over all rows of B, the product over the rows of the body; `share` as in [`Dual::product`].
    fn product(&self, x: &[f64], share: Option<f64>) -> Result<Vec<f64>> {
        self.spend(Ledger::multiplies)?;
        if let Some(Form::Own(explicit)) = self.form() {
            let local = self.multiples.gather(&self.rows, x);
            if share.is_some() && self.kplus.is_rounded() {
                let rows = Multiples::of(&self.matrix).1;
                return Ok(self.image_of(self.kplus.product_between(&rows, &local, share)?));
            }
            let mut image = vec![0.0; local.len()];
            explicit.apply(&local, &mut image);
            return Ok(self.image_of(image));
        }
        let image = self.kplus.product_between(&self.matrix, &self.gather(x), share)?;
        Ok(self.image_of(image))
    }

    /// The question for the product if F_p is on another rank.
    fn asking(&self, x: &[f64], share: Option<f64>) -> Option<Asking> {
        let Some(Form::Elsewhere(form)) = &self.operator else { return None };
        let local = if form.explicit { self.multiples.gather(&self.rows, x) } else { self.gather(x) };
        Some(form.multiplying(share, local))
    }

    /// The product from the answer.
    fn image_elsewhere(&self, answer: Vec<f64>) -> Result<Vec<f64>> {
        match &self.operator {
            Some(Form::Elsewhere(form)) => Ok(self.image_of(form.image(answer)?)),
            _ => Err(Error::new(Kind::Internal, "a body here was asked for elsewhere")),
        }
    }

    /// The entries of x of its rows.
    fn gather(&self, x: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|&i| x[i]).collect()
    }

    /// `F_p x` over the rows of the body, from `B K_p+ B' (T'x)` if F_p is assembled, otherwise from `B_p K_p+ B_p'x`.
    fn image_of(&self, mut image: Vec<f64>) -> Vec<f64> {
        if self.explicit().is_some() {
            return self.multiples.spread(&image).map(|v| self.by * v).collect();
        }
        image.iter_mut().for_each(|v| *v *= self.by);
        image
    }

    /// F_p, unless it is applied through K+ here.
    fn form(&self) -> Option<&Form> {
        self.operator.as_ref().or_else(|| self.later.as_ref()?.form.get())
    }

    /// The assembled operator.
    pub(super) fn explicit(&self) -> Option<&Form> {
        self.form().filter(|form| form.is_explicit())
    }

    /// Counts a use of F_p, and assembles it if that is due.
    fn spend(&self, used: impl Fn(&Ledger, usize) -> bool) -> Result<()> {
        let Some(later) = &self.later else { return Ok(()) };
        if used(&later.ledger, self.multiples.count) && self.explicit().is_none() {
            let rows = Multiples::of(&self.matrix).1;
            let made = Form::Own(Arc::new(self.kplus.inverse_form(&rows)?));
            later.form.get_or_init(|| made);
            later.ledger.assembled.fetch_add(rows.rows(), Relaxed);
        }
        Ok(())
    }
}

impl Dual {
    /// The operator of (12)-(13): `y = F x = C x + sum_p B_p K_p+ B_p' x`. The products of the bodies are computed in any
    /// order, and summed in the order of the bodies. After an error y is unchanged. `share`: x is this part of a whole,
    /// relative to whose product rounding counts; none: factors in single precision are not corrected.
    pub fn product(
        &self,
        x: &[f64],
        y: &mut [f64],
        share: Option<f64>,
        in_parallel: &InParallel<Vec<f64>>,
    ) -> Result<()> {
        tally::costly();
        let images = self.images(x, share, in_parallel)?;
        y.iter_mut().zip(x).zip(&self.compliance).for_each(|((y, x), c)| *y = c * x);
        for (s, image) in self.subdomains.iter().zip(&images) {
            s.rows.iter().zip(image).for_each(|(&i, v)| y[i] += v);
        }
        Ok(())
    }

    /// `F_p x` of every body.
    pub(super) fn images(
        &self,
        x: &[f64],
        share: Option<f64>,
        in_parallel: &InParallel<Vec<f64>>,
    ) -> Result<Vec<Vec<f64>>> {
        let each = Each {
            own: &|p| self.subdomains[p].product(x, share),
            asking: &|p| self.subdomains[p].asking(x, share),
            of_answer: &|p, answer| self.subdomains[p].image_elsewhere(answer),
        };
        self.each(&each, in_parallel)
    }

    /// Products of body p with F_p must be computed on the thread that calls the library.
    pub fn multiplies_on_caller(&self, p: usize) -> bool {
        self.subdomains[p].explicit().is_none() && self.solves_on_caller(p)
    }

    /// Solves with K_p+ must run on the thread that calls the library.
    pub fn solves_on_caller(&self, p: usize) -> bool {
        self.subdomains[p].kplus.on_caller()
    }

    /// Multiplications of a product with F.
    pub fn product_work(&self) -> usize {
        self.subdomains.iter().map(|s| s.work).sum()
    }

    /// Multiplications of a step: a product, and vectors over the rows.
    pub fn step_work(&self) -> f64 {
        (self.product_work() + VECTORS * self.order()) as f64
    }

    /// Multiplications of a factorisation of all K_p, at least.
    pub fn factorisation_work(&self) -> f64 {
        self.subdomains.iter().map(|s| s.factorisation).sum()
    }

    /// A solve begins, which may use F_p longer than the last.
    pub fn begin(&self) {
        let open = self.subdomains.iter().filter(|s| s.explicit().is_none());
        let later = open.filter_map(|s| Some((s.later.as_ref()?, s.multiples.count)));
        later.for_each(|(later, columns)| later.ledger.begin(columns));
    }

    /// Number of bodies with an assembled operator.
    pub fn explicit_bodies(&self) -> usize {
        self.subdomains.iter().filter(|s| s.explicit().is_some()).count()
    }

    /// Number of bodies with a matrix-free operator.
    pub fn implicit_bodies(&self) -> usize {
        self.subdomains.len() - self.explicit_bodies()
    }
}

impl Operator for Dual {
    fn order(&self) -> usize {
        self.compliance.len()
    }

    /// y is NaN if there was no memory for the product.
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        if self.try_apply(x, y).is_err() {
            y.fill(f64::NAN);
        }
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, Some(1.0), &|count, task| (0..count).map(task).collect())
    }

    fn apply_to_share(&self, share: f64, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, Some(share), &|count, task| (0..count).map(task).collect())
    }

    fn approximate(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, None, &|count, task| (0..count).map(task).collect())
    }

    fn has_approximation(&self) -> bool {
        self.subdomains.iter().any(|s| s.kplus.is_rounded())
    }

    fn bytes_kept(&self) -> usize {
        self.subdomains.iter().filter_map(Subdomain::form).map(Form::bytes_kept).sum()
    }
}

impl Entries for Dual {
    /// For matrix-free operators, the entries of these rows are computed.
    fn add_block(&self, rows: &[usize], block: &mut Matrix) -> Result<()> {
        for s in &self.subdomains {
            // (number in the block, number in the body) of common rows
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
        if common.is_empty() {
            return Ok(());
        }
        let mut add_entries = |of: &dyn Fn(usize, usize) -> f64| {
            let entry = |i, j| self.multiples.entry(i, j, of);
            add(common, |k, l| self.by * entry(common[k].1, common[l].1), block);
        };
        self.spend(|ledger, columns| ledger.spends(common.len(), columns))?;
        match self.form() {
            Some(Form::Own(form)) => {
                add_entries(&|i, j| form.get(i, j));
                return Ok(());
            }
            Some(Form::Elsewhere(form)) if form.explicit => {
                let rows = self.multiples.distinct(common.iter().map(|of| of.1));
                let entries = form.block(rows.clone())?;
                let at = |i: usize| rows.partition_point(|row| *row < i);
                add_entries(&|i, j| entries.get(at(i), at(j)));
                return Ok(());
            }
            Some(Form::Elsewhere(form)) => {
                let entries = form.block(common.iter().map(|of| of.1).collect())?;
                add(common, |k, l| self.by * entries.get(k, l), block);
                return Ok(());
            }
            None => {}
        }
        let mut selected = Csr::empty(self.matrix.cols);
        common.iter().for_each(|&(_, i)| selected.push_row(self.matrix.row(i)));
        let assembled = self.kplus.inverse_form(&selected)?;
        add(common, |k, l| self.by * assembled.get(k, l), block);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{GeneralizedInverse, Modes, NullSpaceInput};
    use crate::constraints::Touched;
    use crate::dual::{BodyShare, Draft, Size};
    use crate::linalg::{Operator, Symmetric};

    /// Two chains of 8 springs, held at one end, with rows on each chain and between them.
    fn dual(implicit: bool) -> Dual {
        let n = 8;
        let ptr = (0..=n).map(|i| (2 * i as usize).saturating_sub(1)).collect();
        let col: Vec<_> = (0..n).flat_map(|i| [i - 1, i]).skip(1).map(|j: i32| j as u32).collect();
        let val: Vec<_> = (0..n).flat_map(|_| [-1.0, 2.0]).skip(1).collect();
        let k = Symmetric::new(ptr, col, val);
        let none = NullSpaceInput { vectors: Matrix::zeros(8, 0).unwrap(), modes: Modes::Exact };
        let part = || {
            let made = GeneralizedInverse::plan(k.clone().into(), &none, 1e-8).unwrap().execute().unwrap();
            let size = Size::default();
            BodyShare { kplus: Arc::new(made.inverse), by: 1.0, kept: None, size, implicit, ledger: None }
        };
        let mut rows = Csr::empty(16);
        rows.push_row([(2, 1.0), (9, -0.5)]);
        rows.push_row([(0, 1.0), (7, 0.3)]);
        rows.push_row([(12, 2.0)]);
        rows.push_row([(5, 1.0), (6, -1.0), (15, 1.0)]);
        let compliance = vec![0.0, 0.1, 0.0, 0.2];
        let draft = Draft::new(vec![part(), part()], &Touched::of(&[0..8, 8..16], 0..16), &Arc::new(rows));
        let made: Vec<_> = (0..2).map(|p| (draft.assemble(p).unwrap(), None)).collect();
        draft.finish(made, compliance, true)
    }

    #[test]
    fn the_entries_of_any_rows_are_those_that_products_with_unit_vectors_give() {
        for (implicit, rows) in [(false, vec![0, 1, 2, 3]), (true, vec![0, 1, 2, 3]), (true, vec![0, 3])] {
            let dual = dual(implicit);
            assert_eq!(dual.implicit_bodies(), if implicit { 2 } else { 0 });
            let mut block = Matrix::zeros(rows.len(), rows.len()).unwrap();
            dual.add_block(&rows, &mut block).unwrap();
            for (l, &j) in rows.iter().enumerate() {
                let (mut unit, mut image) = ([0.0; 4], [0.0; 4]);
                unit[j] = 1.0;
                dual.try_apply(&unit, &mut image).unwrap();
                for (k, &i) in rows.iter().enumerate().skip(l) {
                    assert!((block.get(k, l) - image[i]).abs() < 1e-13, "({i}, {j})");
                }
            }
        }
    }
}
