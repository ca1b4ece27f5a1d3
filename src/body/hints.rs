//! Null spaces and soft motions from coordinates.
//!
//! Coordinates are hints: if all their rigid motions fit K, the null space is known before the factorisation. If K
//! resists some of them and is nevertheless singular (coordinates of another state, a body of revolution), the null space is searched in K.

use crate::body::digits::Digits;
use crate::body::fixing::{fixing_dofs, given_dofs};
use crate::body::generalized_inverse::{GeneralizedInverse, Misfit};
use crate::body::known::{Known, Retry};
use crate::body::null_space::{
    kernel_by_parts, one_column_each, verified_by_parts, FreePart, KernelByParts, Verified, CANDIDATE,
    ROUNDING,
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
    /// Null space and fixing dofs of `k` from the rigid motions of coordinates, as far as these fit K.
    pub fn plan_near(
        k: Multiple,
        rigid: &RigidModes,
        tolerance: f64,
        fixing: Option<&[usize]>,
    ) -> Result<Plan> {
        let n = k.order();
        let _room = headroom(64 * n * size_of::<f64>() + PRODUCTS, "the null space of a body")?;
        let KernelByParts { kernel, counts, candidates, next } =
            kernel_by_parts(&k, &rigid.modes, &rigid.parts(), CANDIDATE)?;
        let fit = counts.iter().sum();
        if fit == candidates {
            return Self::known(k, &kernel, (rigid, &counts), (tolerance, None), fixing);
        }
        let misfit = Misfit { fit, of: candidates, next };
        if let Some(digits) = Digits::of(&k.matrix)? {
            if let Some(doubt) = explained(&k, digits, rigid)? {
                let told = Some(doubt).filter(|doubt| doubt.resisted > CANDIDATE);
                let tolerance = tolerance.max(MIXED * doubt.resisted);
                let counts = &rigid.counts;
                return Self::known(k, &rigid.modes, (rigid, counts), (tolerance, told), fixing);
            }
            return Ok(Plan::Search(Search::new(k, tolerance, fixing)?.instead_of(misfit)));
        }
        let given = fixing.map(<[usize]>::to_vec);
        let planned = Self::known(k.clone(), &kernel, (rigid, &counts), (tolerance, None), fixing);
        match planned {
            Ok(Plan::Known(known)) => Ok(Plan::Known(Known {
                retry: Some(Retry { misfit: Some(misfit), tolerance, fixing: given }),
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
        let KernelByParts { kernel, counts, .. } =
            kernel_by_parts(&k, &rigid.modes, &rigid.parts(), f64::INFINITY)?;
        match Self::known(k, &kernel, (rigid, &counts), (f64::INFINITY, None), fixing)? {
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
        let Verified { basis, error } = verified_by_parts(&k, vectors, &parts)?;
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
