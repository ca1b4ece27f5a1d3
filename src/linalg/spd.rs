//! Dense symmetric positive semidefinite systems of the coarse space: W = G_F G_F', r x r.

use faer::linalg::solvers::{Llt, SelfAdjointEigen, Solve};
use faer::{Mat, MatRef, Side};

use crate::error::{Error, Kind, Result};
use crate::linalg::Matrix;

/// Relative size of a pivot or an eigenvalue below which the matrix counts as singular.
const RANK_TOLERANCE: f64 = 1e-11;

/// Solves `W x = b`: Cholesky where W is safely regular, else the minimum-norm solution.
pub enum SpdSolver {
    Cholesky(Llt<f64>),
    /// Columns `v / sqrt(eigenvalue)` of the eigenvectors kept: `W+ = T T'`.
    Pseudo(Matrix),
}

impl SpdSolver {
    /// `scale[i]` is the diagonal entry that W_ii is small or large against (that of the whole W).
    pub fn new(w: &Matrix, scale: &[f64]) -> Result<Self> {
        let view = MatRef::from_column_major_slice(&w.data, w.rows, w.cols);
        if let Ok(llt) = Llt::new(view, Side::Lower) {
            let l = llt.L();
            if (0..w.rows).all(|i| l[(i, i)] * l[(i, i)] > RANK_TOLERANCE * scale[i]) {
                return Ok(Self::Cholesky(llt));
            }
        }
        let largest = scale.iter().copied().fold(0.0, f64::max);
        Self::pseudo(view, RANK_TOLERANCE * largest)
    }

    fn pseudo(w: MatRef<'_, f64>, cut: f64) -> Result<Self> {
        let eigen = SelfAdjointEigen::new(w, Side::Lower)
            .map_err(|_| Error::new(Kind::Internal, "the eigenvalues of a coarse matrix did not converge"))?;
        let mut kept = Matrix { rows: w.nrows(), ..Matrix::default() };
        for j in 0..w.ncols() {
            let value = eigen.S()[j];
            if value > cut {
                let column: Vec<f64> = (0..w.nrows()).map(|i| eigen.U()[(i, j)] / value.sqrt()).collect();
                kept.push_col(&column);
            }
        }
        Ok(Self::Pseudo(kept))
    }

    /// Dimension of the kernel that was cut off.
    pub fn deficiency(&self) -> usize {
        match self {
            Self::Cholesky(_) => 0,
            Self::Pseudo(kept) => kept.rows - kept.cols,
        }
    }

    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        match self {
            Self::Cholesky(llt) => {
                let mut x = Mat::from_fn(b.len(), 1, |i, _| b[i]);
                llt.solve_in_place(x.as_mut());
                (0..b.len()).map(|i| x[(i, 0)]).collect()
            }
            Self::Pseudo(kept) => {
                let mut x = vec![0.0; b.len()];
                kept.mul_add(1.0, &kept.mul_transposed(b), &mut x);
                x
            }
        }
    }
}

/// Singular values of `a` (rows >= cols), descending, with the right singular vectors as columns.
pub fn right_singular(a: &Matrix) -> Result<(Vec<f64>, Matrix)> {
    let view = MatRef::from_column_major_slice(&a.data, a.rows, a.cols);
    let svd = view
        .thin_svd()
        .map_err(|_| Error::new(Kind::Internal, "the singular values of K R did not converge"))?;
    let mut vectors = Matrix::zeros(a.cols, a.cols)?;
    for j in 0..a.cols {
        for i in 0..a.cols {
            vectors.set(i, j, svd.V()[(i, j)]);
        }
    }
    Ok(((0..a.cols).map(|j| svd.S()[j]).collect(), vectors))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_singular_coarse_matrix_gives_the_solution_of_minimum_norm() {
        let w = Matrix { rows: 2, cols: 2, data: vec![1.0, 1.0, 1.0, 1.0] };
        let solver = SpdSolver::new(&w, &[1.0, 1.0]).unwrap();
        assert_eq!(solver.deficiency(), 1);
        let x = solver.solve(&[2.0, 2.0]);
        assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_regular_coarse_matrix_is_solved_by_cholesky() {
        let w = Matrix { rows: 2, cols: 2, data: vec![4.0, 2.0, 2.0, 3.0] };
        let solver = SpdSolver::new(&w, &[4.0, 3.0]).unwrap();
        assert_eq!(solver.deficiency(), 0);
        let x = solver.solve(&[8.0, 8.0]);
        assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 2.0).abs() < 1e-14);
    }
}
