//! (14), corrected: `P'K P = [F S; S' S'F^-1 S]`, the r dofs held last, r the dimension of the null space of K.
//! (15): `K+ = P [F^-1 0; 0 0] P'`.
//! Symmetric and reflexive (`K K+ K = K`, `K+ K K+ = K+`), not the Moore-Penrose inverse.

use std::borrow::Cow;
use std::sync::Arc;

use crate::body::carried::Carried;
use crate::body::coarse::Coarse;
use crate::body::elsewhere::Elsewhere;
use crate::body::host::HostMultiple;
use crate::body::layout::Symbolic;
use crate::body::misfit::Misfit;

use crate::body::probe::Factor;
use crate::body::rounded::Rounded;
use crate::body::spectrum::Doubt;
use crate::error::{Error, Kind, Result};
use crate::linalg::cholesky::inverse_form;
use crate::linalg::{Csr, Matrix, Multiple, Packed};
use crate::platform::memory::zeros;
use crate::platform::slabs::Slabs;

#[derive(Clone)]
pub struct GeneralizedInverse {
    /// `R_p`, n x r, with `R'DR = I`; n x 0 if another rank has it.
    pub(super) null_space: Matrix,
    /// `lambda_j = r_j'K r_j` for soft or carried motions, 0 for the others; empty if K resists no motion. K+ is that of
    /// a K without this stiffness: see `soft` and `carried`.
    pub stiffness: Vec<f64>,
    /// Rounding of the vectors, relative to the fastest dof of each, no unit: a smaller part of a row or a load counts as
    /// 0.
    pub rounding: f64,
    /// Accuracy of the vectors, at least `rounding`: a motion that rows resist by less than this may be unresisted.
    pub error: f64,
    /// The r dofs held; empty if K+ is the host's.
    pub fixing: Vec<usize>,
    /// If the null space was found by the library: ratio of the softest other motion to its stiffest, no unit.
    pub gap: Option<f64>,
    /// `|f| / | |K||K+ f| |` for a random load, no unit: K+ amplifies rounding by its inverse.
    pub softness: f64,
    /// Motions whose resistance may be only rounding of the entries of K.
    pub doubt: Option<Doubt>,
    /// Coordinates or candidates of which not all fit: with `gap`, the library searched the null space in K; otherwise K
    /// holds the others.
    pub misfit: Option<Misfit>,
    pub(super) factor: Factor,
    /// The correction of K+ for the carried motions, which are the last.
    pub(super) carried: Option<Arc<Carried>>,
    /// The correction for K~+ of a rounded factor.
    pub(super) near: Option<Arc<Carried>>,
}

/// `K_p+` of a body and the work to make it.
pub struct Factorised {
    pub inverse: GeneralizedInverse,
    /// The analysis its factor belongs to.
    pub symbolic: Arc<Symbolic>,
    /// Analyses after the first, if the search for the null space had to begin again.
    pub further_analyses: usize,
    /// Numeric factorisations, including those that missed a motion of the null space.
    pub factorisations: usize,
}

impl GeneralizedInverse {
    /// Number of unknowns n.
    pub fn order(&self) -> usize {
        self.null_space.rows
    }

    /// Number r of motions of the null space.
    pub fn motions(&self) -> usize {
        self.elsewhere().map_or(self.null_space.cols, |elsewhere| elsewhere.motions)
    }

    /// `R_p`, n x r, with `R'DR = I`, if it is here.
    pub fn null_space(&self) -> Result<&Matrix> {
        match self.elsewhere() {
            None => Ok(&self.null_space),
            Some(_) => {
                Err(Error::new(Kind::Internal, "the null space of a body is looked for on the wrong rank"))
            }
        }
    }

    /// `R_p`, wherever it is.
    pub fn bring_null_space(&self) -> Result<Cow<'_, Matrix>> {
        match self.elsewhere() {
            None => Ok(Cow::Borrowed(&self.null_space)),
            Some(elsewhere) => elsewhere.null_space().map(Cow::Owned),
        }
    }

    /// (15): `x = K+ b`, both of length n; F^-1 on the free dofs, 0 on those held.
    pub fn apply(&self, b: &[f64], x: &mut [f64]) -> Result<()> {
        x.copy_from_slice(b);
        self.apply_in_place(x)
    }

    /// `x <- K+ x`
    pub fn apply_in_place(&self, x: &mut [f64]) -> Result<()> {
        self.apply_to_share(1.0, x)
    }

    /// As `apply_in_place`, for a `share` of a whole load, relative to which rounding counts.
    fn apply_to_share(&self, share: f64, x: &mut [f64]) -> Result<()> {
        match (&self.carried, &self.near, &self.factor) {
            (Some(carried), Some(near), Factor::Rounded(rounded)) => {
                // the carried motions, which K may hardly resist, are not added and then subtracted
                let motions = carried.motions_under(x)?;
                let near = |x: &mut [f64]| near.apply_in_place(x, |x| rounded.approximate(x));
                rounded.solve_without(&motions, share, x, near)
            }
            (None, _, Factor::Rounded(rounded)) => rounded.solve(share, x),
            (Some(carried), ..) => carried.apply_in_place(x, |x| self.factor.solve(x)),
            (None, ..) => self.factor.solve(x),
        }
    }

    /// `x <- K~+ x` by a rounded factor without refinement, otherwise `K+ x`.
    pub fn approximate_in_place(&self, x: &mut [f64]) -> Result<()> {
        match &self.near {
            Some(carried) => carried.apply_in_place(x, |x| self.factor.approximate(x)),
            None if self.carried.is_some() => self.apply_in_place(x),
            None => self.factor.approximate(x),
        }
    }

    /// `x <- K+ x` for a share of a whole load, relative to which rounding counts; without it, by `approximate_in_place`.
    pub fn solve_in_place(&self, share: Option<f64>, x: &mut [f64]) -> Result<()> {
        match share {
            Some(share) => self.apply_to_share(share, x),
            None => self.approximate_in_place(x),
        }
    }

    /// The factor is in single precision, and solutions are refined.
    pub fn is_rounded(&self) -> bool {
        let elsewhere = self.elsewhere().is_some_and(|elsewhere| elsewhere.is_rounded);
        elsewhere || matches!(&self.factor, Factor::Rounded(_))
    }

    /// Bytes saved by the rounded factor.
    pub fn bytes_saved(&self) -> usize {
        match &self.factor {
            Factor::Rounded(rounded) => rounded.factor.value_bytes(),
            Factor::Elsewhere(elsewhere) => elsewhere.bytes_saved,
            Factor::Own(_) | Factor::Host(_) => 0,
        }
    }

    /// Bytes of its factor; none if it is not here.
    pub fn bytes(&self) -> Option<usize> {
        match &self.factor {
            Factor::Own(factor) => Some(factor.analysis.bytes()),
            Factor::Rounded(rounded) => {
                Some(rounded.factor.analysis.bytes().saturating_sub(self.bytes_saved()))
            }
            Factor::Elsewhere(_) | Factor::Host(_) => None,
        }
    }

    /// Rounds its factor to single precision, in `slabs`, if K allows it.
    pub fn rounded(mut self, k: &Multiple, slabs: &Slabs) -> Result<Self> {
        let rounded = match &self.factor {
            Factor::Own(factor) => Rounded::of(factor, k, &self.fixing, self.softness, slabs)?,
            Factor::Rounded(_) | Factor::Host(_) | Factor::Elsewhere(_) => None,
        };
        if let Some(rounded) = rounded {
            let own = std::mem::replace(&mut self.factor, Factor::Rounded(Arc::new(rounded)));
            self.find_near(k)?;
            if self.carried.is_some() && self.near.is_none() {
                self.factor = own;
            }
        }
        Ok(self)
    }

    /// Computes the correction of K~+ for the carried motions.
    pub(super) fn find_near(&mut self, k: &Multiple) -> Result<()> {
        let near = |carried: &Arc<Carried>| carried.near(k, |x| self.factor.approximate(x));
        self.near = match &self.carried {
            Some(carried) if self.is_rounded() => near(carried)?.map(Arc::new),
            _ => None,
        };
        Ok(())
    }

    /// K has positive or negative stiffness along some motion of the null space.
    pub fn is_soft(&self) -> bool {
        self.stiffness.iter().take(self.own_motions()).any(|stiffness| *stiffness != 0.0)
    }

    /// Number of motions that K does not resist.
    pub fn floating(&self) -> usize {
        let resisted = self.stiffness.iter().filter(|stiffness| **stiffness != 0.0).count();
        self.motions() - resisted
    }

    /// Number of carried motions, which are the last.
    pub fn carried_motions(&self) -> usize {
        match &self.factor {
            Factor::Elsewhere(elsewhere) => elsewhere.carried,
            _ => self.carried.as_ref().map_or(0, |carried| carried.count()),
        }
    }

    /// Number of motions that are not carried.
    pub(super) fn own_motions(&self) -> usize {
        self.motions() - self.carried_motions()
    }

    /// The null space without the carried motions, wherever it is.
    pub fn free_motions(&self) -> Result<Matrix> {
        Ok(self.bring_null_space()?.columns(0..self.own_motions()))
    }

    /// Entries of the factor; 0 if the host has the factor.
    pub fn entries(&self) -> usize {
        match &self.factor {
            Factor::Own(factor) => factor.analysis.entries(),
            Factor::Rounded(rounded) => rounded.factor.analysis.entries(),
            Factor::Elsewhere(elsewhere) => elsewhere.entries,
            Factor::Host(_) => 0,
        }
    }

    /// It must be applied on the thread that calls the library.
    pub fn on_caller(&self) -> bool {
        self.elsewhere().is_some() || self.host().is_some_and(|host| host.operator.on_caller())
    }

    /// Address of its factor: equal for all bodies that share the factor.
    pub fn factor_address(&self) -> usize {
        match &self.factor {
            Factor::Own(factor) => Arc::as_ptr(factor) as usize,
            Factor::Rounded(rounded) => Arc::as_ptr(rounded) as usize,
            Factor::Host(host) => Arc::as_ptr(&host.operator) as usize,
            Factor::Elsewhere(elsewhere) => elsewhere.factor as usize,
        }
    }

    /// The functions of the host, if they give K+.
    pub fn host(&self) -> Option<&HostMultiple> {
        match &self.factor {
            Factor::Host(host) => Some(host),
            Factor::Own(_) | Factor::Rounded(_) | Factor::Elsewhere(_) => None,
        }
    }

    /// The K+ that another rank keeps, if this one is there.
    pub fn elsewhere(&self) -> Option<&Elsewhere> {
        match &self.factor {
            Factor::Elsewhere(elsewhere) => Some(elsewhere),
            Factor::Own(_) | Factor::Rounded(_) | Factor::Host(_) => None,
        }
    }

    /// `B K+ B' x` for the rows B (m x n) of this body, by `solve_in_place`.
    pub fn product_between(&self, rows: &Csr, x: &[f64], share: Option<f64>) -> Result<Vec<f64>> {
        let what = "a product with the dual operator";
        let (mut moved, mut image) = (zeros(rows.cols, what)?, zeros(rows.rows(), what)?);
        rows.mul_transposed_add(1.0, x, &mut moved);
        self.solve_in_place(share, &mut moved)?;
        rows.mul(&moved, &mut image);
        Ok(image)
    }

    /// `B K+ B'` for the rows B (m x n) of this body; `B K~+ B'` if the factor is rounded.
    pub fn inverse_form(&self, rows: &Csr) -> Result<Packed> {
        let mut form = match &self.factor {
            Factor::Own(factor) => inverse_form(factor, rows)?,
            Factor::Rounded(rounded) => rounded.form(rows)?,
            Factor::Host(host) => host.inverse_form(rows)?,
            Factor::Elsewhere(_) => {
                return Err(Error::new(Kind::Internal, "K+ of a body is looked for on the wrong rank"));
            }
        };
        let carried = self.near.as_ref().or(self.carried.as_ref());
        carried.iter().try_for_each(|carried| carried.take_from_form(rows, &mut form))?;
        Ok(form)
    }

    /// What these rows, m_p x n, make of its motions. `by`: the power of two by which K+ is multiplied in F.
    pub fn coarse(&self, rows: &Csr, by: f64) -> Coarse {
        let held = if self.stiffness.is_empty() { &[][..] } else { &self.fixing };
        let springs: Vec<f64> = self.springs(by).collect();
        Coarse::of((&self.null_space, held), (self.rounding, self.error), &springs, rows)
    }

    /// `lambda_j` of its soft and carried motions in the unit of forces of F, force / length.
    pub fn springs(&self, by: f64) -> impl Iterator<Item = f64> + '_ {
        self.stiffness.iter().map(move |stiffness| stiffness / by)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::null_space::{Modes, NullSpaceInput};
    use crate::error::Kind;
    use crate::linalg::Symmetric;

    /// Plane grid of springs, n x n dofs, free: the null space is the constants, on each of `parts` copies.
    fn grids(n: usize, parts: usize) -> Symmetric {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for k in 0..parts * n * n {
            let i = k % (n * n);
            let edges = [(i >= n).then(|| k - n), (i % n > 0).then(|| k - 1)];
            for j in edges.into_iter().flatten() {
                col.push(j as u32);
                val.push(-1.0);
            }
            let degree = [i >= n, i % n > 0, i + n < n * n, i % n + 1 < n];
            col.push(k as u32);
            val.push(degree.into_iter().filter(|d| *d).count() as f64);
            ptr.push(col.len());
        }
        Symmetric::new(ptr, col, val)
    }

    fn constants(n: usize) -> NullSpaceInput {
        NullSpaceInput { vectors: Matrix { rows: n, cols: 1, data: vec![1.0; n] }, modes: Modes::Exact }
    }

    /// (14)-(15): `K K+ K = K`, column by column.
    #[test]
    fn k_kplus_k_is_k() {
        let k = grids(6, 1);
        let kplus = GeneralizedInverse::plan(k.clone().into(), &constants(36), 1e-8)
            .unwrap()
            .execute()
            .unwrap()
            .inverse;
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
        let error =
            GeneralizedInverse::plan(k.into(), &constants(72), 1e-8).unwrap().execute().err().unwrap();
        assert_eq!(error.kind, Kind::NullSpace);
        assert!(error.what.contains("a mode is missing"), "{error}");
    }

    /// Two dofs joined by a spring, at any position among dofs that are held.
    #[test]
    fn a_missing_mode_of_two_dofs_is_noticed_wherever_they_are() {
        let none =
            |n| NullSpaceInput { vectors: Matrix { rows: n, cols: 0, data: vec![] }, modes: Modes::Exact };
        for before in 0..100 {
            let n = before + 102;
            let mut k = Symmetric::new(vec![0], Vec::new(), Vec::new());
            for i in 0..n {
                let pair = i == before || i == before + 1;
                if i == before + 1 {
                    k.col.push(i as u32 - 1);
                    k.val.push(-0.7);
                }
                k.col.push(i as u32);
                k.val.push(if pair { 0.7 } else { 1.3 });
                k.ptr.push(k.col.len());
            }
            // 0.7 - 0.7 is 0, which the factorisation would refuse; the probe must find a rounded zero
            *k.val.iter_mut().filter(|v| **v == 0.7).last().unwrap() *= 1.0 + 4.0 * f64::EPSILON;
            let error = GeneralizedInverse::plan(k.into(), &none(n), 1e-8).unwrap().execute().err().unwrap();
            assert!(error.what.contains("a mode is missing"), "{before}: {error}");
            assert!(
                error.place.dof.is_some_and(|dof| dof == before || dof == before + 1),
                "{before}: {error}"
            );
        }
    }

    #[test]
    fn an_indefinite_stiffness_is_refused_with_dof_and_pivot() {
        let mut k = grids(6, 1);
        let last = k.ptr[15] - 1;
        k.val[last] = 0.5;
        let none =
            NullSpaceInput { vectors: Matrix { rows: 36, cols: 0, data: vec![] }, modes: Modes::Exact };
        let error = GeneralizedInverse::plan(k.into(), &none, 1e-8).unwrap().execute().err().unwrap();
        assert_eq!(error.kind, Kind::Indefinite);
        assert!(error.place.dof.is_some() && error.place.value.unwrap() < 0.0);
    }
}
