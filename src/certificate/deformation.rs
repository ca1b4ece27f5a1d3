//! Which part of a displacement is deformation: everything except the rigid motions that the rows leave free.

use std::sync::Arc;

use crate::certificate::field::Field;
use crate::certificate::part::Measured;
use crate::certificate::NOISE;
use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::sparse::gram::Gram;
use crate::linalg::vector::{axpy, norm, norm_max, ratio};
use crate::linalg::{Analysis, Csr, Matrix};
use crate::numbers::certificate::{NEIGHBOURS, RESISTED};
use crate::platform::interrupt;

/// Solutions with each value of `RESISTED`.
const PASSES: usize = 4;
/// `A b` is rounding if it is below this part of `|A||b|`.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// delta where rows touch, length.
pub(super) struct Deformation {
    pub own: Vec<f64>,
    /// Including the neighbours of these unknowns.
    pub joined: Vec<f64>,
}

impl Deformation {
    pub fn new(field: &Field, measured: &[Measured]) -> Self {
        let own: Vec<f64> = measured.iter().flat_map(|body| &body.deformation).copied().collect();
        let joined = with_neighbours(field, measured, &own);
        Self { own, joined }
    }
}

/// `max(delta_j, 1/2 sum_k |K_jk| delta_k / K_jj)` where rows touch, since a single unknown may be at rest by symmetry, and for carried
/// unknowns the same by what their rows give them, `1/2 sum_i |b_ij| sum_l |b_il| delta_l / (D~_j (sum_l b_il^2 / D~_l + C_i))`; delta_j
/// for grounded unknowns.
fn with_neighbours(field: &Field, measured: &[Measured], own: &[f64]) -> Vec<f64> {
    let (touched, at) = (field.data.touched, &field.at);
    let mut all = own.to_vec();
    for (p, body) in measured.iter().enumerate() {
        for (j, terms) in touched.range(p).zip(&body.neighbours).filter(|(j, _)| !field.is_grounded(p, *j)) {
            let joined = terms / field.unit / at.metric[j];
            all[j] = all[j].max(NEIGHBOURS * joined);
        }
    }
    if at.carried.contains(&true) {
        let led = by_rows(field, own);
        all.iter_mut().zip(led).for_each(|(delta, led)| *delta = delta.max(NEIGHBOURS * led));
    }
    all
}

/// Deformation that rows with a force pass on to carried unknowns, where rows touch, length.
fn by_rows(field: &Field, own: &[f64]) -> Vec<f64> {
    let mut led = vec![0.0; own.len()];
    for kind in RowKind::ALL {
        let (rows, forces) = (field.rows(kind), field.answer.forces(kind));
        for i in (0..rows.len()).filter(|i| forces[*i] != 0.0) {
            for (j, b) in rows.matrix.row(i).filter(|(j, _)| field.at.carried[*j]) {
                let others = || rows.matrix.row(i).filter(|(l, _)| *l != j);
                let moved: f64 = others().map(|(l, b)| b.abs() * own[l]).sum();
                let yielding: f64 = others().map(|(l, b)| b * b / field.at.metric[l]).sum();
                let yielding = yielding + field.unit * rows.compliance[i];
                led[j] += ratio(b.abs() * moved, field.at.metric[j] * yielding);
            }
        }
    }
    led
}

/// Of every body the amplitudes of the rigid motions that the rows leave free, r, length: the least-squares fit to u, in D without the
/// grounded unknowns, that satisfies the rigid equality rows between bodies, `H R a = h`; rows on one body alone are ignored.
pub(super) fn free_motions(field: &Field) -> Result<Vec<Vec<f64>>> {
    let mut first = Vec::with_capacity(field.fitted.len() + 1);
    first.push(0);
    for fitted in &field.fitted {
        first.push(first[first.len() - 1] + fitted.amplitudes.len());
    }
    if first[field.fitted.len()] == 0 {
        return Ok(vec![Vec::new(); field.fitted.len()]);
    }
    let weights = weights(field);
    let mut amplitudes = Vec::with_capacity(first[field.fitted.len()]);
    for (fitted, weight) in field.fitted.iter().zip(&weights) {
        amplitudes.extend(fitted.amplitudes.iter().map(|a| a * weight));
    }
    let (joints, given) = joints(field, &first, &weights);
    let kept = nearest(&joints, &given, amplitudes)?;
    let own = |p: usize| kept[first[p]..first[p + 1]].iter().map(|b| b / weights[p]).collect();
    Ok((0..field.fitted.len()).map(own).collect())
}

/// `(unit_p / unit_0)^1/2`, no unit: the weight of an amplitude of body p, `|R_p a_p|_D = unit_p^1/2 |a_p|`.
fn weights(field: &Field) -> Vec<f64> {
    let first = field.fitted.first().map_or(1.0, |fitted| fitted.unit);
    field.fitted.iter().map(|fitted| (fitted.unit / first).sqrt()).collect()
}

/// `H R`, m x (modes of all bodies), and h of the rigid equality rows that join two or more bodies, each scaled to length 1.
fn joints(field: &Field, first: &[usize], weights: &[f64]) -> (Csr, Vec<f64>) {
    let rows = field.data.equalities;
    let (mut joints, mut given) = (Csr::empty(first[field.fitted.len()]), Vec::new());
    for i in (0..rows.len()).filter(|i| rows.compliance[*i] == 0.0) {
        if field.touched(rows, i).nth(1).is_none() {
            continue;
        }
        let mut entries = Vec::new();
        for p in field.touched(rows, i) {
            let own = field.data.touched.range(p);
            let inside = rows.matrix.row(i).filter(|(j, _)| own.contains(j));
            let inside: Vec<(usize, f64)> = inside.map(|(j, v)| (j - own.start, v)).collect();
            let resisted = resisted(&inside, &field.fitted[p].motions).into_iter().enumerate();
            entries.extend(resisted.map(|(k, v)| (first[p] + k, v / weights[p])).filter(|e| e.1 != 0.0));
        }
        let length = norm(&entries.iter().map(|(_, v)| *v).collect::<Vec<_>>());
        if length.is_normal() {
            joints.push_row(entries.into_iter().map(|(j, v)| (j, v / length)));
            given.push(rows.rhs[i] / length);
        }
    }
    (joints, given)
}

/// `h R`, r, of the entries of a row on one body; 0 if it is rounding.
fn resisted(entries: &[(usize, f64)], motions: &Matrix) -> Vec<f64> {
    let of = |k: usize| {
        let terms = entries.iter().map(|&(j, v)| v * motions.get(j, k));
        let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), term: f64| (sum + term, size + term.abs()));
        if f64::abs(sum) > NOISE * size {
            sum
        } else {
            0.0
        }
    };
    (0..motions.cols).map(of).collect()
}

/// `b - A^+ (A b - h)`, the motions nearest to b with `A b = h`: `b <- b - (A'A + delta I)^-1 A'(A b - h)` with decreasing delta,
/// while `A b - h` is more than rounding. Very small resistance, which comes from errors of R, does not count as a joint. Where h asks
/// for far longer motions, those with `A b = 0`.
fn nearest(a: &Csr, h: &[f64], mut b: Vec<f64>) -> Result<Vec<f64>> {
    let joined = Gram::of(a)?;
    let mut w = joined.sum(a, &vec![false; a.rows()])?;
    let diagonal: Vec<f64> = (0..a.cols).map(|k| w.diagonal(k)).collect();
    let largest = norm_max(&diagonal);
    // true also for NaN
    if !(largest > 0.0) {
        return Ok(b);
    }
    let analysis = Arc::new(Analysis::new(joined.pattern(), &vec![false; a.cols])?);
    let mut image = vec![0.0; a.rows()];
    for delta in RESISTED {
        interrupt::check()?;
        for (k, diagonal) in diagonal.iter().enumerate() {
            let at = w.ptr[k + 1] - 1;
            w.val[at] = diagonal + delta * largest;
        }
        let Ok(factor) = analysis.attempt(&w, 1.0)? else { break };
        for _ in 0..PASSES {
            a.mul(&b, &mut image);
            axpy(-1.0, h, &mut image);
            if norm(&image) <= ROUNDING * largest.sqrt() * norm(&b) {
                return Ok(b);
            }
            let mut step = a.mul_transposed(&image);
            factor.solve(&mut step)?;
            // joints that contradict each other, or are felt through errors of R alone; without h no step is longer than b
            if norm(&step) > 2.0 * norm(&b) {
                return nearest(a, &vec![0.0; a.rows()], b);
            }
            axpy(-1.0, &step, &mut b);
        }
    }
    Ok(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_that_joints_resist_are_taken_out() {
        let mut a = Csr::empty(4);
        let half = 0.5_f64.sqrt();
        a.push_row([(0, half), (1, -half)]);
        a.push_row([(1, half), (2, -half)]);
        a.push_row([(0, half), (2, -half)]);
        let kept = nearest(&a, &[0.0; 3], vec![1.0, 2.0, 6.0, 7.0]).unwrap();
        assert!(kept.iter().zip([3.0, 3.0, 3.0, 7.0]).all(|(b, e)| (b - e).abs() < 1e-14), "{kept:?}");
    }

    /// Two joints that all but agree in direction, and once ask for distances that differ by 1e3.
    #[test]
    fn joints_that_contradict_each_other_prescribe_nothing() {
        let mut a = Csr::empty(2);
        let half = 0.5_f64.sqrt();
        a.push_row([(0, half), (1, -half)]);
        a.push_row([(0, half), (1, half * (1e-6 - 1.0))]);
        let apart = nearest(&a, &[half, half * (1.0 + 1e-6)], vec![2.0, 1.1]).unwrap();
        assert!((apart[0] - apart[1] - 1.0).abs() < 1e-5, "{apart:?}");
        let together = nearest(&a, &[0.0, 1e3], vec![2.0, 1.1]).unwrap();
        assert!((together[0] - together[1]).abs() < 1e-5, "{together:?}");
    }

    /// The second row resists the common motion only by rounding of R.
    #[test]
    fn what_is_hardly_resisted_is_no_joint() {
        let mut a = Csr::empty(2);
        let half = 0.5_f64.sqrt();
        a.push_row([(0, half), (1, -half)]);
        a.push_row([(0, half), (1, -half * (1.0 + 1e-12))]);
        let kept = nearest(&a, &[0.0; 2], vec![1e6, 1e6 + 1.0]).unwrap();
        assert!(kept.iter().all(|b| (b - 1e6 - 0.5).abs() < 1e-5), "{kept:?}");
    }
}
