//! `min |e - G l|` over `l_i >= 0 (i bounded)`. Its residual `a` decides whether the equalities can be met at all: `G_i'a <= 0` on
//! bounded rows, `= 0` on free ones, `e'a = |a|^2`. Where G has few columns a is found as the point of the cone of those that
//! is nearest to e, which ends and loses no digits to `G G'`; else by Lawson and Hanson's method.

use crate::error::{Kind, Result};
use crate::linalg::vector::{norm, ratio};
use crate::linalg::Csr;
use crate::platform::interrupt;
use crate::qp::coarse::Coarse;
use crate::qp::{nearest_point, Polyhedron, Qp};

/// A correlation with the residual below this fraction of its terms counts as zero.
const ZERO: f64 = 1e-12;
/// Modes of a problem for which a square matrix of them, and one rotation of it per row and mode, are cheap.
const FEW: usize = 1500;

pub struct Balance {
    pub point: Vec<f64>,
    /// `a = e - G l`: `G_i'a <= 0` on bounded rows, `= 0` on free ones, `e'a = |a|^2`; only nearly so where Lawson and Hanson's
    /// method has not converged.
    pub residual: Vec<f64>,
    /// `|a| / |e|`
    pub margin: f64,
}

pub fn balance(qp: &Qp, coarse: &mut Coarse) -> Result<Balance> {
    let (point, residual) = match in_cone(qp.g_transposed, qp.bounded, qp.e)? {
        Some(found) => found,
        None => lawson_hanson(qp, coarse)?,
    };
    Ok(Balance { margin: margin(qp, &residual), point, residual })
}

/// Forces l and what they leave, `a = e - G l` of least `|W a|`, W = diag(`weights`) > 0.
pub fn weighted(qp: &Qp, weights: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut g_transposed = qp.g_transposed.clone();
    for (mode, v) in g_transposed.col.iter().zip(&mut g_transposed.val) {
        *v *= weights[*mode];
    }
    let e: Vec<f64> = qp.e.iter().zip(weights).map(|(e, w)| e * w).collect();
    let (point, a) = match in_cone(&g_transposed, qp.bounded, &e)? {
        Some(found) => found,
        None => {
            let scaled = Qp { g_transposed: &g_transposed, e: &e, ..*qp };
            lawson_hanson(&scaled, &mut Coarse::new(&g_transposed, qp.blocks, qp.rounding)?)?
        }
    };
    Ok((point, a.iter().zip(weights).map(|(a, w)| a / w).collect()))
}

/// l, the forces that keep a in its cone, and a, orthogonal to rows with a force to its own rounding; none where rounding keeps the
/// method from ending.
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

/// l and a where Lawson and Hanson's method ends, or has taken its rounds.
fn lawson_hanson(qp: &Qp, coarse: &mut Coarse) -> Result<(Vec<f64>, Vec<f64>)> {
    let m = qp.b.len();
    let mut held: Vec<bool> = qp.bounded.to_vec();
    let mut point = least_squares(qp, coarse, &held)?;
    for round in 0..3 * m + 3 {
        interrupt::reached("rows admitted to the nearest forces", round)?;
        let residual = qp.left(&point);
        let Some(best) = most_correlated(qp, &held, &residual) else {
            return Ok((point, residual));
        };
        held[best] = false;
        loop {
            let target = least_squares(qp, coarse, &held)?;
            let negative = |i: &usize| qp.bounded[*i] && !held[*i] && target[*i] <= 0.0;
            let blocking = (0..m).filter(negative).map(|i| point[i] / (point[i] - target[i]));
            let t = blocking.fold(1.0, f64::min);
            let inside = t == 1.0;
            for i in 0..m {
                point[i] += t * (target[i] - point[i]);
                if qp.bounded[i] && !held[i] && (target[i] <= 0.0 && point[i] <= ZERO * target[i].abs()) {
                    point[i] = 0.0;
                    held[i] = true;
                }
            }
            if inside {
                break;
            }
        }
    }
    let residual = qp.left(&point);
    Ok((point, residual))
}

/// The held row that reduces the residual fastest.
fn most_correlated(qp: &Qp, held: &[bool], residual: &[f64]) -> Option<usize> {
    let size = norm(residual);
    if size <= ZERO * norm(qp.e) {
        return None;
    }
    let correlation = |i: usize| {
        let length = qp.g_transposed.row(i).map(|(_, v)| v * v).sum::<f64>().sqrt();
        (qp.g_transposed.row_dot(i, residual), length)
    };
    (0..held.len())
        .filter(|&i| held[i])
        .map(|i| (i, correlation(i)))
        .filter(|(_, (c, length))| *c > 1e-9 * length * size)
        .max_by(|(_, (a, la)), (_, (b, lb))| (a / la).total_cmp(&(b / lb)))
        .map(|(i, _)| i)
}

/// `G_P' (G_P G_P')+ e` on the rows P that are not held, zero elsewhere.
fn least_squares(qp: &Qp, coarse: &mut Coarse, held: &[bool]) -> Result<Vec<f64>> {
    let alpha = coarse.on(held)?.solve(qp.e)?;
    Ok((0..held.len()).map(|i| if held[i] { 0.0 } else { qp.g_transposed.row_dot(i, &alpha) }).collect())
}

/// `|a| / |e|`: how far the equalities are from being met.
fn margin(qp: &Qp, residual: &[f64]) -> f64 {
    ratio(norm(residual), norm(qp.e))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Csr, Packed};

    /// By the cone, and the same by Lawson and Hanson.
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
        };
        let coarse = &mut Coarse::new(&g_transposed, &[], 1e-14).unwrap();
        let found = balance(&qp, coarse).unwrap();
        let (_, other) = lawson_hanson(&qp, coarse).unwrap();
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
