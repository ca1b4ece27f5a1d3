//! The minimum of theta on a face, rows F not held at their bound, by a direct method:
//!
//! ```text
//! A_FF x - G_F'alpha = b_F,   G_F x = e
//! ```
//!
//! With `H = A_FF + G_F'Q G_F`, Q > 0 diagonal, `H x = b_F + G_F'(alpha + Q e)` has the same solutions, and H
//! is positive definite where x is unique; then `S alpha = e - G_F H^-1 (b_F + G_F'Q e)`, `S = G_F H^-1 G_F'`.

use crate::error::Result;
use crate::linalg::{Entries, Matrix, PivotedCholesky, SpdSolver};
use crate::qp::Qp;

pub struct Face<'a> {
    qp: Qp<'a>,
    /// F, ascending, n of them.
    rows: Vec<usize>,
    factor: PivotedCholesky,
    /// `H^-1 G_F'`, n x r.
    spread: Matrix,
    /// Q, stiffness of A per unit of `G G'`.
    penalty: Vec<f64>,
    /// S, r x r; none without modes.
    coarse: Option<SpdSolver>,
}

impl<'a> Face<'a> {
    /// `None`: A_FF is not positive semidefinite.
    pub fn new(qp: Qp<'a>, entries: &dyn Entries, rows: Vec<usize>) -> Result<Option<Self>> {
        let (n, r) = (rows.len(), qp.e.len());
        let mut h = Matrix::zeros(n, n)?;
        entries.add_block(&rows, &mut h)?;
        let mut modes = Matrix::zeros(n, r)?;
        for (k, &i) in rows.iter().enumerate() {
            qp.g_transposed.row(i).for_each(|(mode, v)| modes.set(k, mode, v));
        }
        let penalty = penalty(&h, &modes);
        for (l, &j) in rows.iter().enumerate() {
            for (mode, v) in qp.g_transposed.row(j).filter(|(_, v)| *v != 0.0) {
                let (from, to) = (modes.col(mode), h.col_mut(l));
                (l..n).for_each(|k| to[k] += penalty[mode] * v * from[k]);
            }
        }
        let Some(factor) = PivotedCholesky::new(h)? else { return Ok(None) };
        let spread = factor.solve(&modes)?;
        let coarse = if r == 0 { None } else { Some(schur_complement(&modes, &spread)?) };
        Ok(Some(Self { qp, rows, factor, spread, penalty, coarse }))
    }

    /// x on F and alpha with `A_FF x - G_F'alpha = force`, `G_F x = rest`: where there are many, one of them.
    pub fn solve(&self, mut force: Vec<f64>, rest: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        let g_transposed = self.qp.g_transposed;
        let weighted: Vec<f64> = rest.iter().zip(&self.penalty).map(|(rest, q)| rest * q).collect();
        for (force, &i) in force.iter_mut().zip(&self.rows) {
            *force += g_transposed.row_dot(i, &weighted);
        }
        let force = Matrix { rows: self.rows.len(), cols: 1, data: force };
        let mut x = self.factor.solve(&force)?.data;
        let Some(coarse) = &self.coarse else { return Ok((x, Vec::new())) };
        let mut left = rest.to_vec();
        for (x, &i) in x.iter().zip(&self.rows) {
            g_transposed.row(i).for_each(|(mode, v)| left[mode] -= v * x);
        }
        let alpha = coarse.solve(&left);
        self.spread.mul_add(1.0, &alpha, &mut x);
        Ok((x, alpha))
    }

    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// True where the face leaves a part of alpha undetermined.
    pub fn is_deficient(&self) -> bool {
        self.coarse.as_ref().is_some_and(|coarse| coarse.deficiency() > 0)
    }
}

/// `q_k = (sum A_ii / n) / |g_k|^2`: both parts of H weigh alike, in any units; 1 where A or the mode vanishes.
fn penalty(h: &Matrix, modes: &Matrix) -> Vec<f64> {
    let stiffness = (0..h.rows).map(|i| h.get(i, i)).sum::<f64>() / h.rows.max(1) as f64;
    let positive = |v: f64| if v > 0.0 { v } else { 1.0 };
    let length = |k: usize| modes.col(k).iter().map(|v| v * v).sum::<f64>() / h.rows.max(1) as f64;
    (0..modes.cols).map(|k| positive(stiffness) / positive(length(k))).collect()
}

fn schur_complement(modes: &Matrix, spread: &Matrix) -> Result<SpdSolver> {
    let r = modes.cols;
    let mut s = Matrix::zeros(r, r)?;
    for j in 0..r {
        s.col_mut(j).copy_from_slice(&modes.mul_transposed(spread.col(j)));
    }
    let scale: Vec<f64> = (0..r).map(|k| if s.get(k, k) > 0.0 { s.get(k, k) } else { 1.0 }).collect();
    SpdSolver::new(&s, &scale)
}
