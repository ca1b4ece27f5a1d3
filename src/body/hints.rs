//! Null spaces and soft motions from coordinates.
//!
//! Coordinates are hints: if all their rigid motions fit K, the null space is known before the factorisation. If K
//! resists some of them and is nevertheless singular (coordinates of another state, a body of revolution), or if it has further
//! null vectors (a hinge), the null space is searched in K.

use crate::body::candidates::{kernel_by_parts, KernelByParts, CANDIDATE};
use crate::body::digits::Digits;
use crate::body::fixing::{fixing_dofs, given_dofs};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::known::{Known, Retry};
use crate::body::misfit::{Misfit, RESISTED};
use crate::body::null_space::{
    one_column_each, verified_by_parts, FreePart, Modes, NullSpaceInput, Verified, ROUNDING,
};
use crate::body::plan::Plan;
use crate::body::rigid_modes::RigidModes;
use crate::body::search::Search;
use crate::body::spectrum::Doubt;
use crate::error::{Error, Kind, Result};
use crate::linalg::{Matrix, Multiple};
use crate::platform::memory::{headroom, PRODUCTS};

/// Factor on the tolerance of rigid motions: the terms of their combinations may cancel.
const MIXED: f64 = 16.0;

impl GeneralizedInverse {
    /// Null space and fixing dofs of `k` from the rigid motions of coordinates, as far as these fit K. If the motions are
    /// exact, those that K resists by more than rounding are refused.
    pub fn plan_near(
        k: Multiple,
        rigid: &RigidModes,
        modes: Modes,
        tolerance: f64,
        fixing: Option<&[usize]>,
    ) -> Result<Plan> {
        let n = k.order();
        let _room = headroom(64 * n * size_of::<f64>() + PRODUCTS, "the null space of a body")?;
        let KernelByParts { kernel, counts, candidates, next } =
            kernel_by_parts(&k, &rigid.modes, &rigid.parts(), CANDIDATE)?;
        let misfit = Misfit { fit: counts.iter().sum(), of: candidates, next };
        let digits = if misfit.fit < misfit.of { Digits::of_least(&k.matrix, Digits::TOLD)? } else { None };
        if let Some(digits) = digits {
            if let Some(doubt) = explained(&k, digits, rigid)? {
                let told = Some(doubt).filter(|doubt| doubt.resisted > CANDIDATE);
                let tolerance = tolerance.max(MIXED * doubt.resisted);
                let counts = &rigid.counts;
                return Self::known(k, &rigid.modes, (rigid, counts), (tolerance, told), fixing);
            }
            if !digits.are_few() && modes != Modes::Exact {
                return Ok(Plan::Search(Search::new(k, tolerance, fixing)?.instead_of(misfit)));
            }
        }
        if modes == Modes::Exact && misfit.fit < misfit.of {
            let all = kernel_by_parts(&k, &rigid.modes, &rigid.parts(), f64::INFINITY)?;
            return Self::known(k, &all.kernel, (rigid, &all.counts), (tolerance, None), fixing);
        }
        let given = fixing.map(<[usize]>::to_vec);
        let planned = Self::known(k.clone(), &kernel, (rigid, &counts), (tolerance, None), fixing);
        match planned {
            Ok(Plan::Known(known)) => Ok(Plan::Known(Known {
                misfit: Some(misfit),
                retry: Some(Retry::Search { tolerance, fixing: given }),
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
    pub fn plan_soft(k: Multiple, rigid: &RigidModes, fixing: Option<&[usize]>) -> Result<Plan> {
        let _room = headroom(64 * k.order() * size_of::<f64>() + PRODUCTS, "the soft motions of a body")?;
        let limit = if fixing.is_some() { f64::INFINITY } else { RESISTED };
        let found = kernel_by_parts(&k, &rigid.modes, &rigid.parts(), limit)?;
        let planned = Self::known(k, &found.kernel, (rigid, &found.counts), (f64::INFINITY, None), fixing)?;
        if found.misfit().is_some() {
            let vectors = one_column_each(&rigid.modes, &rigid.parts())?;
            return Ok(planned.or_all_soft(NullSpaceInput { vectors, modes: Modes::Soft }));
        }
        match planned {
            Plan::Known(known) => Ok(Plan::Known(Known { soft: true, ..known })),
            other => Ok(other),
        }
    }

    /// The plan for vectors j of all parts in column j, with the number of vectors of each part.
    fn known(
        k: Multiple,
        vectors: &Matrix,
        (rigid, counts): (&RigidModes, &[usize]),
        (tolerance, doubt): (f64, Option<Doubt>),
        fixing: Option<&[usize]>,
    ) -> Result<Plan> {
        let root = k.roots()?;
        let part = |(dofs, &count): (_, &usize)| FreePart { dofs: Vec::as_slice(dofs), count, tolerance };
        let parts: Vec<FreePart<'_>> = rigid.members.iter().zip(counts).map(part).collect();
        let Verified { basis, error, .. } = verified_by_parts(&k, vectors, &parts)?;
        let parts: Vec<_> = parts.iter().map(|part| (part.dofs, part.count)).collect();
        let null_space = one_column_each(&basis, &parts)?;
        let mut held = Vec::new();
        match fixing {
            Some(given) => held = given_dofs(&null_space, &root, given)?,
            None => {
                for (dofs, count) in parts {
                    let own = Matrix::from_fn(dofs.len(), count, |at, j| basis.get(dofs[at], j))?;
                    let roots: Vec<f64> = dofs.iter().map(|&i| root[i]).collect();
                    held.extend(fixing_dofs(&own, &roots)?.into_iter().map(|own| dofs[own]));
                }
            }
        }
        Ok(Plan::Known(Known { doubt, ..Known::of(k, null_space, error, held, fixing.is_some()) }))
    }
}

/// Whether rounding of the entries explains the resistance of K to every rigid motion, at each dof.
fn explained(k: &Multiple, digits: Digits, rigid: &RigidModes) -> Result<Option<Doubt>> {
    let (image, terms) = k.mul_columns(&rigid.modes)?;
    let (mut resisted, mut rounding): (f64, f64) = (0.0, 0.0);
    for j in 0..rigid.modes.cols {
        let most = digits.most(&k.matrix, rigid.modes.col(j))?;
        let (image, terms) = (image.col(j), terms.col(j));
        let left = |i: usize| image[i].abs() - ROUNDING * terms[i];
        if (0..k.order()).any(|i| left(i) > k.by * most[i]) {
            return Ok(None);
        }
        for i in (0..k.order()).filter(|&i| terms[i] > 0.0) {
            resisted = resisted.max(image[i].abs() / terms[i]);
            rounding = rounding.max(k.by * most[i] / terms[i]);
        }
    }
    Ok(Some(Doubt { digits, motions: rigid.counts.iter().sum(), resisted, rounding, free: true }))
}
