//! Products with F, body by body: with the entries of `F_p = B_p K_p+ B_p'` where they are there (explicit), else by
//! two triangular solves, `F_p x = B_p (K_p+ (B_p'x))` (implicit).

use crate::dual::{Dual, InParallel, Subdomain};
use crate::error::Result;
use crate::linalg::Operator;
use crate::platform::memory::zeros;

const WHAT: &str = "a product with the dual operator";

impl Subdomain {
    /// `F_p x`, x over all rows of B, the product over those of the body.
    pub(super) fn product(&self, x: &[f64]) -> Result<Vec<f64>> {
        if let Some(explicit) = &self.operator {
            let local = self.multiples.gather(&self.rows, x);
            let mut image = vec![0.0; local.len()];
            explicit.apply(&local, &mut image);
            return Ok(self.multiples.spread(&image).map(|v| self.by * v).collect());
        }
        let local: Vec<f64> = self.rows.iter().map(|&i| x[i]).collect();
        let mut moved = zeros(self.range.len(), WHAT)?;
        self.matrix.mul_transposed_add(1.0, &local, &mut moved);
        self.kplus.apply_in_place(&mut moved)?;
        let mut image = vec![0.0; local.len()];
        self.matrix.mul(&moved, &mut image);
        image.iter_mut().for_each(|v| *v *= self.by);
        Ok(image)
    }
}

impl Dual {
    /// The operator of (12)-(13): `y = F x = C x + sum_p B_p K_p+ B_p' x`. The products of the bodies run in any order,
    /// their sum is formed body after body. An error leaves y as it was.
    pub fn product(&self, x: &[f64], y: &mut [f64], in_parallel: &InParallel<Vec<f64>>) -> Result<()> {
        let images = in_parallel(self.subdomains.len(), &|p| self.subdomains[p].product(x))?;
        y.iter_mut().zip(x).zip(&self.compliance).for_each(|((y, x), c)| *y = c * x);
        for (s, image) in self.subdomains.iter().zip(&images) {
            s.rows.iter().zip(image).for_each(|(&i, v)| y[i] += v);
        }
        Ok(())
    }

    /// Products of body p with F_p run on the thread alone that calls the library.
    pub fn multiplies_on_caller(&self, p: usize) -> bool {
        self.subdomains[p].operator.is_none() && self.solves_on_caller(p)
    }

    /// So do solutions with K_p+.
    pub fn solves_on_caller(&self, p: usize) -> bool {
        self.subdomains[p].kplus.on_caller()
    }

    /// Multiplications of a product with F.
    pub fn product_work(&self) -> usize {
        self.subdomains.iter().map(|s| s.work).sum()
    }

    /// Bodies whose operator has its entries.
    pub fn explicit_bodies(&self) -> usize {
        self.subdomains.iter().filter(|s| s.operator.is_some()).count()
    }

    /// Bodies whose operator is known by its products alone.
    pub fn implicit_bodies(&self) -> usize {
        self.subdomains.len() - self.explicit_bodies()
    }
}

impl Operator for Dual {
    fn order(&self) -> usize {
        self.compliance.len()
    }

    /// y is not a number where memory refused the product.
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        if self.try_apply(x, y).is_err() {
            y.fill(f64::NAN);
        }
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, &|count, task| (0..count).map(task).collect())
    }

    fn bytes_kept(&self) -> usize {
        self.subdomains.iter().filter_map(|s| s.operator.as_ref()).map(Operator::bytes_kept).sum()
    }
}
