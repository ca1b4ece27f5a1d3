//! The null space `R_p` found from the stiffness matrix alone, and `K_p+` from the same factor.
//!
//! Some dofs t, spread over the body, are eliminated last, each with an added spring of its own diagonal
//! stiffness: `K + E D_tt E'` is regular as soon as t resists every motion of the null space. The last block of its factor is
//! `S + D_tt`, where S is the Schur complement of K on t. With the diagonal scaled to 1 the null vectors of S are those of K at t.
//! Then some dofs of t are held in place of all springs: only the dense block of t changes.

use std::sync::Arc;

use crate::body::digits::{Digits, FEWEST};
use crate::body::fixing::{fixing_dofs, given_dofs};
use crate::body::generalized_inverse::{Factorised, GeneralizedInverse};
use crate::body::last::{spread, supported};
use crate::body::layout::{Layout, Symbolic};
use crate::body::misfit::Misfit;
use crate::body::null_space::{exact, largest, refuse_overflow, Verified};
use crate::body::part::{End, Soft};
use crate::body::pilots::Pilots;
use crate::body::probe::{known_to, probe, sharpened, Factor};
use crate::body::soft::{are_resisted, known_to_entries, soft_motions};
use crate::body::spectrum::{cut, may_be_weak, measured, to_measure};
use crate::error::{Error, Kind, Result};
use crate::linalg::cholesky::Trailing;
use crate::linalg::dense::spectrum::symmetric_eigen;
use crate::linalg::vector::ratio;
use crate::linalg::{Analysis, Breakdown, Cholesky, Matrix, Multiple};
use crate::numbers::body::MOST_ROUNDING;
use crate::numbers::rounding;
use crate::platform::memory::{headroom, PRODUCTS};

/// Number of dofs eliminated last, in the first attempt.
const LAST: usize = 24;
/// Limit of this number.
const MOST: usize = 400;
/// Bytes of labels, lists and vectors, per dof.
const PER_DOF: usize = 256;

pub struct Search {
    k: Multiple,
    tolerance: f64,
    fixing: Option<Vec<usize>>,
    /// The dofs t, ascending.
    last: Vec<usize>,
    /// Number of dofs in t that are spread over the body.
    count: usize,
    /// Precision of the entries of K, if less than double precision.
    digits: Option<Digits>,
    /// Otherwise, digits so few that the entries may be round numbers.
    few: Option<Digits>,
    /// Unknowns that rows carry, and K; t includes them, and `k` does not couple them.
    pilots: Option<(Pilots, Multiple)>,
    /// Coordinates that did not fit K.
    misfit: Option<Misfit>,
    /// The input of the analysis besides the pattern of K.
    pub(super) layout: Arc<Layout>,
    pub(super) symbolic: Option<Arc<Symbolic>>,
}

/// An attempt ends with K+, or with a dof that t must include.
enum Attempt {
    Done(Box<GeneralizedInverse>),
    Missed(usize),
}

impl Search {
    /// K, also if rows carry unknowns.
    pub(super) fn matrix(&self) -> &Multiple {
        self.pilots.as_ref().map_or(&self.k, |(_, k)| k)
    }

    /// `fixing`: the dofs to hold in K+, if the host has given them.
    pub fn new(k: Multiple, tolerance: f64, fixing: Option<&[usize]>) -> Result<Self> {
        let _room = headroom(k.order() * PER_DOF, "the null space of a body")?;
        let last = fixing.unwrap_or_default().to_vec();
        Self::with(k, tolerance, fixing.map(<[usize]>::to_vec), last, LAST)
    }

    /// `last`: dofs that t must include.
    fn with(
        k: Multiple,
        tolerance: f64,
        fixing: Option<Vec<usize>>,
        mut last: Vec<usize>,
        count: usize,
    ) -> Result<Self> {
        last.extend(spread(k.order(), count));
        last.sort_unstable();
        last.dedup();
        let layout = Arc::new(Layout::Last(last.clone()));
        let digits = Digits::of_least(&k.matrix, Digits::TOLD)?;
        let few = digits.filter(|digits| digits.are_few());
        let digits = digits.filter(|digits| !digits.are_few());
        let (pilots, misfit, symbolic) = (None, None, None);
        Ok(Self { k, tolerance, fixing, last, count, digits, few, pilots, misfit, layout, symbolic })
    }

    /// Notes that coordinates were given that do not fit.
    pub(super) fn instead_of(self, misfit: Misfit) -> Self {
        Self { misfit: Some(misfit), ..self }
    }

    /// Holds these unknowns as well.
    pub(super) fn with_pilots(mut self, pilots: Pilots) -> Result<Self> {
        self.last.extend(&*pilots.carried);
        self.last.sort_unstable();
        self.last.dedup();
        let layout = Arc::new(Layout::Last(self.last.clone()));
        let rest = pilots.without(&self.k)?;
        let k = std::mem::replace(&mut self.k, rest);
        Ok(Self { layout, pilots: Some((pilots, k)), symbolic: None, ..self })
    }

    pub fn analyse(&self) -> Result<Arc<Analysis>> {
        let supported = supported(&self.k, &self.last)?;
        Ok(Arc::new(Analysis::ending(&self.k.matrix, &supported, &self.last)?))
    }

    /// Repeats with more dofs t until t resists every motion.
    pub fn execute(self) -> Result<Factorised> {
        let misfit = self.misfit;
        let mut made = self.attempted().map_err(|mut error| {
            misfit.iter().for_each(|misfit| error.what = format!("{misfit}; sought in K: {}", error.what));
            error
        })?;
        made.inverse.misfit = misfit.filter(|misfit| made.inverse.null_space.cols > misfit.fit);
        Ok(made)
    }

    fn attempted(mut self) -> Result<Factorised> {
        let (mut factorisations, mut further_analyses) = (0, 0);
        loop {
            let symbolic = match self.symbolic.take() {
                Some(symbolic) => symbolic,
                None => {
                    further_analyses += 1;
                    Arc::new(Symbolic { layout: Arc::clone(&self.layout), analysis: self.analyse()? })
                }
            };
            factorisations += 1;
            match self.attempt(&symbolic.analysis)? {
                Attempt::Done(inverse) => {
                    return Ok(Factorised { inverse: *inverse, symbolic, further_analyses, factorisations })
                }
                Attempt::Missed(dof) if 2 * self.count > MOST => {
                    let what = format!(
                        "the null space could not be found with {} dofs of a connected part: give it, or coordinates",
                        self.count
                    );
                    return Err(Error::new(Kind::NullSpace, what).dof(dof));
                }
                Attempt::Missed(dof) => {
                    self.last.push(dof);
                    let (digits, pilots) = (self.digits, self.pilots.take());
                    self = Self::with(self.k, self.tolerance, self.fixing, self.last, 2 * self.count)?;
                    (self.digits, self.pilots) = (self.digits.or(digits), pilots);
                }
            }
        }
    }

    fn attempt(&mut self, analysis: &Arc<Analysis>) -> Result<Attempt> {
        let supported = supported(&self.k, &self.last)?;
        let factor = match analysis.factorize(&supported, 1.0)? {
            Ok(factor) => factor,
            Err(breakdown) => return self.missed_or_indefinite(breakdown),
        };
        let relative = |(dof, pivot)| Breakdown { dof, relative_pivot: pivot / supported.diagonal(dof) };
        let below = |limit: f64| factor.pivots().map(relative).find(|pivot| pivot.relative_pivot < limit);
        if let Some(breakdown) = below(rounding::SOLVE) {
            return self.missed_or_indefinite(breakdown);
        }
        if let Some(Breakdown { dof, .. }) =
            below(self.digits.map_or(rounding::SOLVE, Digits::pivot)).filter(|_| 2 * self.count <= MOST)
        {
            return Ok(Attempt::Missed(dof));
        }
        drop(supported);
        let soft = self.soft_as_written(&factor)?;
        if 2 * soft.vectors.cols > self.last.len() && self.last.len() < self.k.order() {
            return Ok(Attempt::Missed(self.last[0]));
        }
        let vectors = self.extended(&factor, soft.vectors.clone())?;
        match self.inverse(factor, soft, vectors) {
            Err(Error { kind: Kind::NullSpace, place, .. })
                if place.dof.is_some_and(|dof| self.last.binary_search(&dof).is_err()) =>
            {
                Ok(Attempt::Missed(place.dof.unwrap_or(0)))
            }
            done => done.map(|inverse| Attempt::Done(Box::new(inverse))),
        }
    }

    fn end(&self, factor: &Cholesky) -> Result<End> {
        let (last, m) = (&self.last[..], self.last.len());
        let mut schur = factor.trailing(last)?;
        let d = |i: usize| self.k.metric(last[i], 1.0);
        (0..m).for_each(|i| schur.set(i, i, schur.get(i, i) - d(i)));
        let scaled = Matrix::from_fn(m, m, |i, j| schur.get(i, j) / (d(i) * d(j)).sqrt())?;
        refuse_overflow(&scaled.data, |at| last[at % m])?;
        let (values, vectors) = symmetric_eigen(&scaled)?;
        Ok(End { schur, values, vectors })
    }

    /// As `soft`. If K has negative stiffness along a motion, its entries are not exact: the motion is judged again with
    /// their digits.
    fn soft_as_written(&mut self, factor: &Cholesky) -> Result<Soft> {
        match self.soft(factor) {
            Err(Error { kind: Kind::Indefinite, .. }) if self.digits.is_none() => {
                self.digits = Digits::of_rounded(&self.k.matrix, FEWEST);
                self.soft(factor)
            }
            found => found,
        }
    }

    /// The null space at t: from the eigenvalues at t if these decide it, otherwise from the softest motions measured over
    /// the whole body.
    fn soft(&mut self, factor: &Cholesky) -> Result<Soft> {
        let end = self.end(factor)?;
        let first = end.vectors.columns(0..self.candidates(&end)?);
        let ritz = measured(&self.k, self.digits.or(self.few), self.extended(factor, first)?)?;
        if ritz.is_exact() {
            (self.digits, self.few) = (None, None);
        }
        end.decided(self.digits, self.few, &self.last, ritz)
    }

    /// Number of motions to be measured over the whole body.
    fn candidates(&self, end: &End) -> Result<usize> {
        let (values, cut) = (&end.values, cut(&end.values));
        if self.digits.is_some() || cut.is_none() {
            return Ok(to_measure(values, self.digits.or(self.few)));
        }
        self.definite(values[0] / values[values.len() - 1].abs().max(1.0), end)?;
        let weak = cut.is_some_and(|(dimension, _)| may_be_weak(values, dimension));
        Ok(if weak || self.few.is_some() { to_measure(values, self.few) } else { 0 })
    }

    /// The error if the stiffness of the softest motion is negative beyond rounding.
    fn definite(&self, relative_pivot: f64, end: &End) -> Result<()> {
        let dof = self.last[largest(end.vectors.col(0), |_| 1.0)];
        (Breakdown { dof, relative_pivot }).refused().map_or(Ok(()), Err)
    }

    /// Motions at t multiplied by D^1/2, extended to the other dofs without forces there.
    fn extended(&self, factor: &Cholesky, mut motions: Matrix) -> Result<Matrix> {
        for j in 0..motions.cols {
            let at_t = motions.col_mut(j).iter_mut().zip(&self.last);
            at_t.for_each(|(v, &dof)| *v /= self.k.metric(dof, 1.0).sqrt());
        }
        factor.extended(&self.last, &motions)
    }

    /// K+ from this factor: r of the dofs t held, the others without springs. `vectors`: the null vectors.
    fn inverse(&self, factor: Cholesky, soft: Soft, vectors: Matrix) -> Result<GeneralizedInverse> {
        let (n, r) = (self.k.order(), vectors.cols);
        let _room = headroom((10 * r + 24) * n * size_of::<f64>() + PRODUCTS, "a null space")?;
        let fixing = self.fixing_of(&soft, &vectors)?;
        let last = Trailing { dofs: &self.last, schur: &soft.schur, held: &fixing };
        let factor = factor.holding(&last)?.map_err(|dof| {
            let what = "the stiffness matrix is singular with the fixing dofs of its null space held";
            Error::new(Kind::NullSpace, what).dof(dof)
        })?;
        let factor = Factor::Own(Arc::new(factor));
        let vectors = self.resisted_evenly(&factor, vectors)?;
        let tolerance = if soft.weak > 0 { f64::INFINITY } else { self.tolerance.max(soft.rounding) };
        let Verified { basis, .. } = exact(&self.k, &vectors, tolerance)?;
        let (mut null_space, stiffness) = self.resisted_softly(&factor, &soft, basis)?;
        if stiffness.is_empty() {
            null_space = sharpened(&self.k, &null_space)?.unwrap_or(null_space);
        }
        let softness = probe(&factor, &self.k, &fixing, fixing.len())?;
        let error = match stiffness.is_empty() {
            true => known_to(&factor, &self.k, &null_space)?,
            false => known_to_entries(&factor, &self.k, &null_space)?,
        };
        let inverse = GeneralizedInverse {
            null_space,
            stiffness,
            rounding: error.min(MOST_ROUNDING),
            error,
            fixing,
            gap: Some(soft.gap),
            softness,
            misfit: None,
            doubt: soft.doubt,
            factor,
            carried: None,
            near: None,
        };
        let Some((pilots, k)) = &self.pilots else { return Ok(inverse) };
        let mut led = inverse.led_by(pilots, k, false)?;
        led.stiffness.iter_mut().for_each(|stiffness| *stiffness = stiffness.max(0.0));
        Ok(led)
    }

    /// Soft motions and their stiffness, if weak springs hold some of the vectors or no gap separates these from a null
    /// space.
    fn resisted_softly(&self, factor: &Factor, soft: &Soft, basis: Matrix) -> Result<(Matrix, Vec<f64>)> {
        if soft.weak == 0 && (self.digits.is_some() || !are_resisted(&self.k, &basis)?) {
            return Ok((basis, Vec::new()));
        }
        let none = Matrix::zeros(basis.rows, 0)?;
        let (motions, mut stiffness) = soft_motions(factor, (&self.k, None), none, basis)?;
        // negative stiffness this small is rounding, since the host has given no soft motions
        stiffness.iter_mut().for_each(|stiffness| *stiffness = stiffness.max(0.0));
        Ok((motions, stiffness))
    }

    /// If rounding of the entries resists the null vectors r, the elimination concentrates this resistance at the dofs t.
    /// Spread over all dofs like inertia forces it deforms least: `r - K+ (K r - theta D r)`, `theta = r'K r / r'D r`.
    fn resisted_evenly(&self, factor: &Factor, mut vectors: Matrix) -> Result<Matrix> {
        if self.digits.is_none() {
            return Ok(vectors);
        }
        let (mut image, _) = self.k.mul_columns(&vectors)?;
        for c in 0..vectors.cols {
            let (r, image) = (vectors.col_mut(c), image.col_mut(c));
            let work = |of: &dyn Fn(usize) -> f64| (0..r.len()).map(|i| r[i] * of(i)).sum::<f64>();
            let theta = ratio(work(&|i| image[i]), work(&|i| self.k.metric(i, 1.0) * r[i]));
            (0..r.len()).for_each(|i| image[i] -= theta * self.k.metric(i, 1.0) * r[i]);
            factor.solve(image)?;
            r.iter_mut().zip(image.iter()).for_each(|(r, x)| *r -= x);
        }
        Ok(vectors)
    }

    /// The dofs to hold.
    fn fixing_of(&self, soft: &Soft, vectors: &Matrix) -> Result<Vec<usize>> {
        let carried = self.pilots.as_ref().map_or(&[][..], |(pilots, _)| &pilots.carried);
        let is_carried = |dof: &usize| carried.binary_search(dof).is_ok();
        let mut held = match self.fixing.as_ref().filter(|given| !given.iter().any(is_carried)) {
            Some(given) => given_dofs(vectors, &self.k.roots()?, given)?,
            None => {
                let chosen = fixing_dofs(&soft.vectors, &vec![1.0; self.last.len()])?;
                chosen.into_iter().map(|at| self.last[at]).collect()
            }
        };
        held.extend(carried);
        Ok(held)
    }

    /// A pivot of `K + E D_tt E'` that is not positive: K is indefinite, or t does not resist some null vector. The
    /// latter is excluded if t has all dofs.
    fn missed_or_indefinite(&mut self, Breakdown { dof, relative_pivot }: Breakdown) -> Result<Attempt> {
        let whole = self.last.len() == self.k.order();
        let relative_pivot = if whole { 2.0 * relative_pivot - 1.0 } else { relative_pivot };
        let Some(error) = (Breakdown { dof, relative_pivot }).refused() else {
            return Ok(Attempt::Missed(dof));
        };
        self.digits = self.digits.or_else(|| Digits::of_rounded(&self.k.matrix, FEWEST));
        if relative_pivot < -self.digits.map_or(rounding::SOLVE, Digits::pivot) {
            return Err(error);
        }
        Ok(Attempt::Missed(dof))
    }
}
