//! (14), corrected: `P'K P = [F S; S' S'F^-1 S]`, the r dofs held last, r the dimension of the null space of K.
//! (15): `K+ = P [F^-1 0; 0 0] P'`.
//! Symmetric and reflexive (`K K+ K = K`, `K+ K K+ = K+`), not the Moore-Penrose inverse.

use std::sync::Arc;

use crate::body::fixing::{fixing_dofs, given_dofs};
use crate::body::null_space::{largest, verified, NullSpaceInput};
use crate::body::search::Search;
use crate::error::{Error, Kind, Result};
use crate::linalg::memory::{room, zeros, PRODUCTS};
use crate::linalg::reach::inverse_form;
use crate::linalg::vector::weighted_norm;
use crate::linalg::{Analysis, Breakdown, Cholesky, Csr, Matrix, Packed, Symmetric};

/// A pivot below minus this, relative to its diagonal entry, is no rounding error: a(u, u) >= 0 of (4) is violated.
const NEGATIVE_PIVOT: f64 = 1e-10;
/// K with the dofs held is singular when some v has `|A v|` below this against `| |A| |v| |`.
pub(super) const SINGULAR: f64 = 1e-13;
/// Largest residual of a solve with the factor, relative to its terms.
const PROBE: f64 = 1e-8;

pub struct GeneralizedInverse {
    /// `R_p`, n x r, with `R'DR = I`.
    pub null_space: Matrix,
    /// The r dofs held.
    pub fixing: Vec<usize>,
    /// Of a null space that was found: the softest other motion against the stiffest of it, no unit.
    pub gap: Option<f64>,
    pub(super) factor: Cholesky,
}

/// The part of the setup that can be costed before it is done.
pub enum Plan {
    Known(Known),
    Search(Search),
}

/// The null space is known before the factorisation.
pub struct Known {
    k: Symmetric,
    null_space: Matrix,
    fixing: Vec<usize>,
    analysis: Option<Arc<Analysis>>,
}

impl GeneralizedInverse {
    /// Null space and fixing dofs of `k` (scaled so that its largest diagonal entry is in [1, 2)).
    pub fn plan(k: Symmetric, input: &NullSpaceInput, tolerance: f64) -> Result<Plan> {
        Self::plan_with(k, input, tolerance, None)
    }

    /// The same with the dofs to hold in K+, where the host has given them.
    pub fn plan_with(
        k: Symmetric,
        input: &NullSpaceInput,
        tolerance: f64,
        fixing: Option<&[usize]>,
    ) -> Result<Plan> {
        let per_dof = (8 * input.vectors.cols + 24) * size_of::<f64>();
        let _room = room(k.order() * per_dof + PRODUCTS, "the null space of a body")?;
        let null_space = verified(&k, input, tolerance)?;
        let root: Vec<f64> = (0..k.order()).map(|i| k.metric(i, 1.0).sqrt()).collect();
        let fixing = match fixing {
            Some(given) => given_dofs(&null_space, &root, given)?,
            None => fixing_dofs(&null_space, &root),
        };
        Ok(Plan::Known(Known { k, null_space, fixing, analysis: None }))
    }

    /// The same where nothing is known about the null space.
    pub fn search(k: Symmetric, tolerance: f64, fixing: Option<&[usize]>) -> Result<Plan> {
        Search::new(k, tolerance, fixing).map(Plan::Search)
    }

    /// (15): `x = K+ b`, both of length n; F^-1 on the free dofs, 0 on those held.
    pub fn apply(&self, b: &[f64], x: &mut [f64]) -> Result<()> {
        x.copy_from_slice(b);
        self.apply_in_place(x)
    }

    /// `x <- K+ x`
    pub fn apply_in_place(&self, x: &mut [f64]) -> Result<()> {
        self.factor.solve(x)
    }

    /// `B K+ B'` for the rows B (m x n) of this body.
    pub fn inverse_form(&self, rows: &Csr) -> Result<Packed> {
        inverse_form(&self.factor, rows)
    }
}

impl Plan {
    /// Orders the unknowns and finds the pattern of the factor, unless that has been done.
    pub fn analyse(&mut self) -> Result<&Arc<Analysis>> {
        match self {
            Self::Known(known) => known.analyse(),
            Self::Search(search) => search.analyse(),
        }
    }

    /// Bytes the factorisation is going to take, once it is analysed.
    pub fn bytes(&self) -> usize {
        let analysis = match self {
            Self::Known(known) => &known.analysis,
            Self::Search(search) => &search.analysis,
        };
        analysis.as_ref().map_or(0, |analysis| analysis.bytes())
    }

    /// Factorises F of (14) and probes; refuses a K that is indefinite, against (4), or more singular than its null
    /// space says.
    pub fn execute(self) -> Result<GeneralizedInverse> {
        match self {
            Self::Known(known) => known.execute(),
            Self::Search(search) => search.execute(),
        }
    }
}

impl Known {
    /// (14): F is K without the rows and columns of the fixing dofs.
    fn analyse(&mut self) -> Result<&Arc<Analysis>> {
        let analysis = match self.analysis.take() {
            Some(analysis) => analysis,
            None => {
                let mut held = vec![false; self.k.order()];
                self.fixing.iter().for_each(|&dof| held[dof] = true);
                Arc::new(Analysis::new(&self.k, &held)?)
            }
        };
        Ok(self.analysis.insert(analysis))
    }

    fn execute(mut self) -> Result<GeneralizedInverse> {
        let factor = Arc::clone(self.analyse()?).factorize(&self.k)?.map_err(|breakdown| {
            let missing = || missing_mode(breakdown.dof, breakdown.relative_pivot, self.null_space.cols);
            breakdown.refused().unwrap_or_else(missing)
        })?;
        let (null_space, fixing) = (self.null_space, self.fixing);
        let inverse = GeneralizedInverse { null_space, fixing, gap: None, factor };
        inverse.probe(&self.k)?;
        Ok(inverse)
    }
}

impl Breakdown {
    /// The error for a pivot so negative that K is indefinite.
    pub(super) fn refused(&self) -> Option<Error> {
        let what = format!("the stiffness matrix is indefinite: pivot {:.1e} K_ii", self.relative_pivot);
        let error = Error::new(Kind::Indefinite, what).dof(self.dof).value(self.relative_pivot).limit(0.0);
        (self.relative_pivot < -NEGATIVE_PIVOT).then_some(error)
    }
}

impl GeneralizedInverse {
    /// A factorisation that ends without complaint proves nothing: solve for a known right-hand side, and
    /// look for a null vector that vanishes on the fixing dofs by two steps of inverse iteration on A.
    pub(super) fn probe(&self, k: &Symmetric) -> Result<()> {
        let n = k.order();
        if self.fixing.len() == n {
            return Ok(());
        }
        let free = |x: &mut [f64]| self.fixing.iter().for_each(|&dof| x[dof] = 0.0);
        let weight = |i: usize| 1.0 / k.metric(i, 1.0);
        let empty = || zeros(n, "a probe");
        let (mut b, mut x, mut image, mut terms) = (signs(k)?, empty()?, empty()?, empty()?);
        free(&mut b);
        self.apply(&b, &mut x)?;
        k.mul(&x, &mut image);
        k.mul_abs(&x, &mut terms);
        image.iter_mut().zip(&b).for_each(|(i, b)| *i -= b);
        free(&mut image);
        let residual =
            weighted_norm(&image, weight) / (weighted_norm(&terms, weight) + weighted_norm(&b, weight));
        if residual.is_nan() || residual > PROBE {
            let what = format!("the factorisation failed its probe: residual {residual:.1e}");
            return Err(Error::new(Kind::Internal, what).value(residual).limit(PROBE));
        }
        (0..n).for_each(|i| b[i] = k.metric(i, 1.0) * x[i]);
        self.apply(&b, &mut x)?;
        k.mul_abs(&x, &mut terms);
        let smallest = weighted_norm(&b, weight) / weighted_norm(&terms, weight);
        if smallest.is_nan() || smallest < SINGULAR {
            return Err(missing_mode(largest(&x, |i| k.metric(i, 1.0)), smallest, self.null_space.cols));
        }
        Ok(())
    }
}

fn missing_mode(dof: usize, found: f64, given: usize) -> Error {
    let what = format!(
        "a mode is missing: the stiffness matrix has more than the {given} null vectors given; \
         one is largest at this dof (|K v| = {found:.1e} |K||v|)"
    );
    Error::new(Kind::NullSpace, what).dof(dof).value(found).limit(SINGULAR)
}

/// `D^1/2` times a fixed sequence of signs.
fn signs(k: &Symmetric) -> Result<Vec<f64>> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut values = zeros(k.order(), "a probe")?;
    for (i, v) in values.iter_mut().enumerate() {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let sign = if state >> 63 == 0 { 1.0 } else { -1.0 };
        *v = sign * k.metric(i, 1.0).sqrt();
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::null_space::Modes;

    /// Plane grid of springs, n x n dofs, free: null space = constants, on each of `parts` copies.
    fn grids(n: usize, parts: usize) -> Symmetric {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for k in 0..parts * n * n {
            let i = k % (n * n);
            let edges = [(i >= n).then(|| k - n), (i % n > 0).then(|| k - 1)];
            for j in edges.into_iter().flatten() {
                col.push(j);
                val.push(-1.0);
            }
            let degree = [i >= n, i % n > 0, i + n < n * n, i % n + 1 < n];
            col.push(k);
            val.push(degree.into_iter().filter(|d| *d).count() as f64);
            ptr.push(col.len());
        }
        Symmetric { ptr, col, val }
    }

    fn constants(n: usize) -> NullSpaceInput {
        NullSpaceInput { vectors: Matrix { rows: n, cols: 1, data: vec![1.0; n] }, modes: Modes::Exact }
    }

    /// (14)-(15): `K K+ K = K`, column by column.
    #[test]
    fn k_kplus_k_is_k() {
        let k = grids(6, 1);
        let kplus = GeneralizedInverse::plan(k.clone(), &constants(36), 1e-8).unwrap().execute().unwrap();
        let (mut column, mut x, mut image) = (vec![0.0; 36], vec![0.0; 36], vec![0.0; 36]);
        for j in 0..36 {
            let mut unit = vec![0.0; 36];
            unit[j] = 1.0;
            k.mul(&unit, &mut column);
            kplus.apply(&column, &mut x).unwrap();
            k.mul(&x, &mut image);
            assert!(image.iter().zip(&column).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn a_missing_mode_is_noticed() {
        let k = grids(6, 2);
        let error = GeneralizedInverse::plan(k, &constants(72), 1e-8).unwrap().execute().err().unwrap();
        assert_eq!(error.kind, Kind::NullSpace);
        assert!(error.what.contains("a mode is missing"), "{error}");
    }

    #[test]
    fn an_indefinite_stiffness_is_refused_with_dof_and_pivot() {
        let mut k = grids(6, 1);
        let last = k.ptr[15] - 1;
        k.val[last] = 0.5;
        let none =
            NullSpaceInput { vectors: Matrix { rows: 36, cols: 0, data: vec![] }, modes: Modes::Exact };
        let error = GeneralizedInverse::plan(k, &none, 1e-8).unwrap().execute().err().unwrap();
        assert_eq!(error.kind, Kind::Indefinite);
        assert!(error.place.dof.is_some() && error.place.value.unwrap() < 0.0);
    }
}
