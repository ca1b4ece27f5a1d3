//! The forces within the cones that come closest to balancing a load if none balance it, `min |e - G l|`, and the
//! remainder `rest = e - G l`, which decides whether the equalities can be satisfied: `e'rest = |rest|^2`, and no force within the cones
//! works against `G'rest`. G and e are weighted, mode by mode.
//!
//! If all cones are half lines and G has few columns, rest is the point of the cone of these vectors that is nearest to e; this method is
//! finite, and loses no digits to `G G'`. Otherwise
//!
//! ```text
//! delta beta + G PI(G'beta) = e,   delta -> 0,   delta beta -> rest
//! ```
//!
//! `G'rest` is in the polar cone up to delta times the forces: no force within the cones resists this motion by more than
//! that. Coefficients are slightly increased, so that the actual friction does not resist the motion at all; the
//! remaining effect of delta is subtracted from the motion.

use crate::error::{Kind, Result};
use crate::linalg::vector::{axpy, norm};
use crate::linalg::Csr;
use crate::numbers::friction::{
    DELTA_SHRINKS, DELTA_SHRINKS_LEAST, FIRST_DELTA, FREE_MOTIONS, UNHELD_ACCEPTED, WIDER,
};
use crate::numbers::rounding;
use crate::qp::friction::cones::{Cones, Place};
use crate::qp::friction::motions::Motions;
use crate::qp::friction::nearest::{derivative, Projected, Target};
use crate::qp::{nearest_point, Polyhedron, Qp};

/// Limit of modes for which a square matrix over the modes, and one rotation of it per row and mode, are inexpensive.
const FEW: usize = 500;
/// Rounds in which nodes join those that resist the remainder; the second pass of a round removes the rounding of the first.
const ROUNDS: usize = 10;
const PASSES: usize = 2;

/// The forces for which `e - G l` is smallest in the norm of `weights`, one weight per mode; and `e - G l`.
pub fn unheld(qp: &Qp, cones: &Cones, weights: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut g_transposed = qp.g_transposed.clone();
    g_transposed.col.iter().zip(&mut g_transposed.val).for_each(|(&mode, v)| *v *= weights[mode]);
    let e: Vec<f64> = qp.e.iter().zip(weights).map(|(e, w)| w * e).collect();
    let finite = if cones.are_half_lines() { in_cone(&g_transposed, qp.bounded, &e)? } else { None };
    let scaled = Qp { g_transposed: &g_transposed, e: &e, ..*qp };
    let (forces, rest) = match finite {
        Some(found) => found,
        None => {
            let (forces, rest) = by_newton(&scaled, &cones.wider(1.0 + WIDER))?;
            (cones.nearest(&forces).0, rest)
        }
    };
    Ok((forces, rest.iter().zip(weights).map(|(rest, w)| rest / w).collect()))
}

/// The forces l for which a is in its cone, and a, orthogonal to rows with a force up to rounding of a; none if rounding
/// prevents the method from ending.
fn in_cone(g_transposed: &Csr, bounded: &[bool], e: &[f64]) -> Result<Option<(Vec<f64>, Vec<f64>)>> {
    if e.len() > FEW {
        return Ok(None);
    }
    let m = bounded.len();
    let mut rows = g_transposed.clone();
    let free: Vec<usize> = (0..m).filter(|&i| !bounded[i]).collect();
    free.iter().for_each(|&i| rows.push_row(g_transposed.row(i).map(|(mode, v)| (mode, -v))));
    let gap = vec![0.0; rows.rows()];
    let found = nearest_point(Polyhedron { rows: &rows, gap: &gap, target: e, noise: &gap, rounding: 0.0 });
    let (mut forces, a) = match found {
        Ok(found) => (found.forces, found.point),
        Err(error) if error.kind == Kind::Internal => return Ok(None),
        Err(error) => return Err(error),
    };
    let opposite = forces.split_off(m);
    free.iter().zip(opposite).for_each(|(&i, force)| forces[i] -= force);
    Ok(Some((forces, a)))
}

fn by_newton(qp: &Qp, cones: &Cones) -> Result<(Vec<f64>, Vec<f64>)> {
    let (mut motions, y) = (Motions::of(qp, cones)?, &vec![0.0; qp.b.len()]);
    let is_solved = |now: &Projected| norm(&now.left) <= UNHELD_ACCEPTED * norm(qp.e);
    let (mut shift, mut less, mut last, mut rest) = (FIRST_DELTA, DELTA_SHRINKS, None, qp.e.to_vec());
    let mut before = rest.clone();
    while shift >= rounding::SOLVE && less < DELTA_SHRINKS_LEAST {
        let delta = shift * motions.size();
        // while the states of the nodes do not change, the remainder is a linear function of delta
        let from = |by: f64| {
            let beta = rest.iter().zip(&before).map(|(rest, before)| (rest + by * (rest - before)) / delta);
            Target { qp, cones, motions: &motions, y, delta }.projected(beta.collect())
        };
        let mut now = from(less)?;
        if !is_solved(&now) {
            now = from(0.0)?;
        }
        if !is_solved(&now) {
            (shift, less) = (shift / less.sqrt(), less.sqrt());
            continue;
        }
        let next: Vec<f64> = now.beta.iter().map(|beta| delta * beta).collect();
        before = if shift < FIRST_DELTA { rest } else { next.clone() };
        (last, rest) = (Some((now, delta)), next);
        shift *= less;
    }
    let Some((Projected { point, places, .. }, delta)) = last else { return Ok((y.clone(), rest)) };
    settle(qp, cones, (&mut motions, delta), places, &mut rest)?;
    Ok((point, rest))
}

/// Removes from the remainder what nodes with a force in these places resist: delta times their forces. Nodes that then resist it join
/// them.
fn settle(
    qp: &Qp,
    cones: &Cones,
    (motions, delta): (&mut Motions, f64),
    mut places: Vec<Place>,
    rest: &mut [f64],
) -> Result<()> {
    // slips are known to a part of this size
    let cut = if cones.are_half_lines() { 0.0 } else { FREE_MOTIONS };
    for _ in 0..ROUNDS {
        // a node that slips resists no turn of its force; one that does not slip resists it, although its force is at the bound
        for place in &mut places {
            if let Place::Surface { ratio, .. } | Place::Rim { ratio, .. } = place {
                *ratio = if *ratio < FREE_MOTIONS { 0.0 } else { *ratio };
            }
        }
        let (coordinates, weights) = derivative(cones, &places);
        let resisted = motions.inverse(&coordinates, weights, (true, cut))?;
        for _ in 0..PASSES {
            axpy(-1.0, &resisted.solve(&resisted.resistance(rest))?, rest);
        }
        let v: Vec<f64> = (0..qp.b.len()).map(|i| qp.g_transposed.row_dot(i, rest) / delta).collect();
        let mut joined = false;
        for (place, now) in places.iter_mut().zip(cones.nearest(&v).1) {
            let joins = matches!(place, Place::Open | Place::Rim { .. })
                && matches!(now, Place::Inside | Place::Surface { .. });
            *place = if joins { now } else { *place };
            joined |= joins;
        }
        if !joined {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Packed;

    /// By the cone, and by Newton's method, with equal results.
    fn solve(columns: &[[f64; 2]], e: [f64; 2]) -> (Vec<f64>, Vec<f64>) {
        let mut g_transposed = Csr::empty(2);
        columns.iter().for_each(|c| g_transposed.push_row([(0, c[0]), (1, c[1])]));
        let (a, m) = (Packed::zeros(columns.len()).unwrap(), columns.len());
        let (b, bounded) = (vec![0.0; m], vec![true; m]);
        let qp = Qp::plain(&a, &b, &g_transposed, &e, &bounded);
        let cones = Cones::half_lines(qp.bounded).unwrap();
        let found = unheld(&qp, &cones, &[1.0; 2]).unwrap();
        let (_, other) = by_newton(&qp, &cones).unwrap();
        assert!(found.1.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-13), "{other:?}");
        found
    }

    #[test]
    fn a_load_inside_the_cone_of_the_contact_forces_leaves_nothing() {
        let (forces, rest) = solve(&[[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], [2.0, 1.0]);
        assert!(norm(&rest) < 1e-14);
        assert!(forces.iter().all(|l| *l >= 0.0));
    }

    #[test]
    fn a_load_outside_the_cone_leaves_the_direction_in_which_it_pulls_away() {
        let (_, rest) = solve(&[[1.0, 0.0], [1.0, 1.0]], [1.0, -2.0]);
        assert_eq!(rest, [0.0, -2.0]);
    }
}
