//! Eigenvalues and singular values of dense matrices.

use faer::diag::DiagRef;
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

/// Singular values of `a` (rows >= cols), descending, with the right singular vectors as columns. faer's iteration ends without them for
/// one singular matrix in very many; for its transpose it ends with them.
pub fn right_singular(a: &Matrix) -> Result<(Vec<f64>, Matrix)> {
    let view = MatRef::from_column_major_slice(&a.data, a.rows, a.cols);
    let of = |values: DiagRef<f64>, vectors: MatRef<f64>| {
        let vectors = Matrix::from_fn(a.cols, a.cols, |i, j| vectors[(i, j)])?;
        Ok(((0..a.cols).map(|j| values[j]).collect(), vectors))
    };
    if let Ok(svd) = view.thin_svd() {
        return of(svd.S(), svd.V());
    }
    let svd = view.transpose().thin_svd();
    let svd = svd.map_err(|_| Error::new(Kind::Internal, "the singular values of K R did not converge"))?;
    of(svd.S(), svd.U())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::vector::{dot, norm};

    /// Two unknowns of three nodes each, held by motions of which two are nearly 0: faer 0.24 does not find the values of this matrix.
    #[test]
    fn singular_values_are_found_where_the_first_iteration_does_not_end() {
        let a = [0.3535533905932738, 0.2597848231798992, 0.2398162747717271, 0.34847359540148476];
        let b = [5.407857977671861e-18, 0.059717278135915444, 0.05971727813591544, 0.06453022113208746];
        let c = [0.3476145143123973, 8.52575004722428e-18];
        let data = [
            [a[0], a[0], 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, a[0], a[0]],
            [a[1], -a[1], 0.0, 0.0, -a[2], a[2]],
            [0.0, 0.0, a[0], a[0], 0.0, 0.0],
            [-b[0], b[0], -a[3], a[3], -b[1], b[2]],
            [-b[3], b[3], c[0], -c[0], -c[1], c[1]],
        ];
        let matrix = Matrix { rows: 6, cols: 6, data: data.concat() };
        let view = MatRef::from_column_major_slice(&matrix.data, 6, 6);
        assert!(view.thin_svd().is_err(), "faer finds them: the second iteration may go");
        let (values, vectors) = right_singular(&matrix).unwrap();
        for j in 0..6 {
            let mut image = vec![0.0; 6];
            matrix.mul_add(1.0, vectors.col(j), &mut image);
            assert!((norm(&image) - values[j]).abs() < 1e-15, "{values:?}");
            let length = |k: usize| dot(vectors.col(j), vectors.col(k)) - f64::from(u8::from(j == k));
            assert!((0..6).all(|k| length(k).abs() < 1e-14), "{vectors:?}");
        }
    }
}
