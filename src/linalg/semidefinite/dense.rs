//! Dense symmetric positive semidefinite systems of the coarse space: W = G_F G_F', r x r.

use faer::linalg::solvers::{Llt, SelfAdjointEigen, Solve};
use faer::{Mat, MatMut, MatRef, Side};

use crate::error::{Error, Kind, Result};
use crate::linalg::semidefinite::{is_regular, SINGULAR};
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
    /// Columns `v / sqrt(eigenvalue)` of the eigenvectors kept, `W+ = T T'`, and the eigenvectors of the kernel.
    Pseudo {
        kept: Matrix,
        kernel: Matrix,
    },
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

    /// Cholesky factor, if W, with its largest diagonal entry about 1, is safely regular.
    pub fn regular(w: &Matrix) -> Result<Option<Self>> {
        let _room = headroom(PRODUCTS + MATRICES * w.data.len() * size_of::<f64>(), "a dense coarse matrix")?;
        let view = MatRef::from_column_major_slice(&w.data, w.rows, w.cols);
        let Ok(llt) = Llt::new(view, Side::Lower) else { return Ok(None) };
        let pivot = smallest_pivot(&llt);
        let solver = Self { inverse_root: vec![1.0; w.rows], factor: SpdFactor::Cholesky(llt) };
        let is_regular = is_regular(w.rows, pivot, |x| {
            x.copy_from_slice(&solver.solve(x));
            Ok(())
        })?;
        Ok(is_regular.then_some(solver))
    }

    /// `W+ = T T'`, T = `kept`, of a matrix with this kernel.
    pub fn of_parts(kept: Matrix, kernel: Matrix) -> Self {
        Self { inverse_root: vec![1.0; kept.rows], factor: SpdFactor::Pseudo { kept, kernel } }
    }

    /// T of `W+ = T T'`, if there is no Cholesky factor; the scales must be 1.
    pub fn kept(&self) -> Option<&Matrix> {
        match &self.factor {
            SpdFactor::Cholesky(_) => None,
            SpdFactor::Pseudo { kept, .. } => Some(kept),
        }
    }

    /// Dimension of the kernel.
    pub fn deficiency(&self) -> usize {
        match &self.factor {
            SpdFactor::Cholesky(_) => 0,
            SpdFactor::Pseudo { kernel, .. } => kernel.cols,
        }
    }

    /// Basis of the kernel, n x deficiency.
    pub fn kernel(&self) -> Matrix {
        let SpdFactor::Pseudo { kernel, .. } = &self.factor else {
            return Matrix { rows: self.inverse_root.len(), ..Matrix::default() };
        };
        let mut basis = kernel.clone();
        for j in 0..basis.cols {
            basis.col_mut(j).iter_mut().zip(&self.inverse_root).for_each(|(v, root)| *v *= root);
        }
        basis
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
            SpdFactor::Pseudo { kept, .. } => kept.mul_add(1.0, &kept.mul_transposed(&b), &mut x),
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
    let none = Matrix { rows: w.nrows(), ..Matrix::default() };
    let (mut kept, mut kernel) = (none.clone(), none);
    for j in 0..w.ncols() {
        let value = eigen.S()[j];
        let (to, length) = if value > SINGULAR { (&mut kept, value.sqrt()) } else { (&mut kernel, 1.0) };
        let column: Vec<f64> = (0..w.nrows()).map(|i| eigen.U()[(i, j)] / length).collect();
        to.push_col(&column);
    }
    Ok(SpdFactor::Pseudo { kept, kernel })
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
        let kernel = solver.kernel();
        assert!(kernel.cols == 1 && (kernel.get(0, 0) + kernel.get(1, 0)).abs() < 1e-14, "{kernel:?}");
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
