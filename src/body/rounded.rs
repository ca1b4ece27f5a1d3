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
use crate::linalg::cholesky::inverse_form;
use crate::linalg::random::Random;
use crate::linalg::vector::{axpy, power_of_two_below, weighted_norm};
use crate::linalg::{Cholesky, Csr, Multiple, Packed};
use crate::numbers::body::{CONVERGED, REACHED_ROUNDING, ROUNDINGS, SHARE, TINY};
use crate::platform::memory::{copied, zeros};
use crate::platform::slabs::Slabs;
use crate::ranks::wire_enum;

/// The precision of a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    Double,
    /// Rounded to single precision, if K allows it.
    Rounded,
    /// Computed in single precision, if that saves time and K allows it.
    Single,
}

wire_enum!(Precision { Double, Rounded, Single });

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
        let rounded = Self::with(factor.rounded(slabs)?, k, held, softness);
        // a load that strains all dofs equally
        let load: Vec<f64> = (0..k.order()).map(|i| k.metric(i, 1.0).sqrt()).collect();
        let mut x = copied(&load, WHAT)?;
        rounded.approximate(&mut x)?;
        let left = rounded.size(&rounded.left(&load, &x)?);
        Ok((left <= SHARE * rounded.size(&load)).then_some(rounded))
    }

    fn with(factor: Cholesky<f32>, k: &Multiple, held: &[usize], softness: f64) -> Self {
        Self { factor, k: k.clone(), held: held.to_vec(), rounding: Self::rounding(softness) }
    }

    fn rounding(softness: f64) -> f64 {
        ROUNDINGS * f64::EPSILON * (1.0 / softness).max(4.0)
    }

    /// A factor that was computed in single precision, and the softness of a random load. None if K, whose null space may not be
    /// known completely, is not so regular that corrections lead to rounding: the part of the load along a missing motion would stay.
    pub fn computed(factor: Cholesky<f32>, k: &Multiple, held: &[usize]) -> Result<Option<(Self, f64)>> {
        if held.len() == k.order() || factor.smallest_pivot() <= TINY {
            return Ok(None);
        }
        let mut load = Random::default().vector(k.order(), |i| k.metric(i, 1.0).sqrt())?;
        held.iter().for_each(|&dof| load[dof] = 0.0);
        let (mut x, mut image, mut terms) =
            (copied(&load, WHAT)?, zeros(load.len(), WHAT)?, zeros(load.len(), WHAT)?);
        factor.solve(&mut x)?;
        k.mul_with_terms(&x, &mut image, &mut terms);
        image.iter_mut().zip(&load).for_each(|(image, load)| *image -= load);
        held.iter().for_each(|&dof| image[dof] = 0.0);
        let mut rounded = Self::with(factor, k, held, 1.0);
        let size = rounded.size(&load);
        let softness = size / rounded.size(&terms);
        // false also for NaN
        if !(softness * SHARE > SINGLE && rounded.size(&image) <= SHARE * size) {
            return Ok(None);
        }
        rounded.rounding = Self::rounding(softness);
        let left = rounded.improved(1.0, &load, &mut x, |x| rounded.approximate(x))?;
        Ok((left <= CONVERGED * rounded.rounding).then_some((rounded, softness)))
    }

    /// `B K~+ B'` for the rows B (m x n) of this body: by rows with largest entries in [1, 2), since single precision cannot hold the
    /// squares of rows that belong to bodies of very different stiffness.
    pub fn form(&self, rows: &Csr) -> Result<Packed> {
        let m = rows.rows();
        let largest = |i: usize| rows.row(i).fold(0.0, |most: f64, (_, v)| most.max(v.abs()));
        let by: Vec<f64> = (0..m).map(|i| power_of_two_below(largest(i))).collect();
        let mut even = Csr::with_room(rows.cols, m, rows.val.len());
        (0..m).for_each(|i| even.push_row(rows.row(i).map(|(dof, v)| (dof, v / by[i]))));
        let mut form = inverse_form(&self.factor, &even)?;
        form.scale(&by);
        Ok(form)
    }

    /// `x <- K~+ x`
    pub fn approximate(&self, x: &mut [f64]) -> Result<()> {
        self.factor.solve(x)
    }

    /// `x <- K+ x`, refined; x is the given `share` of a whole load, relative to which its rounding counts.
    pub fn solve(&self, share: f64, x: &mut [f64]) -> Result<()> {
        self.refined(share, x, |x| self.approximate(x)).map(drop)
    }

    /// Solves `K x = b - K v` for x, b in x on entry, refined by solves close to those with K.
    pub fn solve_without(
        &self,
        motion: &[f64],
        share: f64,
        x: &mut [f64],
        near: impl Fn(&mut [f64]) -> Result<()>,
    ) -> Result<()> {
        let left = self.left(x, motion)?;
        x.copy_from_slice(&left);
        self.refined(share, x, near).map(drop)
    }

    /// `x <- near(b)`, b in x on entry, improved.
    fn refined(&self, share: f64, x: &mut [f64], near: impl Fn(&mut [f64]) -> Result<()>) -> Result<f64> {
        if x.iter().all(|x| *x == 0.0) {
            return Ok(0.0);
        }
        let load = copied(x, WHAT)?;
        near(x)?;
        self.improved(share, &load, x, near)
    }

    /// `x <- x + near(b - K x)` while this reduces the residual. Returns the last residual that was computed, relative to b.
    fn improved(
        &self,
        share: f64,
        load: &[f64],
        x: &mut [f64],
        near: impl Fn(&mut [f64]) -> Result<()>,
    ) -> Result<f64> {
        let size = self.size(load);
        let rounding = self.rounding / share * size;
        let (mut before, mut last) = (size, size);
        for _ in 0..CORRECTIONS {
            let mut left = self.left(load, x)?;
            let now = self.size(&left);
            last = now;
            // true also for NaN
            if !(now > rounding && now < REACHED_ROUNDING * before) {
                break;
            }
            near(&mut left)?;
            axpy(1.0, &left, x);
            before = now;
        }
        Ok(last / size)
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
            |_: &Cholesky, r: &Rounded, x: &mut [f64]| r.solve(1.0, x),
        ];
        let [own, near, refined] = solutions.map(|solve| {
            let mut x = load.clone();
            solve(&factor, &rounded, &mut x).unwrap();
            x
        });
        assert!((1e-10..1e-5).contains(&apart(&near, &own)), "{:e}", apart(&near, &own));
        assert!(apart(&refined, &own) < 1e-12, "{:e}", apart(&refined, &own));
    }

    /// A factor computed in single precision of a chain whose first spring has stiffness `ground`; none if there is none.
    fn computed(n: usize, ground: f64) -> Option<Rounded> {
        let k = chain(n, ground);
        let analysis = Arc::new(Analysis::new(&k.matrix, &vec![false; n]).unwrap());
        let factor = analysis.pivoted::<f32>(&k.matrix, k.by, 0.0).unwrap().ok()?;
        Rounded::computed(factor, &k, &[]).unwrap().map(|made| made.0)
    }

    #[test]
    fn a_factor_computed_in_single_precision_gives_refined_solutions_and_refuses_what_it_cannot_see() {
        let (n, k) = (60, chain(60, 0.3));
        let single = computed(n, 0.3).expect("such a chain allows it");
        let load = Random::default().vector(n, |_| 1.0).unwrap();
        let (mut own, mut refined, mut share) = (load.clone(), load.clone(), load.clone());
        factor(&k).solve(&mut own).unwrap();
        single.solve(1.0, &mut refined).unwrap();
        single.solve(1e-6, &mut share).unwrap();
        assert!(apart(&refined, &own) < 1e-11, "{:e}", apart(&refined, &own));
        assert!((1e-14..1e-6).contains(&apart(&share, &refined)), "{:e}", apart(&share, &refined));
        // free, almost free, and driven: the motion that is left would have to be resisted by more than rounding
        for ground in [0.0, 1e-9, -1e-9, 1e-7, -1e-7, 1e-6] {
            assert!((20..60).all(|n| computed(n, ground).is_none()), "{ground}");
        }
    }

    #[test]
    fn entries_of_dual_operators_are_those_of_double_precision_to_rounding_whatever_the_lengths_of_rows() {
        let (k, single) = (chain(60, 0.3), computed(60, 0.3).unwrap());
        let mut rows = Csr::empty(60);
        rows.push_row([(3, 1e-90), (17, -2e-90)]);
        rows.push_row([]);
        rows.push_row([(39, 2e60)]);
        let (form, expected) = (single.form(&rows).unwrap(), inverse_form(&factor(&k), &rows).unwrap());
        for (i, j) in [(0, 0), (2, 0), (2, 2)] {
            assert!((form.get(i, j) / expected.get(i, j) - 1.0).abs() < 1e-4, "{i} {j}");
        }
        assert_eq!([0, 1, 2].map(|j| form.get(1, j)), [0.0; 3]);
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
