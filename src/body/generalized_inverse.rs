//! (14), corrected: `P'K P = [F S; S' S'F^-1 S]`, the r dofs held last, r the dimension of the null space of K.
//! (15): `K+ = P [F^-1 0; 0 0] P'`.
//! Symmetric and reflexive (`K K+ K = K`, `K+ K K+ = K+`), not the Moore-Penrose inverse.

use std::fmt;
use std::sync::Arc;

use crate::body::carried::{self, Carried, Motions};
use crate::body::null_space::{one_column_each, ROUNDING as KNOWN};
use crate::body::probe::{known_to, Factor};
use crate::body::rounded::Rounded;
use crate::body::soft::{known_to_entries, soft_motions, Apart};
use crate::body::spectrum::Doubt;
use crate::error::Result;
use crate::linalg::cholesky::{inverse_columns, inverse_form};
use crate::linalg::{Analysis, Csr, Matrix, Multiple, Packed};
use crate::platform::slabs::Slabs;

#[derive(Clone)]
pub struct GeneralizedInverse {
    /// `R_p`, n x r, with `R'DR = I`.
    pub null_space: Matrix,
    /// `lambda_j = r_j'K r_j` of motions that K resists softly or that are carried, 0 of the others; none where it resists none. K+ is
    /// that of a K without it: see `soft` and `carried`.
    pub stiffness: Vec<f64>,
    /// Rounding of its vectors, against the fastest dof of each, no unit: what a row or a load has less of is nothing.
    pub rounding: f64,
    /// How far they are known, at least `rounding`: a motion that rows resist by less than this may be none.
    pub error: f64,
    /// The r dofs held; none where K+ is the host's.
    pub fixing: Vec<usize>,
    /// Of a null space that was found: the softest other motion against the stiffest of it, no unit.
    pub gap: Option<f64>,
    /// `|f| / | |K||K+ f| |` of a random load, no unit: its inverse is what rounding of K+ grows by.
    pub softness: f64,
    /// Motions that rounding of the entries of K may be all that resists, of its parts one by one.
    pub doubts: Vec<Doubt>,
    /// Coordinates that did not fit: the null space was sought in K.
    pub misfit: Option<Misfit>,
    pub(super) factor: Factor,
    /// What is taken from K+ for the motions that are carried, the last ones.
    pub(super) carried: Option<Arc<Carried>>,
    /// The same for K~+ of a rounded factor.
    pub(super) near: Option<Arc<Carried>>,
}

/// `K_p+` of a body and what it took.
pub struct Factorised {
    pub inverse: GeneralizedInverse,
    /// The analysis its factor belongs to.
    pub symbolic: Arc<Symbolic>,
    /// Analyses beyond the first, where the search for the null space had to begin anew.
    pub further_analyses: usize,
    /// Numeric factorisations, also those that missed a motion of the null space.
    pub factorisations: usize,
}

/// Rigid motions that do not all fit K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    pub fit: usize,
    pub of: usize,
    /// The least `|D^-1 K v|` of a unit vector v among the others.
    pub next: f64,
}

impl fmt::Display for Misfit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fit, of, next } = self;
        write!(out, "{fit} of {of} rigid motions of these coordinates fit K, the next leaves |K R| = {next:.1e} |D||R|")
    }
}

/// The symbolic side of a factorisation, done once for all bodies and all values of one pattern: what the analysis of a body
/// depends on besides the pattern of K.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Layout {
    /// Dofs that are held.
    Held(Vec<usize>),
    /// Dofs of every connected part that are eliminated last, and the entries of K between parts, which are 0 and left
    /// out.
    Last { dofs: Vec<Vec<usize>>, between: Vec<usize> },
}

/// A symbolic analysis with what it was made for.
pub struct Symbolic {
    pub layout: Arc<Layout>,
    pub analysis: Arc<Analysis>,
}

impl GeneralizedInverse {
    /// (15): `x = K+ b`, both of length n; F^-1 on the free dofs, 0 on those held.
    pub fn apply(&self, b: &[f64], x: &mut [f64]) -> Result<()> {
        x.copy_from_slice(b);
        self.apply_in_place(x)
    }

    /// `x <- K+ x`
    pub fn apply_in_place(&self, x: &mut [f64]) -> Result<()> {
        match (&self.carried, &self.near, &self.factor) {
            (Some(carried), Some(near), Factor::Rounded(rounded)) => {
                // the motions that are carried, which K may hardly resist, are never made and taken back
                let motions = carried.motions_under(x)?;
                rounded.solve_without(&motions, x, |x| near.apply_in_place(x, |x| rounded.approximate(x)))
            }
            (Some(carried), ..) => carried.apply_in_place(x, |x| self.factor.solve(x)),
            (None, ..) => self.factor.solve(x),
        }
    }

    /// `x <- K~+ x` by a rounded factor without corrections, else `K+ x`.
    pub fn approximate_in_place(&self, x: &mut [f64]) -> Result<()> {
        match &self.near {
            Some(carried) => carried.apply_in_place(x, |x| self.factor.approximate(x)),
            None if self.carried.is_some() => self.apply_in_place(x),
            None => self.factor.approximate(x),
        }
    }

    /// The factor is in single precision, and solutions are refined.
    pub fn is_rounded(&self) -> bool {
        matches!(&self.factor, Factor::Rounded(_))
    }

    /// Bytes that rounding has spared.
    pub fn bytes_saved(&self) -> usize {
        match &self.factor {
            Factor::Rounded(rounded) => rounded.factor.value_bytes(),
            Factor::Own(_) | Factor::Host(_) => 0,
        }
    }

    /// With its factor rounded to single precision, in `slabs`, where K allows it.
    pub fn rounded(mut self, k: &Multiple, slabs: &Slabs) -> Result<Self> {
        let rounded = match &self.factor {
            Factor::Own(factor) => Rounded::of(factor, k, &self.fixing, self.softness, slabs)?,
            Factor::Rounded(_) | Factor::Host(_) => None,
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

    /// What K~+ has to do with the motions that are carried.
    pub(super) fn find_near(&mut self, k: &Multiple) -> Result<()> {
        let near = |carried: &Arc<Carried>| carried.near(k, |x| self.factor.approximate(x));
        self.near = match &self.carried {
            Some(carried) if self.is_rounded() => near(carried)?.map(Arc::new),
            _ => None,
        };
        Ok(())
    }

    /// K resists or drives some motion of the null space.
    pub fn is_soft(&self) -> bool {
        self.stiffness.iter().take(self.own_motions()).any(|stiffness| *stiffness != 0.0)
    }

    /// Motions that are carried, the last ones.
    pub fn carried_motions(&self) -> usize {
        self.carried.as_ref().map_or(0, |carried| carried.count())
    }

    /// Motions that are not.
    pub(super) fn own_motions(&self) -> usize {
        self.null_space.cols - self.carried_motions()
    }

    /// The null space without the motions that are carried.
    pub fn free_motions(&self) -> Matrix {
        self.null_space.columns(0..self.own_motions())
    }

    /// Entries of the factor; 0 where the host has it.
    pub fn entries(&self) -> usize {
        match &self.factor {
            Factor::Own(factor) => factor.analysis.entries(),
            Factor::Rounded(rounded) => rounded.factor.analysis.entries(),
            Factor::Host(_) => 0,
        }
    }

    /// It must be applied on the thread alone that calls the library.
    pub fn on_caller(&self) -> bool {
        matches!(&self.factor, Factor::Host(host) if host.operator.on_caller())
    }

    /// Where its factor lies: the same for all that share it.
    pub fn factor_address(&self) -> usize {
        match &self.factor {
            Factor::Own(factor) => Arc::as_ptr(factor) as usize,
            Factor::Rounded(rounded) => Arc::as_ptr(rounded) as usize,
            Factor::Host(host) => Arc::as_ptr(&host.operator) as usize,
        }
    }

    /// The columns `which` of `B K+ B'`, m x `which.len()`.
    pub fn inverse_columns(&self, rows: &Csr, which: &[usize]) -> Result<Matrix> {
        let mut columns = match &self.factor {
            Factor::Own(factor) => inverse_columns(factor, rows, which)?,
            Factor::Rounded(rounded) => rounded.inverse_columns(rows, which)?,
            Factor::Host(host) => host.inverse_columns(rows, which)?,
        };
        self.carried.iter().try_for_each(|carried| carried.take_from_columns(rows, which, &mut columns))?;
        Ok(columns)
    }

    /// `B K+ B'` for the rows B (m x n) of this body.
    pub fn inverse_form(&self, rows: &Csr) -> Result<Packed> {
        let mut form = match &self.factor {
            Factor::Own(factor) => inverse_form(factor, rows)?,
            Factor::Rounded(rounded) => rounded.inverse_form(rows)?,
            Factor::Host(host) => host.inverse_form(rows)?,
        };
        self.carried.iter().try_for_each(|carried| carried.take_from_form(rows, &mut form))?;
        Ok(form)
    }

    /// What K makes of the vectors: `soft` motions, or a null space; `rigid` motions are carried.
    pub(super) fn judged_by(self, k: &Multiple, soft: bool, rigid: Option<&Matrix>) -> Result<Self> {
        let judged = if soft { self.softened(k)? } else { self.measured(k)? };
        match rigid {
            Some(rigid) => judged.with_carried(k, rigid),
            None => Ok(judged),
        }
    }

    /// The rigid motions that K resists are carried: [`carried`](crate::body::carried).
    pub(super) fn with_carried(mut self, k: &Multiple, rigid: &Matrix) -> Result<Self> {
        if self.null_space.cols == rigid.cols || self.is_soft() {
            return Ok(self);
        }
        if let Some(Motions { carried, vectors, stiffness }) =
            carried::motions(&self.factor, k, &self.null_space, rigid)?
        {
            self.stiffness = vec![0.0; self.null_space.cols];
            self.stiffness.extend(stiffness);
            (0..vectors.cols).for_each(|j| self.null_space.push_col(vectors.col(j)));
            self.carried = Some(Arc::new(carried));
        }
        Ok(self)
    }

    /// The motions of the vectors that it has, and what K resists of them.
    fn softened(mut self, k: &Multiple) -> Result<Self> {
        let Apart { vectors, parts } = Apart::of(k, &self.null_space)?;
        let parts: Vec<_> = parts.iter().map(|(dofs, count)| (&dofs[..], *count)).collect();
        let (motions, stiffness) = soft_motions(&self.factor, k, vectors, &parts)?;
        (self.null_space, self.stiffness) = (one_column_each(&motions, &parts)?, stiffness);
        self.error = known_to_entries(&self.factor, k, &self.null_space)?;
        Ok(self)
    }

    /// The error of a null space that K does not map to zero but for rounding, as far as the factor enlarges it.
    fn measured(mut self, k: &Multiple) -> Result<Self> {
        if self.error > KNOWN {
            let dofs: Vec<usize> = (0..k.order()).collect();
            self.error = known_to(&self.factor, k, &self.null_space, &[(&dofs, self.null_space.cols)])?;
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::null_space::{Modes, NullSpaceInput};
    use crate::error::Kind;
    use crate::linalg::Symmetric;

    /// Plane grid of springs, n x n dofs, free: null space = constants, on each of `parts` copies.
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

    /// Two dofs joined by a spring, wherever they stand among those that are held.
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
            // 0.7 - 0.7 is 0, which the factorisation would refuse; what rounding leaves must be found by the probe
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
