//! The forms of K+, a factor of the library or functions of the host, and the accuracy of a factor and a null space,
//! which is tested after every factorisation.

use std::sync::Arc;

use crate::body::elsewhere::Elsewhere;
use crate::body::host::HostMultiple;
use crate::body::null_space::{largest, orthonormal, overflow};
use crate::body::rounded::Rounded;
use crate::error::{Error, Kind, Result};
use crate::linalg::random::Random;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{axpy, dot, norm_max, ratio, weighted_norm, NOISE};
use crate::linalg::{Analysis, Breakdown, Cholesky, Matrix, Multiple};
use crate::numbers::body::{MOST_ERROR, NEGATIVE, PROBE, SAMPLE, SHARPENING, UNLIKELY};
use crate::numbers::rounding;
use crate::platform::memory::zeros;
use crate::platform::{interrupt, tally};

#[derive(Clone)]
pub(super) enum Factor {
    /// Factor of K without the dofs held, shared by bodies with equal matrices and equal dofs held.
    Own(Arc<Cholesky>),
    Rounded(Arc<Rounded>),
    /// Functions of the host for the products.
    Host(HostMultiple),
    /// The whole K+ is on another rank.
    Elsewhere(Elsewhere),
}

impl Factor {
    /// `x <- K+ x`
    pub fn solve(&self, x: &mut [f64]) -> Result<()> {
        match self {
            Self::Own(factor) => factor.solve(x),
            Self::Rounded(rounded) => rounded.solve(1.0, x),
            Self::Host(host) => host.solve_in_place(x),
            Self::Elsewhere(elsewhere) => elsewhere.solve(true, x),
        }
    }

    /// As `solve`, without the correction of rounding in the factor.
    pub fn approximate(&self, x: &mut [f64]) -> Result<()> {
        match self {
            Self::Rounded(rounded) => rounded.approximate(x),
            Self::Elsewhere(elsewhere) => elsewhere.solve(false, x),
            Self::Own(_) | Self::Host(_) => self.solve(x),
        }
    }
}

impl Breakdown {
    /// The error if the pivot is so negative that K is indefinite.
    pub(super) fn refused(&self) -> Option<Error> {
        (self.relative_pivot < -NEGATIVE).then(|| self.indefinite())
    }

    pub(super) fn indefinite(&self) -> Error {
        let what = format!("the stiffness matrix is indefinite: pivot {:.1e} K_ii", self.relative_pivot);
        Error::new(Kind::Indefinite, what).dof(self.dof).value(self.relative_pivot).limit(0.0)
    }
}

/// A factorisation that ends without error may still be wrong: solve for a known right-hand side b, and look for a null
/// vector v that is zero at the fixing dofs by inverse iteration on A. The first step finds v by the part of b along v; a
/// second step follows unless this part would have to be improbably small.
///
/// `fixing`: dofs held; `modes`: dimension of the null space. Returns `|b| / | |K||x| |`: by its inverse K+ amplifies
/// rounding.
pub(super) fn probe(factor: &Factor, k: &Multiple, fixing: &[usize], modes: usize) -> Result<f64> {
    let n = k.order();
    if fixing.len() == n {
        return Ok(1.0);
    }
    let free = |x: &mut [f64]| fixing.iter().for_each(|&dof| x[dof] = 0.0);
    let size = |x: &[f64]| weighted_norm(x, |i| 1.0 / k.metric(i, 1.0));
    let empty = || zeros(n, "a probe");
    let b = Random::default().vector(n, |i| k.metric(i, 1.0).sqrt())?;
    let (mut b, mut x, mut image, mut terms) = (b, empty()?, empty()?, empty()?);
    free(&mut b);
    x.copy_from_slice(&b);
    factor.solve(&mut x)?;
    k.mul_with_terms(&x, &mut image, &mut terms);
    image.iter_mut().zip(&b).for_each(|(i, b)| *i -= b);
    free(&mut image);
    let whole = size(&terms) + size(&b);
    let residual = size(&image) / whole;
    if residual.is_nan() || !whole.is_finite() {
        return Err(overflow());
    }
    if residual > PROBE {
        let what = format!("the factorisation failed its probe: residual {residual:.1e}");
        return Err(Error::new(Kind::Internal, what).value(residual).limit(PROBE));
    }
    let mut softest = size(&b) / size(&terms);
    let found = softest;
    // singular: some |A v| is rounding of |A||v|; rounding leaves 1e-16 of a missing motion
    if softest.is_nan() || softest < UNLIKELY * (n as f64).sqrt() * rounding::SOLVE {
        (0..n).for_each(|i| b[i] = k.metric(i, 1.0) * x[i]);
        x.copy_from_slice(&b);
        factor.solve(&mut x)?;
        k.mul_with_terms(&x, &mut image, &mut terms);
        softest = size(&b) / size(&terms);
    }
    if softest.is_nan() || softest < rounding::SOLVE {
        return Err(missing_mode(largest(&x, |i| k.metric(i, 1.0)), softest, modes));
    }
    Ok(found)
}

/// `|K+ K R|`, zero except for errors of R: the factor amplifies the residual K R as it amplifies rounding.
pub(super) fn known_to(factor: &Factor, k: &Multiple, r: &Matrix) -> Result<f64> {
    let (mut turned, _) = k.mul_columns(r)?;
    let mut worst: f64 = NOISE;
    for j in 0..r.cols {
        factor.solve(turned.col_mut(j))?;
        worst = worst.max(SAMPLE * norm_max(turned.col(j)) / norm_max(r.col(j)));
    }
    Ok(worst.min(MOST_ERROR))
}

/// `R - (K + theta D)^-1 K R` with `R'DR = I`, theta rounding over the error of R, if only rounding of K resists it: R was given
/// with fewer digits than K has. None if K resists these motions: errors of R enter `R'K R` squared, those of K do not. Parts so
/// soft that rounding of K would move them more are left unchanged.
pub(super) fn sharpened(k: &Multiple, r: &Matrix) -> Result<Option<Matrix>> {
    let (image, terms) = k.mul_columns(r)?;
    let error = resistance(&image, &terms);
    let is_rounding = |i: usize, j: usize| {
        let size = r.col(i).iter().zip(terms.col(j)).map(|(r, terms)| r.abs() * terms).sum::<f64>();
        dot(r.col(i), image.col(j)).abs() <= NOISE * size
    };
    if error <= NOISE || !(0..r.cols).all(|j| (0..=j).all(|i| is_rounding(i, j))) {
        return Ok(None);
    }
    interrupt::check()?;
    tally::costly();
    let mut shifted = k.matrix.copied("a null space")?;
    let theta = SHARPENING * f64::EPSILON / error;
    (0..r.rows).for_each(|i| shifted.val[shifted.ptr[i + 1] - 1] *= 1.0 + theta);
    let analysis = Arc::new(Analysis::new(&shifted, &vec![false; r.rows])?);
    let Ok(factor) = analysis.attempt(&shifted, k.by)? else { return Ok(None) };
    let mut sharp = r.clone();
    for j in 0..r.cols {
        let mut image = vec![Twofold::default(); r.rows];
        k.matrix.add_twofold(k.by, r.col(j), &mut image);
        let mut excess: Vec<f64> = image.into_iter().map(Twofold::value).collect();
        factor.solve(&mut excess)?;
        axpy(-1.0, &excess, sharp.col_mut(j));
    }
    let sharp = orthonormal(|i| k.metric(i, 1.0), &sharp)?;
    let (image, terms) = k.mul_columns(&sharp)?;
    Ok((resistance(&image, &terms) <= NOISE).then_some(sharp))
}

/// `max_i |(K R)_i| / |(|K||R|)_i|` over the rows i: at an unknown that some vector hardly moves, others tell what is rounding.
fn resistance(image: &Matrix, terms: &Matrix) -> f64 {
    let row = |m: &Matrix, i: usize| (0..m.cols).map(|j| m.get(i, j) * m.get(i, j)).sum::<f64>().sqrt();
    (0..image.rows).map(|i| ratio(row(image, i), row(terms, i))).fold(0.0, f64::max)
}

pub(super) fn missing_mode(dof: usize, found: f64, given: usize) -> Error {
    let what = format!(
        "a mode is missing: the stiffness matrix has more than the {given} null vectors known; \
         one is largest at this dof (|K v| = {found:.1e} |K||v|)"
    );
    Error::new(Kind::NullSpace, what).dof(dof).value(found).limit(rounding::SOLVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Symmetric;

    /// A free chain of springs, the first unknown held by `ground`.
    fn chain(springs: &[f64], ground: f64) -> Multiple {
        let (mut ptr, mut col, mut val) = (vec![0, 1], vec![0], vec![springs[0] + ground]);
        for (i, s) in springs.iter().enumerate() {
            let next = springs.get(i + 1).unwrap_or(&0.0);
            col.extend([i as u32, i as u32 + 1]);
            val.extend([-s, s + next]);
            ptr.push(col.len());
        }
        Symmetric::new(ptr, col, val).into()
    }

    fn constants(error: f64) -> Matrix {
        Matrix::from_fn(5, 1, |i, _| 1.0 + error * (3 * i % 5) as f64).unwrap()
    }

    /// Except for noise, the part behind the soft spring moves as before.
    #[test]
    fn a_null_vector_with_noise_becomes_one_that_only_rounding_resists() {
        for springs in [[1.0, 2.0, 3.0, 1.0], [1.0, 2.0, 1e-9, 3.0]] {
            let k = chain(&springs, 0.0);
            let sharp = sharpened(&k, &constants(1e-12)).unwrap().unwrap();
            let (image, terms) = k.mul_columns(&sharp).unwrap();
            assert!(resistance(&image, &terms) <= NOISE);
            assert!(sharp.data.iter().all(|r| (r / sharp.data[0] - 1.0).abs() < 1e-11), "{sharp:?}");
        }
    }

    #[test]
    fn a_null_vector_that_k_resists_or_that_is_sharp_stays_as_it_is() {
        for (ground, error) in [(1e-10, 1e-12), (0.0, 0.0)] {
            assert!(sharpened(&chain(&[1.0, 2.0, 3.0, 1.0], ground), &constants(error)).unwrap().is_none());
        }
    }
}
