//! Rigid motions to the accuracy of K: if a null space is given with few digits, the resistance of K to it is not strain.

use std::sync::Arc;

use crate::body::Stiffness;
use crate::certificate::{BodyData, NOISE};
use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::axpy;
use crate::linalg::{Analysis, Cholesky, Symmetric};
use crate::platform::memory::{copied, zeros};
use crate::platform::{interrupt, tally};

const WHAT: &str = "a rigid motion";

/// Removes the errors of the null space from a rigid motion w of a body: `w - (K + theta D)^-1 K w`, with theta rounding
/// over the error of w. Parts so soft that rounding of K would move them more are left unchanged.
pub enum Cleaner {
    Of(Box<Cholesky>),
    /// K is not given by its entries, or K + theta D is not positive definite.
    Impossible,
}

impl Cleaner {
    fn new(body: &BodyData, error: f64) -> Result<Self> {
        let Stiffness::Matrix(k) = body.stiffness else { return Ok(Self::Impossible) };
        interrupt::check()?;
        tally::costly();
        let shifted = shifted(k, f64::EPSILON / error)?;
        let analysis = Arc::new(Analysis::new(&shifted, &vec![false; k.order()])?);
        let factor = analysis.factorize(&shifted, 1.0 / body.unit)?;
        Ok(factor.map_or(Self::Impossible, |factor| Self::Of(Box::new(factor))))
    }

    fn cleaned(&self, body: &BodyData, w: &[f64]) -> Result<Option<Vec<f64>>> {
        let (Self::Of(factor), Stiffness::Matrix(k)) = (self, body.stiffness) else { return Ok(None) };
        let mut image = vec![Twofold::default(); w.len()];
        k.add_twofold(1.0 / body.unit, w, &mut image);
        let mut excess: Vec<f64> = image.into_iter().map(Twofold::value).collect();
        factor.solve(&mut excess)?;
        let mut cleaned = copied(w, WHAT)?;
        axpy(-1.0, &excess, &mut cleaned);
        Ok(Some(cleaned))
    }
}

/// True if K resists the motion w of a body by rounding alone, after w is cleaned if necessary; makes the cleaner of the
/// body if there is none.
pub fn unresisted(body: &BodyData, w: &mut [f64], cleaner: &mut Option<Cleaner>) -> Result<bool> {
    let error = resistance(body, w)?;
    if error <= NOISE {
        return Ok(true);
    }
    let cleaner = match cleaner {
        Some(cleaner) => cleaner,
        None => cleaner.insert(Cleaner::new(body, error)?),
    };
    let Some(cleaned) = cleaner.cleaned(body, w)? else { return Ok(false) };
    let is_unresisted = resistance(body, &cleaned)? <= NOISE;
    if is_unresisted {
        w.copy_from_slice(&cleaned);
    }
    Ok(is_unresisted)
}

/// `max |K w|_j / (|K||w|)_j`
fn resistance(body: &BodyData, w: &[f64]) -> Result<f64> {
    let (mut image, mut terms) = (zeros(w.len(), WHAT)?, zeros(w.len(), WHAT)?);
    body.stiffness.mul_with_terms(w, &mut image, &mut terms)?;
    let shares = image.iter().zip(&terms).filter(|(image, _)| **image != 0.0);
    Ok(shares.map(|(image, terms)| image.abs() / terms).fold(0.0, f64::max))
}

/// `K + theta D`
fn shifted(k: &Symmetric, theta: f64) -> Result<Symmetric> {
    let mut val = copied(&k.val, WHAT)?;
    for i in 0..k.order() {
        val[k.ptr[i + 1] - 1] *= 1.0 + theta;
    }
    Ok(Symmetric::new(copied(&k.ptr, WHAT)?, copied(&k.col, WHAT)?, val))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Matrix;

    /// A free chain of springs, and one connected to the ground with stiffness `ground`.
    fn with_chain(springs: &[f64], ground: f64, work: impl Fn(&BodyData)) {
        let (mut ptr, mut col, mut val) = (vec![0, 1], vec![0], vec![springs[0] + ground]);
        for (i, s) in springs.iter().enumerate() {
            let next = springs.get(i + 1).unwrap_or(&0.0);
            col.extend([i as u32, i as u32 + 1]);
            val.extend([-s, s + next]);
            ptr.push(col.len());
        }
        let (k, null_space) = (Symmetric::new(ptr, col, val), Matrix::zeros(springs.len() + 1, 0).unwrap());
        let stiffness = Stiffness::from(&k);
        work(&BodyData {
            start: 0,
            stiffness,
            load: None,
            null_space: &null_space,
            soft: false,
            unit: 1.0,
            grounded: &[],
        });
    }

    fn noisy(error: f64) -> Vec<f64> {
        (0..5).map(|i| 1e6 * (1.0 + error * f64::from(3 * i % 5))).collect()
    }

    /// Except for noise, the part behind the soft spring moves as before.
    #[test]
    fn a_motion_with_noise_becomes_one_that_only_rounding_resists() {
        for springs in [[1.0, 2.0, 3.0, 1.0], [1.0, 2.0, 1e-9, 3.0]] {
            with_chain(&springs, 0.0, |body| {
                let mut w = noisy(1e-12);
                assert!(resistance(body, &w).unwrap() > 1e-13);
                assert!(unresisted(body, &mut w, &mut None).unwrap());
                assert!(resistance(body, &w).unwrap() <= NOISE);
                assert!(w.iter().all(|w| (w / 1e6 - 1.0).abs() < 5e-12));
            });
        }
    }

    #[test]
    fn a_motion_that_a_soft_support_resists_stays_as_it_is() {
        with_chain(&[1.0, 2.0, 3.0, 1.0], 1e-10, |body| {
            let mut w = noisy(1e-12);
            assert!(!unresisted(body, &mut w, &mut None).unwrap());
            assert_eq!(w, noisy(1e-12));
        });
    }

    #[test]
    fn an_exact_motion_keeps_its_bits() {
        with_chain(&[0.1, 0.7, 1e-9, 0.3], 0.0, |body| {
            let mut w = vec![1e6; 5];
            assert!(unresisted(body, &mut w, &mut None).unwrap());
            assert_eq!(w, [1e6; 5]);
        });
    }
}
