//! A body whose null space is known before the factorisation: F of (14) is K without the rows and columns of its fixing dofs.

use std::sync::Arc;

use crate::body::fixing::{fixing_dofs, hold_as_well};
use crate::body::generalized_inverse::{Factorised, GeneralizedInverse};
use crate::body::layout::Symbolic;
use crate::body::misfit::Misfit;
use crate::body::null_space::NullSpaceInput;
use crate::body::pilots::Pilots;
use crate::body::probe::{probe, Factor};
use crate::body::rounded::Rounded;
use crate::body::spectrum::Doubt;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::NOISE;
use crate::linalg::{Analysis, Cholesky, Matrix, Multiple};
use crate::numbers::body::{CONTRAST, SOLID, WORTH_SINGLE};
use crate::numbers::linalg::DEPENDENT;

/// The plan if the null space is known before the factorisation.
pub struct Known {
    pub(super) k: Multiple,
    pub(super) null_space: Matrix,
    pub(super) error: f64,
    pub(super) fixing: Vec<usize>,
    /// The host gave the fixing dofs.
    pub(super) given: bool,
    /// K may have positive or negative stiffness along the vectors, which need not be exact.
    pub(super) soft: bool,
    /// Unknowns that rows carry, held after those of the null space.
    pub(super) pilots: Option<Pilots>,
    /// Rigid motions for the coarse problem, whether K resists them or not.
    pub(super) rigid: Option<Matrix>,
    pub(super) symbolic: Option<Arc<Symbolic>>,
    /// The resistance to the null space that may be rounding of the entries.
    pub(super) doubt: Option<Doubt>,
    /// A factor in single precision is tried first.
    pub(super) single: bool,
    /// Coordinates or candidates: how many of them fit.
    pub(super) misfit: Option<Misfit>,
    /// What follows if a null vector may be missing.
    pub(super) retry: Option<Retry>,
}

/// The way to K+ if K has more null vectors than are known.
pub(super) enum Retry {
    /// The null space is searched in K. `floats`: as many motions as the host has told, beside soft ones.
    Search { tolerance: f64, fixing: Option<Vec<usize>>, floats: Option<usize> },
    /// All motions that were declared soft, also those that K resists like any other, get a column.
    AllSoft(NullSpaceInput),
}

impl Known {
    /// `given`: the host gave the fixing dofs.
    pub(super) fn of(k: Multiple, null_space: Matrix, error: f64, fixing: Vec<usize>, given: bool) -> Self {
        let (soft, single, pilots, rigid, symbolic) = (false, false, None, None, None);
        let (doubt, misfit, retry) = (None, None, None);
        Self {
            k,
            null_space,
            error,
            fixing,
            given,
            soft,
            single,
            pilots,
            rigid,
            symbolic,
            doubt,
            misfit,
            retry,
        }
    }

    /// The null vectors lose their values at these unknowns, and those that move nothing else are left out.
    pub(super) fn with_pilots(mut self, pilots: Pilots) -> Result<Self> {
        let mut root = self.k.roots()?;
        pilots.carried.iter().for_each(|&x| root[x] = 0.0);
        let Matrix { rows, cols, .. } = self.null_space;
        let others = Matrix::from_fn(rows, cols, |i, j| root[i] * self.null_space.get(i, j))?;
        // of vectors of length 1: what is less is their rounding
        let others = others.spanned(DEPENDENT).0;
        if others.cols < cols || pilots.carried.iter().any(|x| self.fixing.contains(x)) {
            (self.fixing, self.given) = (fixing_dofs(&others, &vec![1.0; rows])?, false);
        }
        let value = |i: usize, j: usize| if root[i] > 0.0 { others.get(i, j) / root[i] } else { 0.0 };
        self.null_space = Matrix::from_fn(rows, others.cols, value)?;
        self.fixing.extend(&*pilots.carried);
        Ok(Self { pilots: Some(pilots), ..self })
    }

    /// Takes over dofs chosen for other values, unless they hold this body much worse than its own dofs. Returns whether
    /// it did.
    pub(super) fn follow(&mut self, dofs: &[usize]) -> Result<bool> {
        let carried = self.pilots.as_ref().map_or(&[][..], |pilots| &pilots.carried);
        let Some(dofs) = dofs.strip_suffix(carried) else { return Ok(false) };
        let own = &self.fixing[..self.fixing.len() - carried.len()];
        let sorted = |dofs: &[usize]| {
            let mut dofs = dofs.to_vec();
            dofs.sort_unstable();
            dofs
        };
        let same = sorted(dofs) == sorted(own);
        if !same && (self.given || !hold_as_well(&self.null_space, &self.k.roots()?, dofs, own)?) {
            return Ok(false);
        }
        self.fixing = [dofs, carried].concat();
        Ok(true)
    }

    /// (14): F is K without the rows and columns of the fixing dofs.
    pub(super) fn analyse(&self) -> Result<Arc<Analysis>> {
        let mut held = vec![false; self.k.order()];
        self.fixing.iter().for_each(|&dof| held[dof] = true);
        Ok(Arc::new(Analysis::new(&self.k.matrix, &held)?))
    }

    /// Factorises F of (14) and probes; refuses a K that is indefinite, against (4), or has further null vectors. For
    /// soft motions it holds other dofs, or more, but not more than `most`, if K requires them.
    pub fn execute(mut self, most: usize) -> Result<Factorised> {
        let mut tried = 0;
        if let Some(symbolic) = self.symbolic.clone().filter(|symbolic| self.suits_single(&symbolic.analysis))
        {
            if let Some(inverse) = self.in_single(&symbolic.analysis)? {
                return Ok(Factorised { inverse, symbolic, further_analyses: 0, factorisations: 1 });
            }
            tried = 1;
        }
        let (mut symbolic, mut inverse, mut further) = self.held_by(most)?;
        if let Some(better) = self.better(&inverse)? {
            self.hold(inverse.null_space, better)?;
            let more;
            (symbolic, inverse, more) = self.held_by(most)?;
            further += 1 + more;
        }
        Ok(Factorised { inverse, symbolic, further_analyses: further, factorisations: 1 + further + tried })
    }

    /// Whether a factor in single precision saves time, and seems to suffice: the body is solid and of similar stiffness everywhere.
    fn suits_single(&self, analysis: &Analysis) -> bool {
        let (n, k) = (self.k.order(), &self.k);
        let is_plain = self.single && !self.soft && self.pilots.is_none() && self.rigid.is_none();
        if !is_plain
            || analysis.work() < WORTH_SINGLE
            || (analysis.highest_front() as f64) < SOLID * (n as f64).powf(2.0 / 3.0)
        {
            return false;
        }
        let sizes = (0..n).map(|i| k.metric(i, 1.0));
        let (least, most) =
            sizes.fold((f64::INFINITY, 0.0_f64), |(least, most), d| (least.min(d), most.max(d)));
        most <= CONTRAST * least
    }

    /// K+ by a factor computed in single precision; none if K does not allow it.
    fn in_single(&self, analysis: &Arc<Analysis>) -> Result<Option<GeneralizedInverse>> {
        let Ok(factor) = analysis.pivoted(&self.k.matrix, self.k.by, 0.0)? else { return Ok(None) };
        let made = Rounded::computed(factor, &self.k, &self.fixing)?;
        made.map(|(rounded, softness)| self.with(Factor::Rounded(Arc::new(rounded)), softness)).transpose()
    }

    /// K+, its analysis, and how many times further dofs had to be held. A pivot that is only rounding, as beside a
    /// diagonal entry that is, shows in the probe alone.
    fn held_by(&mut self, most: usize) -> Result<(Arc<Symbolic>, GeneralizedInverse, usize)> {
        let mut further = 0;
        loop {
            let (symbolic, factor, more) = self.factorised(most)?;
            further += more;
            let made = self.made(factor);
            let is_singular = |error: &&Error| error.kind == Kind::NullSpace && self.null_space.cols < most;
            match made.as_ref().err().filter(is_singular).and_then(|error| error.place.dof) {
                Some(dof) => self.hold_also(dof)?,
                None => return Ok((symbolic, made?, further)),
            }
            further += 1;
        }
    }

    /// The motions of which K holds some.
    pub(super) fn held(&self) -> Option<Misfit> {
        self.misfit.filter(|misfit| misfit.fit < misfit.of)
    }

    fn made(&self, factor: Cholesky) -> Result<GeneralizedInverse> {
        let factor = Factor::Own(Arc::new(factor));
        let softness = probe(&factor, &self.k, &self.fixing, self.null_space.cols)?;
        self.with(factor, softness)
    }

    fn with(&self, factor: Factor, softness: f64) -> Result<GeneralizedInverse> {
        let inverse = GeneralizedInverse {
            null_space: self.null_space.clone(),
            stiffness: Vec::new(),
            rounding: NOISE,
            error: self.error,
            fixing: self.fixing.clone(),
            gap: None,
            softness,
            doubt: self.doubt,
            misfit: self.held(),
            factor,
            carried: None,
            near: None,
        };
        inverse.judged_by(&self.k, self.soft, self.pilots.as_ref(), self.rigid.as_ref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Symmetric;

    #[test]
    fn a_null_vector_that_moves_only_pilots_is_left_out_whatever_its_rounding_elsewhere() {
        let free = Symmetric::new(vec![0, 1, 2, 4], vec![0, 1, 1, 2], vec![1e6, 1.0, -1.0, 1.0]);
        for (vector, held, fixing) in [
            ([0.0, 1.0, 1.0], 0, vec![1, 2]),
            ([1e-17, 1.0, 1.0], 0, vec![1, 2]),
            ([1.0; 3], 1, vec![0, 1, 2]),
        ] {
            let vectors = Matrix { rows: 3, cols: 1, data: vector.to_vec() };
            let pilots = Pilots { metric: vec![1e6; 3].into(), carried: vec![1, 2].into() };
            let known = Known::of(free.clone().into(), vectors, NOISE, vec![1], false);
            let known = known.with_pilots(pilots).unwrap();
            assert_eq!((known.null_space.cols, known.fixing), (held, fixing), "{vector:?}");
        }
    }
}
