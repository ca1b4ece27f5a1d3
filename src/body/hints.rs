//! Null spaces and soft motions from coordinates.
//!
//! Coordinates are hints: if all their rigid motions fit K, the null space is known before the factorisation. If K
//! resists some of them and is nevertheless singular (coordinates of another state, a body of revolution), or if it has further
//! null vectors (a hinge), the null space is searched in K.

use crate::body::candidates::Kernel;
use crate::body::digits::Digits;
use crate::body::fixing::{fixing_dofs, given_dofs};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::known::{Known, Retry};
use crate::body::misfit::Misfit;
use crate::body::null_space::{exact, Modes, NullSpaceInput, Verified};
use crate::body::plan::Plan;
use crate::body::search::Search;
use crate::body::spectrum::Doubt;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::NOISE;
use crate::linalg::{Matrix, Multiple};
use crate::numbers::body::{MAY_BE_FREE, MIXED, RESISTED};
use crate::platform::memory::{headroom, PRODUCTS};

impl GeneralizedInverse {
    /// Null space and fixing dofs of `k` from the rigid motions of coordinates, as far as these fit K. If the motions are
    /// exact, those that K resists by more than rounding are refused.
    pub fn plan_near(
        k: Multiple,
        rigid: &Matrix,
        modes: Modes,
        tolerance: f64,
        fixing: Option<&[usize]>,
    ) -> Result<Plan> {
        let n = k.order();
        let _room = headroom(64 * n * size_of::<f64>() + PRODUCTS, "the null space of a body")?;
        let Kernel { motions, candidates, next } = Kernel::of(&k, rigid, MAY_BE_FREE)?;
        let misfit = Misfit { fit: motions.cols, of: candidates, next };
        let digits = if misfit.fit < misfit.of { Digits::of_least(&k.matrix, Digits::TOLD)? } else { None };
        if let Some(digits) = digits {
            if let Some(doubt) = explained(&k, digits, rigid)? {
                let told = Some(doubt).filter(|doubt| doubt.resisted > MAY_BE_FREE);
                let tolerance = tolerance.max(MIXED * doubt.resisted);
                return Self::known(k, rigid, (tolerance, told), fixing);
            }
            if !digits.are_few() && modes != Modes::Exact {
                return Ok(Plan::Search(Search::new(k, tolerance, fixing)?.instead_of(misfit)));
            }
        }
        if modes == Modes::Exact && misfit.fit < misfit.of {
            let all = Kernel::of(&k, rigid, f64::INFINITY)?;
            return Self::known(k, &all.motions, (tolerance, None), fixing);
        }
        let given = fixing.map(<[usize]>::to_vec);
        let planned = Self::known(k.clone(), &motions, (tolerance, None), fixing);
        match planned {
            Ok(Plan::Known(known)) => Ok(Plan::Known(Known {
                misfit: Some(misfit),
                retry: Some(Retry::Search { tolerance, fixing: given, floats: None }),
                ..known
            })),
            Err(Error { kind: Kind::NullSpace, .. }) => {
                Ok(Plan::Search(Search::new(k, tolerance, fixing)?.instead_of(misfit)))
            }
            other => other,
        }
    }

    /// Takes the rigid motions of coordinates as soft motions. In the metric D, supports of 1e30 on the diagonal hide
    /// everything else of the motions that move them: motions that do not move supports are separated first.
    pub fn plan_soft(k: Multiple, rigid: &Matrix, fixing: Option<&[usize]>) -> Result<Plan> {
        let _room = headroom(64 * k.order() * size_of::<f64>() + PRODUCTS, "the soft motions of a body")?;
        let limit = if fixing.is_some() { f64::INFINITY } else { RESISTED };
        let found = Kernel::of(&k, rigid, limit)?;
        let planned = Self::known(k, &found.motions, (f64::INFINITY, None), fixing)?;
        if found.misfit().is_some() {
            let vectors = rigid.clone();
            return Ok(planned.or_all_soft(NullSpaceInput { vectors, modes: Modes::Soft }));
        }
        match planned {
            Plan::Known(known) => Ok(Plan::Known(Known { soft: true, ..known })),
            other => Ok(other),
        }
    }

    fn known(
        k: Multiple,
        vectors: &Matrix,
        (tolerance, doubt): (f64, Option<Doubt>),
        fixing: Option<&[usize]>,
    ) -> Result<Plan> {
        let root = k.roots()?;
        let Verified { basis, error, .. } = exact(&k, vectors, tolerance)?;
        let held = match fixing {
            Some(given) => given_dofs(&basis, &root, given)?,
            None => fixing_dofs(&basis, &root)?,
        };
        Ok(Plan::Known(Known { doubt, ..Known::of(k, basis, error, held, fixing.is_some()) }))
    }
}

/// Whether rounding of the entries explains the resistance of K to every rigid motion, at each dof.
fn explained(k: &Multiple, digits: Digits, rigid: &Matrix) -> Result<Option<Doubt>> {
    let (image, terms) = k.mul_columns(rigid)?;
    let (mut resisted, mut rounding): (f64, f64) = (0.0, 0.0);
    for j in 0..rigid.cols {
        let most = digits.most(&k.matrix, rigid.col(j))?;
        let (image, terms) = (image.col(j), terms.col(j));
        let left = |i: usize| image[i].abs() - NOISE * terms[i];
        if (0..k.order()).any(|i| left(i) > k.by * most[i]) {
            return Ok(None);
        }
        for i in (0..k.order()).filter(|&i| terms[i] > 0.0) {
            resisted = resisted.max(image[i].abs() / terms[i]);
            rounding = rounding.max(k.by * most[i] / terms[i]);
        }
    }
    Ok(Some(Doubt { digits, motions: rigid.cols, resisted, rounding, free: true }))
}
