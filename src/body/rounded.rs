//! K+ from a factor in single precision, which halves the memory and the time to read the factor in every product. With
//! the rounded factor L~ and all sums in double precision,
//!
//! ```text
//! K~+ = L~^-T L~^-1        x_0 = K~+ b,   x <- x + K~+ (b - K x)
//! ```
//!
//! K~+ is symmetric and positive definite, and suffices for the directions of an iteration. The refined x is as accurate
//! as that of K+ after one to four corrections, each of which reduces the error to a part 2^-24 / softness.

use crate::error::Result;
use crate::linalg::vector::{axpy, weighted_norm};
use crate::linalg::{Cholesky, Csr, Multiple, Packed};
use crate::numbers::body::{REACHED_ROUNDING, SHARE, TINY};
use crate::platform::interrupt;
use crate::platform::memory::{copied, zeros};
use crate::platform::slabs::Slabs;

/// Rounding of L, relative to its entries.
const SINGLE: f64 = f32::EPSILON as f64 / 2.0;
/// Limit of corrections, which an accepted factor never reaches.
const CORRECTIONS: usize = 8;

/// The rounded factor and the matrix for its refinement.
pub struct Rounded {
    pub factor: Cholesky<f32>,
    k: Multiple,
    /// Dofs at which K+ is 0.
    held: Vec<usize>,
    /// A residual below this part of the load is rounding.
    rounding: f64,
}

impl Rounded {
    /// None if rounding of L would be too large, as for matrices of very different stiffnesses. `softness`: `|f| / |
    /// |K||K+ f| |` of a random load. The rounded L is stored in `slabs`.
    pub fn of(
        factor: &Cholesky,
        k: &Multiple,
        held: &[usize],
        softness: f64,
        slabs: &Slabs,
    ) -> Result<Option<Self>> {
        if !(softness * SHARE > SINGLE && factor.smallest_pivot() > TINY && factor.at_rest().is_empty()) {
            return Ok(None);
        }
        let rounding = f64::EPSILON * (1.0 / softness).max(4.0);
        let rounded = Self { factor: factor.rounded(slabs)?, k: k.clone(), held: held.to_vec(), rounding };
        // a load that strains all dofs equally
        let load: Vec<f64> = (0..k.order()).map(|i| k.metric(i, 1.0).sqrt()).collect();
        let mut x = copied(&load, WHAT)?;
        rounded.approximate(&mut x)?;
        let left = rounded.size(&rounded.left(&load, &x)?);
        Ok((left <= SHARE * rounded.size(&load)).then_some(rounded))
    }

    /// `x <- K~+ x`
    pub fn approximate(&self, x: &mut [f64]) -> Result<()> {
        self.factor.solve(x)
    }

    /// `x <- K+ x`, refined.
    pub fn solve(&self, x: &mut [f64]) -> Result<()> {
        self.refined(x, |x| self.approximate(x))
    }

    /// Solves `K x = b - K v` for x, b in x on entry, refined by solves close to those with K.
    pub fn solve_without(
        &self,
        motion: &[f64],
        x: &mut [f64],
        near: impl Fn(&mut [f64]) -> Result<()>,
    ) -> Result<()> {
        let left = self.left(x, motion)?;
        x.copy_from_slice(&left);
        self.refined(x, near)
    }

    /// `x <- x + near(b - K x)`, from 0, while this reduces the residual.
    fn refined(&self, x: &mut [f64], near: impl Fn(&mut [f64]) -> Result<()>) -> Result<()> {
        let load = copied(x, WHAT)?;
        let size = self.size(&load);
        near(x)?;
        let mut before = size;
        for _ in 0..CORRECTIONS {
            let mut left = self.left(&load, x)?;
            let now = self.size(&left);
            // true also for NaN
            if !(now > self.rounding * size && now < REACHED_ROUNDING * before) {
                break;
            }
            near(&mut left)?;
            axpy(1.0, &left, x);
            before = now;
        }
        Ok(())
    }

    /// `B K+ B'` for the rows B (m x n) of this body: the entries below the diagonal, column by column.
    pub fn inverse_form(&self, rows: &Csr) -> Result<Packed> {
        let m = rows.rows();
        let mut form = Packed::zeros(m)?;
        for j in 0..m {
            let moved = self.moved(rows, j)?;
            (j..m).for_each(|i| form.add(i, j, rows.row_dot(i, &moved)));
        }
        Ok(form)
    }

    /// `K+ b_j'`
    fn moved(&self, rows: &Csr, j: usize) -> Result<Vec<f64>> {
        interrupt::check()?;
        let mut x = zeros(self.k.order(), WHAT)?;
        rows.row(j).for_each(|(dof, v)| x[dof] += v);
        self.solve(&mut x)?;
        Ok(x)
    }

    /// `b - K x` at free dofs, 0 at held dofs.
    fn left(&self, load: &[f64], x: &[f64]) -> Result<Vec<f64>> {
        let mut left = zeros(x.len(), WHAT)?;
        self.k.mul(x, &mut left);
        left.iter_mut().zip(load).for_each(|(left, load)| *left = load - *left);
        self.held.iter().for_each(|&dof| left[dof] = 0.0);
        Ok(left)
    }

    /// `|b|_{D^-1}`
    fn size(&self, load: &[f64]) -> f64 {
        weighted_norm(load, |i| 1.0 / self.k.metric(i, 1.0))
    }
}

const WHAT: &str = "a refined displacement";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::random::Random;
    use crate::linalg::vector::norm;
    use crate::linalg::{Analysis, Symmetric};
    use std::sync::Arc;

    /// A chain of n springs, held at its first dof by one of stiffness `ground`.
    fn chain(n: usize, ground: f64) -> Multiple {
        let mut k = Symmetric::empty();
        for i in 0..n {
            let stiffness = |i: usize| 1.0 / (1.0 + i as f64 % 7.0 / 7.0);
            let before = if i == 0 { ground } else { stiffness(i) };
            let after = if i + 1 < n { stiffness(i + 1) } else { 0.0 };
            k.push_row((i > 0).then(|| (i - 1, -before)).into_iter().chain([(i, before + after)]));
        }
        k.into()
    }

    fn factor(k: &Multiple) -> Cholesky {
        let analysis = Arc::new(Analysis::new(&k.matrix, &vec![false; k.order()]).unwrap());
        analysis.factorize(&k.matrix, k.by).unwrap().unwrap()
    }

    fn apart(a: &[f64], b: &[f64]) -> f64 {
        let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        norm(&difference) / norm(b)
    }

    #[test]
    fn refined_solutions_are_those_of_the_factor_in_double_precision() {
        let k = chain(60, 0.3);
        let (factor, slabs) = (factor(&k), Slabs::of(0).unwrap());
        let rounded = Rounded::of(&factor, &k, &[], 1e-3, &slabs).unwrap().expect("such a chain allows it");
        let load = Random::default().vector(60, |_| 1.0).unwrap();
        let solutions = [
            |f: &Cholesky, _: &Rounded, x: &mut [f64]| f.solve(x),
            |_: &Cholesky, r: &Rounded, x: &mut [f64]| r.approximate(x),
            |_: &Cholesky, r: &Rounded, x: &mut [f64]| r.solve(x),
        ];
        let [own, near, refined] = solutions.map(|solve| {
            let mut x = load.clone();
            solve(&factor, &rounded, &mut x).unwrap();
            x
        });
        assert!((1e-10..1e-5).contains(&apart(&near, &own)), "{:e}", apart(&near, &own));
        assert!(apart(&refined, &own) < 1e-12, "{:e}", apart(&refined, &own));
    }

    #[test]
    fn entries_of_dual_operators_are_refined() {
        let k = chain(40, 1.0);
        let (factor, slabs) = (factor(&k), Slabs::of(0).unwrap());
        let rounded = Rounded::of(&factor, &k, &[], 1e-3, &slabs).unwrap().unwrap();
        let mut rows = Csr::empty(40);
        rows.push_row([(3, 1.0), (17, -1.0)]);
        rows.push_row([(39, 2.0)]);
        let form = rounded.inverse_form(&rows).unwrap();
        let expected = crate::linalg::cholesky::inverse_form(&factor, &rows).unwrap();
        for i in 0..2 {
            assert!((0..2).all(|j| (form.get(i, j) / expected.get(i, j) - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn a_factor_whose_rounding_would_be_felt_is_not_rounded() {
        for (ground, softness) in [(1e-7, 1.0), (1e-7, 1e-7), (1.0, 1e-6), (1.0, f64::NAN)] {
            let k = chain(30, ground);
            let slabs = Slabs::of(0).unwrap();
            assert!(
                Rounded::of(&factor(&k), &k, &[], softness, &slabs).unwrap().is_none(),
                "{ground} {softness}"
            );
        }
    }
}
