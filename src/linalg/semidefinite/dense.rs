//! Dense symmetric positive semidefinite systems of the coarse space: W = G_F G_F', r x r.

use faer::linalg::solvers::{Llt, SelfAdjointEigen, Solve};
use faer::{Mat, MatMut, Side};

use crate::error::{Error, Kind, Result};
use crate::numbers::linalg::SINGULAR;

use crate::linalg::Matrix;
use crate::platform::memory::{headroom, PRODUCTS};

/// Number of matrices of the size of W in memory, including the eigenvectors while they are computed.
const MATRICES: usize = 8;

/// Solves `W x = b`: by Cholesky if W is safely regular, otherwise with minimum norm. Both act on `D^-1/2 W D^-1/2` with
/// D = `scale`, so that modes of stiff and soft bodies have equal weight.
pub struct SpdSolver {
    /// `D^-1/2`
    inverse_root: Vec<f64>,
    factor: SpdFactor,
}

enum SpdFactor {
    Cholesky(Llt<f64>),
    /// T of `W+ = T T'`: columns `v / sqrt(eigenvalue)` of the eigenvectors kept.
    Pseudo(Matrix),
}

impl SpdSolver {
    /// `scale[i]` > 0: the reference for the size of W_ii.
    pub fn new(w: &Matrix, scale: &[f64]) -> Result<Self> {
        let _room = headroom(PRODUCTS + MATRICES * w.data.len() * size_of::<f64>(), "a dense coarse matrix")?;
        let inverse_root: Vec<f64> = scale.iter().map(|s| s.sqrt().recip()).collect();
        let scaled = Mat::from_fn(w.rows, w.cols, |i, j| inverse_root[i] * w.get(i, j) * inverse_root[j]);
        let factor = match Llt::new(scaled.as_ref(), Side::Lower) {
            Ok(llt) if smallest_pivot(&llt) > SINGULAR => SpdFactor::Cholesky(llt),
            _ => eigenvectors(&scaled)?,
        };
        Ok(Self { inverse_root, factor })
    }

    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let scaled =
            |x: &[f64]| -> Vec<f64> { x.iter().zip(&self.inverse_root).map(|(x, d)| x * d).collect() };
        let b = scaled(b);
        let mut x = vec![0.0; b.len()];
        match &self.factor {
            SpdFactor::Cholesky(llt) => {
                x.copy_from_slice(&b);
                llt.solve_in_place(MatMut::from_column_major_slice_mut(&mut x, b.len(), 1));
            }
            SpdFactor::Pseudo(kept) => kept.mul_add(1.0, &kept.mul_transposed(&b), &mut x),
        }
        scaled(&x)
    }
}

fn smallest_pivot(llt: &Llt<f64>) -> f64 {
    let l = llt.L();
    (0..l.nrows()).fold(f64::INFINITY, |smallest, i| smallest.min(l[(i, i)] * l[(i, i)]))
}

fn eigenvectors(w: &Mat<f64>) -> Result<SpdFactor> {
    let eigen = SelfAdjointEigen::new(w.as_ref(), Side::Lower)
        .map_err(|_| Error::new(Kind::Internal, "the eigenvalues of a coarse matrix did not converge"))?;
    let mut kept = Matrix { rows: w.nrows(), ..Matrix::default() };
    for j in (0..w.ncols()).filter(|&j| eigen.S()[j] > SINGULAR) {
        let length = eigen.S()[j].sqrt();
        let column: Vec<f64> = (0..w.nrows()).map(|i| eigen.U()[(i, j)] / length).collect();
        kept.push_col(&column);
    }
    Ok(SpdFactor::Pseudo(kept))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_singular_coarse_matrix_gives_the_solution_of_minimum_norm() {
        let w = Matrix { rows: 2, cols: 2, data: vec![1.0, 1.0, 1.0, 1.0] };
        let solver = SpdSolver::new(&w, &[1.0, 1.0]).unwrap();
        assert!(matches!(&solver.factor, SpdFactor::Pseudo(kept) if kept.cols == 1));
        let x = solver.solve(&[2.0, 2.0]);
        assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_regular_coarse_matrix_is_solved_by_cholesky() {
        let w = Matrix { rows: 2, cols: 2, data: vec![4.0, 2.0, 2.0, 3.0] };
        let solver = SpdSolver::new(&w, &[4.0, 3.0]).unwrap();
        assert!(matches!(solver.factor, SpdFactor::Cholesky(_)));
        let x = solver.solve(&[8.0, 8.0]);
        assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 2.0).abs() < 1e-14);
    }
}
