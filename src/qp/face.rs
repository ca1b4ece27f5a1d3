//! The minimum of theta on a face, with rows F not held at their bound, by a direct method:
//!
//! ```text
//! A_FF x - G_F'alpha = b_F,   G_F x = e
//! ```
//!
//! With `H = A_FF + G_F'Q G_F`, Q > 0 diagonal, `H x = b_F + G_F'(alpha + Q e)` has the same solutions, and H is positive
//! definite if x is unique; then `S alpha = e - G_F H^-1 (b_F + G_F'Q e)`, `S = G_F H^-1 G_F'`. If some motions are free
//! or resisted weakly, T'G_F with orthonormal rows replaces G_F, and T'e replaces e: `alpha = T beta`.

use crate::error::Result;
use crate::linalg::vector::NOISE;
use crate::linalg::{Entries, Matrix, PivotedCholesky, SpdSolver};
use crate::platform::{interrupt, tally};
use crate::qp::coarse::Coarse;
use crate::qp::Qp;

/// Number of square matrices over all rows and modes of a face in memory.
const MATRICES: usize = 8;

/// Data for dense factors of faces in addition to the problem.
#[derive(Clone, Copy)]
pub struct Direct<'a> {
    pub entries: &'a dyn Entries,
    /// Limit of the total number of free rows and modes: memory and work grow with its second and third power.
    pub limit: usize,
}

impl Direct<'_> {
    /// Largest number of bytes for this total number of free rows and modes.
    pub fn bytes(order: usize) -> usize {
        order.saturating_mul(order).saturating_mul(MATRICES * size_of::<f64>())
    }
}

pub struct Face<'a> {
    qp: Qp<'a>,
    /// F, n rows, ascending.
    rows: Vec<usize>,
    factor: PivotedCholesky,
    /// `H^-1 G_F'T`, n x rank.
    spread: Matrix,
    /// Q, stiffness of A per unit of `G G'`.
    penalty: Vec<f64>,
    /// T, r x rank; none if all motions are resisted well.
    basis: Option<Matrix>,
    /// Dimension of the part of alpha that the rows do not determine.
    undetermined: usize,
    /// S, rank x rank; none without modes.
    coarse: Option<SpdSolver>,
}

impl<'a> Face<'a> {
    /// `None`: A_FF is not positive semidefinite.
    pub fn new(qp: Qp<'a>, entries: &dyn Entries, rows: Vec<usize>) -> Result<Option<Self>> {
        interrupt::check()?;
        let n = rows.len();
        let mut h = Matrix::zeros(n, n)?;
        entries.add_block(&rows, &mut h)?;
        let (basis, undetermined) = resisted(&qp, &rows)?;
        let modes = modes(&qp, &rows, basis.as_ref())?;
        let penalty = penalty(&h, &modes);
        for l in 0..n {
            for mode in 0..modes.cols {
                let (from, to) = (modes.col(mode), h.col_mut(l));
                let v = from[l];
                if v != 0.0 {
                    (l..n).for_each(|k| to[k] += penalty[mode] * v * from[k]);
                }
            }
        }
        interrupt::check()?;
        tally::costly();
        let Some(factor) = PivotedCholesky::new(h)? else { return Ok(None) };
        let (spread, coarse) = eliminated(&factor, &modes)?;
        Ok(Some(Self { qp, rows, factor, spread, penalty, basis, undetermined, coarse }))
    }

    /// The face with all rows except those that depend on others up to rounding: for corrections by better data than A.
    pub fn in_full(self) -> Result<Self> {
        let modes = modes(&self.qp, &self.rows, self.basis.as_ref())?;
        let factor = self.factor.in_full();
        let (spread, coarse) = eliminated(&factor, &modes)?;
        Ok(Self { factor, spread, coarse, ..self })
    }

    /// x on F and alpha with `A_FF x - G_F'alpha = force`, `G_F x = rest`; one of the solutions if there are several.
    pub fn solve(&self, mut force: Vec<f64>, rest: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        let g_transposed = self.qp.g_transposed;
        let weighted = self.in_basis(rest).iter().zip(&self.penalty).map(|(rest, q)| rest * q).collect();
        let weighted = self.of_basis(weighted);
        for (force, &i) in force.iter_mut().zip(&self.rows) {
            *force += g_transposed.row_dot(i, &weighted);
        }
        let force = Matrix { rows: self.rows.len(), cols: 1, data: force };
        let mut x = self.factor.solve(&force)?.data;
        let Some(coarse) = &self.coarse else { return Ok((x, vec![0.0; rest.len()])) };
        let mut left = rest.to_vec();
        for (x, &i) in x.iter().zip(&self.rows) {
            g_transposed.row(i).for_each(|(mode, v)| left[mode] -= v * x);
        }
        let beta = coarse.solve(&self.in_basis(&left));
        self.spread.mul_add(1.0, &beta, &mut x);
        Ok((x, self.of_basis(beta)))
    }

    /// The part of x on F that acts on nothing, since rows depend on each other: without it `sum weights_i x_i^2` is least.
    pub fn idle(&self, x: &[f64], weights: &[f64]) -> Result<Vec<f64>> {
        let (kernel, root) = (self.factor.kernel()?, |k: usize| weights[k].sqrt());
        let basis = Matrix::from_fn(kernel.rows, kernel.cols, |k, j| root(k) * kernel.get(k, j))?;
        let basis = basis.orthonormalised(NOISE);
        let mut idle = vec![0.0; x.len()];
        let weighted: Vec<f64> = x.iter().enumerate().map(|(k, x)| root(k) * x).collect();
        basis.mul_add(1.0, &basis.mul_transposed(&weighted), &mut idle);
        idle.iter_mut().enumerate().for_each(|(k, x)| *x /= root(k));
        Ok(idle)
    }

    /// `T'v`
    fn in_basis(&self, v: &[f64]) -> Vec<f64> {
        self.basis.as_ref().map_or_else(|| v.to_vec(), |basis| basis.mul_transposed(v))
    }

    /// `T beta`
    fn of_basis(&self, beta: Vec<f64>) -> Vec<f64> {
        let Some(basis) = &self.basis else { return beta };
        let mut alpha = vec![0.0; basis.rows];
        basis.mul_add(1.0, &beta, &mut alpha);
        alpha
    }

    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Rows were left out although they are not exactly dependent.
    pub fn is_truncated(&self) -> bool {
        self.factor.is_truncated()
    }

    /// Rows of F that depend on others as far as A shows, and their stiffness.
    pub fn left_out(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.factor.left_out().map(|(k, stiffness)| (self.rows[k], stiffness))
    }

    /// Dimension of the part of alpha that the face does not determine.
    pub fn undetermined(&self) -> usize {
        self.undetermined
    }
}

/// `G_F'T`, n x rank.
fn modes(qp: &Qp, rows: &[usize], basis: Option<&Matrix>) -> Result<Matrix> {
    let mut modes = Matrix::zeros(rows.len(), qp.e.len())?;
    for (k, &i) in rows.iter().enumerate() {
        qp.g_transposed.row(i).for_each(|(mode, v)| modes.set(k, mode, v));
    }
    match basis {
        Some(basis) => product(&modes, basis),
        None => Ok(modes),
    }
}

/// T, if the rows F do not resist all motions well, and the number of free motions.
fn resisted(qp: &Qp, rows: &[usize]) -> Result<(Option<Matrix>, usize)> {
    let mut held = vec![true; qp.g_transposed.rows()];
    rows.iter().for_each(|&i| held[i] = false);
    let mut coarse = Coarse::of(qp)?;
    let on_face = coarse.on(&held)?;
    Ok((on_face.basis(), on_face.deficiency()))
}

/// `A B`
fn product(a: &Matrix, b: &Matrix) -> Result<Matrix> {
    let mut product = Matrix::zeros(a.rows, b.cols)?;
    (0..b.cols).for_each(|j| a.mul_add(1.0, b.col(j), product.col_mut(j)));
    Ok(product)
}

/// `q_k = (sum A_ii / n) / |g_k|^2`: both parts of H have equal weight, in any units; 1 if A or the mode is zero.
fn penalty(h: &Matrix, modes: &Matrix) -> Vec<f64> {
    let stiffness = (0..h.rows).map(|i| h.get(i, i)).sum::<f64>() / h.rows.max(1) as f64;
    let positive = |v: f64| if v > 0.0 { v } else { 1.0 };
    let length = |k: usize| modes.col(k).iter().map(|v| v * v).sum::<f64>() / h.rows.max(1) as f64;
    (0..modes.cols).map(|k| positive(stiffness) / positive(length(k))).collect()
}

/// `H^-1 G_F'T` and S.
fn eliminated(factor: &PivotedCholesky, modes: &Matrix) -> Result<(Matrix, Option<SpdSolver>)> {
    let spread = factor.solve(modes)?;
    let r = modes.cols;
    if r == 0 {
        return Ok((spread, None));
    }
    let mut s = Matrix::zeros(r, r)?;
    for j in 0..r {
        s.col_mut(j).copy_from_slice(&modes.mul_transposed(spread.col(j)));
    }
    let scale: Vec<f64> = (0..r).map(|k| if s.get(k, k) > 0.0 { s.get(k, k) } else { 1.0 }).collect();
    let solver = SpdSolver::new(&s, &scale)?;
    Ok((spread, Some(solver)))
}
