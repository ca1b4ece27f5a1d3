//! Eigenvalues and singular values of dense matrices.

use faer::linalg::solvers::SelfAdjointEigen;
use faer::{MatRef, Side};

use crate::error::{Error, Kind, Result};
use crate::linalg::Matrix;
use crate::platform::memory::{headroom, PRODUCTS};

/// Eigenvalues of the symmetric matrix `a`, ascending, with the eigenvectors as columns.
pub fn symmetric_eigen(a: &Matrix) -> Result<(Vec<f64>, Matrix)> {
    if a.cols == 0 {
        return Ok((Vec::new(), Matrix::default()));
    }
    let _room = headroom(PRODUCTS + 8 * a.data.len() * size_of::<f64>(), "the eigenvalues of a matrix")?;
    if a.cols == 0 {
        return Ok((Vec::new(), Matrix::zeros(0, 0)?));
    }
    let view = MatRef::from_column_major_slice(&a.data, a.rows, a.cols);
    let eigen = SelfAdjointEigen::new(view, Side::Lower)
        .map_err(|_| Error::new(Kind::Internal, "the eigenvalues of a Schur complement did not converge"))?;
    let vectors = Matrix::from_fn(a.rows, a.cols, |i, j| eigen.U()[(i, j)])?;
    Ok(((0..a.cols).map(|j| eigen.S()[j]).collect(), vectors))
}

/// Singular values of `a` (rows >= cols), descending, with the right singular vectors as columns.
pub fn right_singular(a: &Matrix) -> Result<(Vec<f64>, Matrix)> {
    let view = MatRef::from_column_major_slice(&a.data, a.rows, a.cols);
    let svd = view
        .thin_svd()
        .map_err(|_| Error::new(Kind::Internal, "the singular values of K R did not converge"))?;
    let vectors = Matrix::from_fn(a.cols, a.cols, |i, j| svd.V()[(i, j)])?;
    Ok(((0..a.cols).map(|j| svd.S()[j]).collect(), vectors))
}
