//! The minimum of theta on few rows by a finite method, even for linearly dependent rows. It solves the problem whose
//! dual is (12):
//!
//! ```text
//! 1/2 |w|^2 - e'alpha -> min   subject to   v_i'w + G_i'alpha <= -b_i (= where x_i is free),   A = V'V, v_i column i of V
//! ```
//!
//! x are its multipliers. With the proximal term `1/2 (alpha - alpha_k)'Q (alpha - alpha_k)`, Q > 0 diagonal and small
//! compared with A, w and `Q^1/2 alpha` are the point of a polyhedron nearest to `(0, Q^1/2 alpha_k + Q^-1/2 e)`, which
//! the method of Goldfarb and Idnani finds; then `e - G x = Q (alpha - alpha_k)`, which the next search, with alpha_k =
//! alpha, reduces.

use crate::error::{Error, Kind, Result};
use crate::linalg::vector::{norm, ratio, NOISE};
use crate::linalg::{Csr, Matrix, PivotedCholesky};
use crate::platform::{interrupt, tally};
use crate::qp::{nearest_point, Direct, Polyhedron, Qp, Solution, Verdict};

/// Limit of searches.
const SEARCHES: usize = 20;
/// `Q / (G G')` in units of 1 / A: the inverse ratio limits the motions of one search relative to the compliance A.
const WEAK: f64 = 1e-8;
/// Final limit of `|e - G x|` relative to `|e| + |G||x|`.
const BALANCED: f64 = 1e-13;
/// If the residual differs from the previous one by less than this part, the motion has met no further row.
const UNCHANGED: f64 = 0.01;
/// Limit of multiplications per search.
const WORK: usize = 10_000_000_000;

/// The minimum, not yet judged, with the other data of `from`; none if there are too many rows, or rounding prevents a
/// solution.
pub fn proximal(qp: Qp, direct: Direct, from: &Solution) -> Result<Option<Solution>> {
    let (n, r) = (qp.b.len(), qp.e.len());
    if n + r > direct.limit || 4usize.saturating_mul(n + r).saturating_mul(n * n) > WORK {
        return Ok(None);
    }
    match Searches::new(qp, direct).and_then(|searches| searches.map(Searches::run).transpose()) {
        Ok(found) => Ok(found.flatten().map(|(x, alpha, products)| {
            let mut found = Solution { x, alpha, verdict: Verdict::Stalled, ..from.clone() };
            found.counts.products += products;
            found
        })),
        Err(Error { kind: Kind::Memory | Kind::Internal, .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

struct Searches<'a> {
    qp: Qp<'a>,
    /// Rows `v_i', G_i' Q^-1/2`, those of free x also with the opposite sign, and their gaps.
    rows: Csr,
    gap: Vec<f64>,
    noise: Vec<f64>,
    /// Rows of free x, in the order of their second rows.
    free: Vec<usize>,
    rank: usize,
    /// `Q^1/2`
    root: Vec<f64>,
}

impl<'a> Searches<'a> {
    /// `None`: A is not positive semidefinite.
    fn new(qp: Qp<'a>, direct: Direct) -> Result<Option<Self>> {
        let (n, r) = (qp.b.len(), qp.e.len());
        let all: Vec<usize> = (0..n).collect();
        let mut a = Matrix::zeros(n, n)?;
        direct.entries.add_block(&all, &mut a)?;
        let mut squares = vec![0.0; r];
        qp.g_transposed.col.iter().zip(&qp.g_transposed.val).for_each(|(&k, v)| squares[k] += v * v);
        let positive = |v: f64| if v > 0.0 && v < f64::INFINITY { v } else { 1.0 };
        let deforming = (0..n).map(|i| a.get(i, i)).sum::<f64>();
        // length / force
        let compliance =
            if deforming > 0.0 { deforming } else { norm(qp.b) * norm(&qp.g_transposed.val) / norm(qp.e) };
        let root: Vec<f64> = squares
            .iter()
            .map(|square| positive(WEAK * ratio(*square, positive(compliance))).sqrt())
            .collect();
        interrupt::check()?;
        tally::costly();
        let Some(factor) = PivotedCholesky::new(a)?.map(PivotedCholesky::in_full) else { return Ok(None) };
        let (v, rank) = (factor.root()?, factor.rank());
        let free: Vec<usize> = all.iter().copied().filter(|&i| !qp.bounded[i]).collect();
        let (mut rows, mut gap, mut noise) = (Csr::empty(rank + r), Vec::new(), Vec::new());
        for (&i, sign) in all.iter().map(|i| (i, 1.0)).chain(free.iter().map(|i| (i, -1.0))) {
            let deforming = v.col(i).iter().enumerate().filter(|(_, v)| **v != 0.0);
            let moving = qp.g_transposed.row(i).map(|(k, g)| (rank + k, sign * g / root[k]));
            rows.push_row(deforming.map(|(k, v)| (k, sign * v)).chain(moving));
            gap.push(-sign * qp.b[i]);
            noise.push(NOISE * qp.b[i].abs());
        }
        Ok(Some(Self { qp, rows, gap, noise, free, rank, root }))
    }

    /// x, alpha, and the number of products with A, in which the host may end the method. If a motion has met no row that
    /// resists it, the next search starts ten times as far away.
    fn run(self) -> Result<Option<(Vec<f64>, Vec<f64>, usize)>> {
        let (mut best, mut least, mut last, mut stride) = (None, f64::INFINITY, 0.0, 1.0);
        let mut before = vec![0.0; self.qp.e.len()];
        let mut image = vec![0.0; self.qp.b.len()];
        for searches in 1..=SEARCHES {
            let (x, alpha) = self.search(&before)?;
            self.qp.a.try_apply(&x, &mut image)?;
            let (left, size) = self.unbalanced(&x);
            if left < least {
                (best, least) = (Some((x, alpha.clone(), searches)), left);
            }
            if left <= BALANCED * size {
                break;
            }
            stride = if (left - last).abs() <= UNCHANGED * last { 10.0 * stride } else { 1.0 };
            before.iter_mut().zip(alpha).for_each(|(before, alpha)| *before += stride * (alpha - *before));
            last = left;
        }
        Ok(best)
    }

    /// x and alpha of the search that starts with alpha_k = `before`.
    fn search(&self, before: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        let Self { qp, rows, gap, noise, free, rank, root } = self;
        let mut target = vec![0.0; *rank];
        target.extend(before.iter().zip(qp.e).zip(root).map(|((a, e), q)| q * a + e / q));
        let found = nearest_point(Polyhedron { rows, gap, target: &target, noise, rounding: 0.0 })?;
        let mut x = found.forces;
        let opposite = x.split_off(qp.b.len());
        free.iter().zip(opposite).for_each(|(&i, force)| x[i] -= force);
        Ok((x, found.point[*rank..].iter().zip(root).map(|(a, q)| a / q).collect()))
    }

    /// `|e - G x|` and `|e| + |G||x|`
    fn unbalanced(&self, x: &[f64]) -> (f64, f64) {
        let Qp { g_transposed, e, .. } = self.qp;
        let (mut rest, mut terms) = (e.to_vec(), vec![0.0; e.len()]);
        g_transposed.mul_transposed_add(-1.0, x, &mut rest);
        g_transposed.mul_transposed_abs_add(x, &mut terms);
        (norm(&rest), norm(e) + norm(&terms))
    }
}
