//! The components of K+, a factor of the library or the host's own, and how accurate a factor and a null space are, tested after
//! every factorisation.

use std::sync::Arc;

use crate::body::host::HostMultiple;
use crate::body::null_space::{largest, overflow, ROUNDING as KNOWN};
use crate::body::rounded::Rounded;
use crate::error::{Error, Kind, Result};
use crate::linalg::random::Random;
use crate::linalg::vector::weighted_norm;
use crate::linalg::{Breakdown, Cholesky, Matrix, Multiple};
use crate::platform::memory::zeros;

/// A pivot below minus this, relative to its diagonal entry, is no rounding error: a(u, u) >= 0 of (4) is violated.
const NEGATIVE_PIVOT: f64 = 1e-10;
/// K with the dofs held is singular when some v has `|A v|` below this against `| |A| |v| |`.
pub(super) const SINGULAR: f64 = 1e-13;
/// Random numbers have `n^-1/2` of their length along a given direction; this many times less is not expected. (A mode
/// that is missing is left with 1e-16 by rounding, far below `SINGULAR`: there it would take a thousand times less still.)
pub(super) const UNLIKELY: f64 = 1e3;
/// Largest residual of a solve with the factor, relative to its terms.
pub(super) const PROBE: f64 = 1e-8;
/// Rounding errors of R may be so many times those of the sample that is taken of them, ...
pub(super) const SAMPLE: f64 = 16.0;
/// ... and what is more against the fastest dof is none.
pub(super) const MOST_ERROR: f64 = 1e-7;
/// More than this of a row or a load is no rounding, however little is known of R: it is told as marginal.
pub(super) const MOST_ROUNDING: f64 = 1e-9;

#[derive(Clone)]
pub(super) enum Factor {
    /// Of K without the dofs held; bodies with the same matrix and the same dofs held share it.
    Own(Arc<Cholesky>),
    Rounded(Arc<Rounded>),
    /// Known by its products.
    Host(HostMultiple),
}

impl Factor {
    /// `x <- K+ x`
    pub fn solve(&self, x: &mut [f64]) -> Result<()> {
        match self {
            Self::Own(factor) => factor.solve(x),
            Self::Rounded(rounded) => rounded.solve(x),
            Self::Host(host) => host.solve_in_place(x),
        }
    }

    /// The same, but for rounding of the factor.
    pub fn approximate(&self, x: &mut [f64]) -> Result<()> {
        match self {
            Self::Rounded(rounded) => rounded.approximate(x),
            Self::Own(_) | Self::Host(_) => self.solve(x),
        }
    }
}

impl Breakdown {
    /// The error for a pivot so negative that K is indefinite.
    pub(super) fn refused(&self) -> Option<Error> {
        (self.relative_pivot < -NEGATIVE_PIVOT).then(|| self.indefinite())
    }

    pub(super) fn indefinite(&self) -> Error {
        let what = format!("the stiffness matrix is indefinite: pivot {:.1e} K_ii", self.relative_pivot);
        Error::new(Kind::Indefinite, what).dof(self.dof).value(self.relative_pivot).limit(0.0)
    }
}

/// A factorisation that ends without complaint proves nothing: solve for a known right-hand side b, and look for a
/// null vector v that vanishes on the fixing dofs by inverse iteration on A. The first step finds v by the part of b
/// along it; a second step is taken unless that part would have to be unlikely small.
///
/// `fixing`: dofs held; `modes`: dimension of the null space. Returns `|b| / | |K||x| |`: the part of a load that rounding
/// would be, were it 1.
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
    if softest.is_nan() || softest < UNLIKELY * (n as f64).sqrt() * SINGULAR {
        (0..n).for_each(|i| b[i] = k.metric(i, 1.0) * x[i]);
        x.copy_from_slice(&b);
        factor.solve(&mut x)?;
        k.mul_with_terms(&x, &mut image, &mut terms);
        softest = size(&b) / size(&terms);
    }
    if softest.is_nan() || softest < SINGULAR {
        return Err(missing_mode(largest(&x, |i| k.metric(i, 1.0)), softest, modes));
    }
    Ok(found)
}

/// `|K+ K R|`, zero but for errors of R: the factor enlarges what K makes of them as it has those of rounding. `parts`: dofs
/// of each and its null vectors, in the first columns of R.
pub(super) fn known_to(
    factor: &Factor,
    k: &Multiple,
    r: &Matrix,
    parts: &[(&[usize], usize)],
) -> Result<f64> {
    let (mut turned, _) = k.mul_columns(r)?;
    (0..turned.cols).try_for_each(|j| factor.solve(turned.col_mut(j)))?;
    let mut worst: f64 = KNOWN;
    for &(dofs, count) in parts {
        for j in 0..count {
            let size = |of: &Matrix| dofs.iter().map(|&i| of.get(i, j).abs()).fold(0.0, f64::max);
            worst = worst.max(SAMPLE * size(&turned) / size(r));
        }
    }
    Ok(worst.min(MOST_ERROR))
}

pub(super) fn missing_mode(dof: usize, found: f64, given: usize) -> Error {
    let what = format!(
        "a mode is missing: the stiffness matrix has more than the {given} null vectors known; \
         one is largest at this dof (|K v| = {found:.1e} |K||v|)"
    );
    Error::new(Kind::NullSpace, what).dof(dof).value(found).limit(SINGULAR)
}
