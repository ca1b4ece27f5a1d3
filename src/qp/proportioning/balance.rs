//! `min |e - G l|` over `l_i >= 0 (i bounded)`. Its residual `a` decides whether the equalities can be satisfied: `G_i'a
//! <= 0` on bounded rows, `= 0` on free ones, `e'a = |a|^2`. If G has few columns, a is the point of the cone of these
//! vectors that is nearest to e; this method is finite, and loses no digits to `G G'`. Otherwise a is computed on the
//! rows for which an interior point method finds a force.

use crate::error::{Kind, Result};
use crate::linalg::vector::{norm, norm_max, ratio};
use crate::linalg::Csr;
use crate::platform::interrupt;
use crate::qp::coarse::Coarse;
use crate::qp::interior::{self, Point};
use crate::qp::{nearest_point, Polyhedron, Qp, Rung};

/// A correlation with the residual is zero if it is below this part of its terms.
const ZERO: f64 = 1e-12;
/// Regularisation of the interior point method, which makes forces unique: first to find the rows with a force, then to
/// find a itself.
const UNIQUE: f64 = 1e-8;
const HARDLY_UNIQUE: f64 = 1e-12;
/// The residual presses a row if their product exceeds this part of their lengths.
const PRESSED: f64 = 1e-9;
/// Limit of modes for which a square matrix over the modes, and one rotation of it per row and mode, are inexpensive.
const FEW: usize = 1500;

pub struct Balance {
    pub point: Vec<f64>,
    /// `a = e - G l`: `G_i'a <= 0` on bounded rows, `= 0` on free ones, `e'a = |a|^2`; only approximately if the rows
    /// with a force were not found.
    pub residual: Vec<f64>,
    /// `|a| / |e|`
    pub margin: f64,
}

pub fn balance(qp: &Qp, coarse: &mut Coarse) -> Result<Balance> {
    let (point, residual) = match in_cone(qp.g_transposed, qp.bounded, qp.e)? {
        Some(found) => found,
        None => identified(qp, coarse)?,
    };
    Ok(Balance { margin: margin(qp, &residual), point, residual })
}

/// Forces l and their residual `a = e - G l` of least `|W a|`, W = diag(`weights`) > 0.
pub fn weighted(qp: &Qp, weights: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut g_transposed = qp.g_transposed.clone();
    for (mode, v) in g_transposed.col.iter().zip(&mut g_transposed.val) {
        *v *= weights[*mode];
    }
    let e: Vec<f64> = qp.e.iter().zip(weights).map(|(e, w)| e * w).collect();
    let (point, a) = match in_cone(&g_transposed, qp.bounded, &e)? {
        Some(found) => found,
        None => {
            let scaled = Qp { g_transposed: &g_transposed, e: &e, kept: None, ..*qp };
            identified(&scaled, &mut Coarse::of(&scaled)?)?
        }
    };
    Ok((point, a.iter().zip(weights).map(|(a, w)| a / w).collect()))
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

/// l and a for many modes: an interior point method shows the rows with a force; a is the least-squares residual of e on
/// these rows. Rows pressed by a join them, all at once.
fn identified(qp: &Qp, coarse: &mut Coarse) -> Result<(Vec<f64>, Vec<f64>)> {
    const ROUNDS: usize = 30;
    let Point { force, slack, .. } = inside(qp, coarse, UNIQUE)?;
    let (most, steepest) = (norm_max(&force), norm_max(&slack));
    let has_none = |i: usize| qp.bounded[i] && force[i] * steepest <= slack[i] * most;
    let mut held: Vec<bool> = (0..force.len()).map(has_none).collect();
    for round in 0..ROUNDS {
        interrupt::reached("rows admitted to the nearest forces", round)?;
        let mut point = least_squares(qp, coarse, &held, &force)?;
        let a = qp.left(&point);
        let pressed = pressed(qp, &held, &a);
        let is_balanced = norm(&a) <= ZERO * norm(qp.e);
        // least squares cannot increase the residual, unless the face is nearly singular
        if norm(&a) > norm(qp.e) {
            break;
        }
        if is_balanced || pressed.is_empty() {
            let pulls: Vec<usize> = (0..point.len()).filter(|&i| qp.bounded[i] && point[i] < 0.0).collect();
            // without a residual, negative forces prove nothing
            if is_balanced && !pulls.is_empty() {
                break;
            }
            pulls.into_iter().for_each(|i| point[i] = 0.0);
            return Ok((point, a));
        }
        pressed.into_iter().for_each(|i| held[i] = false);
    }
    let by = if Rung::HardlyUnique.is_tried() { HARDLY_UNIQUE } else { UNIQUE };
    let Point { force, motion, .. } = inside(qp, coarse, by)?;
    Ok((force, motion))
}

/// The interior point solution of `|e - G l|^2 + delta |l|^2`, delta in units of the largest diagonal entry of `G G'`:
/// its a satisfies `G_i'a <= delta l_i`.
fn inside(qp: &Qp, coarse: &mut Coarse, delta: f64) -> Result<Point> {
    let (y, none) = (vec![0.0; qp.b.len()], vec![false; qp.b.len()]);
    let delta = delta * coarse.largest();
    interior::inside(qp, coarse, (&y, &none), (delta, 1.0), vec![0.0; qp.e.len()])
}

/// The held rows that a presses: `G_i'a > 0` by more than rounding.
fn pressed(qp: &Qp, held: &[bool], a: &[f64]) -> Vec<usize> {
    let size = norm(a);
    let presses = |i: &usize| {
        let length = qp.g_transposed.row(*i).map(|(_, v)| v * v).sum::<f64>().sqrt();
        qp.g_transposed.row_dot(*i, a) > PRESSED * length * size
    };
    (0..held.len()).filter(|&i| held[i]).filter(presses).collect()
}

/// The forces nearest to `start` among those of least |e - G l| on the rows that are not held; zero on held rows.
fn least_squares(qp: &Qp, coarse: &mut Coarse, held: &[bool], start: &[f64]) -> Result<Vec<f64>> {
    /// The second pass removes the rounding of the first; for weakly resisted motions the third removes that of the
    /// second.
    const PASSES: usize = 3;
    let mut point: Vec<f64> =
        start.iter().zip(held).map(|(force, held)| if *held { 0.0 } else { *force }).collect();
    let mut face = coarse.on(held)?;
    for _ in 0..PASSES {
        let alpha = face.solve(&qp.left(&point))?;
        for i in (0..held.len()).filter(|&i| !held[i]) {
            point[i] += qp.g_transposed.row_dot(i, &alpha);
        }
    }
    Ok(point)
}

/// `|a| / |e|`: relative violation of the equalities.
fn margin(qp: &Qp, residual: &[f64]) -> f64 {
    ratio(norm(residual), norm(qp.e))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Csr, Packed};

    /// By the cone, and by the rows with a force, with equal results.
    fn solve(columns: &[[f64; 2]], e: [f64; 2]) -> Balance {
        let mut g_transposed = Csr::empty(2);
        columns.iter().for_each(|c| g_transposed.push_row([(0, c[0]), (1, c[1])]));
        let (a, m) = (Packed::zeros(columns.len()).unwrap(), columns.len());
        let qp = Qp {
            a: &a,
            b: &vec![0.0; m],
            g_transposed: &g_transposed,
            blocks: &[],
            rounding: 1e-14,
            e: &e,
            bounded: &vec![true; m],
            preconditioner: None,
            kept: None,
        };
        let coarse = &mut Coarse::of(&qp).unwrap();
        let found = balance(&qp, coarse).unwrap();
        let (_, other) = identified(&qp, coarse).unwrap();
        assert!(found.residual.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-14));
        found
    }

    #[test]
    fn a_load_inside_the_cone_of_the_contact_forces_leaves_nothing() {
        let found = solve(&[[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], [2.0, 1.0]);
        assert!(found.margin < 1e-14);
        assert!(found.point.iter().all(|l| *l >= 0.0));
    }

    #[test]
    fn a_load_outside_the_cone_leaves_the_direction_in_which_it_pulls_away() {
        let found = solve(&[[1.0, 0.0], [1.0, 1.0]], [1.0, -2.0]);
        assert_eq!(found.residual, [0.0, -2.0]);
        assert!((found.margin - (4.0f64 / 5.0).sqrt()).abs() < 1e-14);
    }
}
