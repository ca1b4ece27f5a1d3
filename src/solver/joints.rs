//! The forces that glue bodies of the host together. The host has no rows for them.

use crate::constraints::RowKind;
use crate::error::Result;
use crate::model::{HostModel, Joint};
use crate::platform::memory::{copied, zeros};

const WHAT: &str = "forces of glue";

/// The unknowns of joints, ascending.
pub fn ends(joints: &[Joint]) -> Vec<usize> {
    let mut ends: Vec<usize> = joints.iter().flat_map(|joint| joint.ends).collect();
    ends.sort_unstable();
    ends.dedup();
    ends
}

/// Multipliers of the host's equality rows, then of the joints, with the joint forces that bring the answer closest to
/// equilibrium: the residual `f - K u - B'lambda` of an unknown is passed to the next unknown with its number and remains
/// at the last one. `left`: `f - K u` of these unknowns.
pub fn with_glue(
    host: &HostModel,
    left: impl FnOnce(&[usize]) -> Result<Vec<f64>>,
    forces: [&[f64]; 3],
) -> Result<Vec<f64>> {
    let (mut all, joints) = (copied(forces[RowKind::Equality as usize], WHAT)?, host.joints()?);
    if joints.is_empty() {
        return Ok(all);
    }
    let unknowns = ends(&joints);
    let mut left = left(&unknowns)?;
    let at = |j: usize| unknowns.binary_search(&j).ok();
    for kind in RowKind::ALL {
        let (rows, forces) = (host.rows(kind), forces[kind as usize]);
        for i in (0..rows.len()).filter(|&i| rows.is_finite(i) && forces[i] != 0.0) {
            rows.matrix.row(i).for_each(|(j, v)| at(j).into_iter().for_each(|at| left[at] -= forces[i] * v));
        }
    }
    for Joint { ends, .. } in joints {
        if let [Some(before), Some(after)] = ends.map(at) {
            all.push(left[before]);
            left[after] += left[before];
        }
    }
    Ok(all)
}

/// `f - K u`, force.
pub fn left_over(host: &HostModel, u: &[f64]) -> Result<Vec<f64>> {
    let mut left = zeros(u.len(), WHAT)?;
    for (body, given) in host.bodies.iter().enumerate() {
        let range = host.range(body);
        let own = &mut left[range.clone()];
        given.body.k().map_or(Ok(()), |k| k.mul(&u[range], own))?;
        own.iter_mut().for_each(|f| *f = -*f);
        own.iter_mut().zip(given.body.load.iter().flatten()).for_each(|(left, f)| *left += f);
    }
    Ok(left)
}

/// Adds the forces of the joints on all bodies; `mu`: one multiplier per joint.
pub fn add_glue(host: &HostModel, mu: &[f64], forces: &mut [f64]) -> Result<()> {
    for (Joint { ends: [before, after], .. }, mu) in host.joints()?.into_iter().zip(mu) {
        forces[before] -= mu;
        forces[after] += mu;
    }
    Ok(())
}
