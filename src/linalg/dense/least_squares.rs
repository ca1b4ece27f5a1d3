//! `argmin |A c - b|` of a dense matrix that may be rank-deficient, by QR with pivots.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::householder::{
    apply_block_householder_sequence_transpose_on_the_left_in_place_scratch as transposed_scratch,
    apply_block_householder_sequence_transpose_on_the_left_in_place_with_conj as apply_transposed,
};
use faer::linalg::solvers::ColPivQr;
use faer::{Conj, Mat, Par};

use crate::error::Result;
use crate::linalg::vector::{axpy, norm};
use crate::linalg::Matrix;
use crate::platform::memory::{headroom, refusal, zeros, PRODUCTS};

const WHAT: &str = "a least squares problem";
/// Number of matrices of the size of A in memory: A, its copy, its reflectors, R.
const MATRICES: usize = 4;

/// c, with zeros for dependent columns: a pivot of A with columns of unit length counts as 0 below `cut` times the first.
pub fn least_squares(a: &Matrix, b: &[f64], cut: f64) -> Result<Vec<f64>> {
    let _room = headroom(PRODUCTS + MATRICES * a.data.len() * size_of::<f64>(), WHAT)?;
    let mut c = zeros(a.cols, WHAT)?;
    let lengths: Vec<f64> = (0..a.cols).map(|j| norm(a.col(j))).collect();
    if a.rows == 0 || a.cols == 0 || !lengths.iter().all(|length| length.is_finite()) {
        return Ok(c);
    }
    let unit = |j: usize| if lengths[j] > 0.0 { lengths[j] } else { 1.0 };
    let units: Vec<f64> = (0..a.cols).map(unit).collect();
    let scaled = Mat::from_fn(a.rows, a.cols, |i, j| a.get(i, j) / units[j]);
    let qr = ColPivQr::new(scaled.as_ref());
    let (r, (order, _)) = (qr.thin_R(), qr.P().arrays());
    let first = r[(0, 0)].abs();
    let found = a.rows.min(a.cols);
    let rank = (0..found).find(|&k| !(r[(k, k)].abs() > cut * first)).unwrap_or(found);
    let mut y = Mat::from_fn(a.rows, 1, |i, _| b[i]);
    let need = transposed_scratch::<f64>(a.rows, qr.Q_coeff().nrows(), 1);
    let mut stack = MemBuffer::try_new(need).map_err(|_| refusal(need.unaligned_bytes_required(), WHAT))?;
    let stack = MemStack::new(&mut stack);
    apply_transposed(qr.Q_basis(), qr.Q_coeff(), Conj::No, y.as_mut(), Par::Seq, stack);
    let mut y: Vec<f64> = (0..rank).map(|k| y[(k, 0)]).collect();
    for k in (0..rank).rev() {
        y[k] /= r[(k, k)];
        let above: Vec<f64> = (0..k).map(|i| r[(i, k)]).collect();
        let part = y[k];
        axpy(-part, &above, &mut y[..k]);
    }
    for (k, y) in y.into_iter().enumerate() {
        c[order[k]] = y / units[order[k]];
    }
    Ok(c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::vector::dot;

    #[test]
    fn a_column_that_depends_on_others_is_not_used_and_the_rest_is_orthogonal() {
        // the third is the first plus a millionth of the second
        let columns = [[1.0, 0.0, 2.0, 1.0], [2e6, 0.0, 0.0, 1e6], [3.0, 0.0, 2.0, 2.0], [0.0; 4]];
        let data = columns.concat();
        let a = Matrix { rows: 4, cols: 4, data };
        let b = [1.0, 2.0, 3.0, 5.0];
        let c = least_squares(&a, &b, 1e-12).unwrap();
        assert!(c.iter().filter(|c| **c != 0.0).count() == 2 && c[3] == 0.0, "{c:?}");
        let mut rest = b;
        a.mul_add(-1.0, &c, &mut rest);
        for j in 0..4 {
            assert!(dot(a.col(j), &rest).abs() <= 1e-12 * norm(a.col(j)) * norm(&b), "{rest:?}");
        }
    }

    #[test]
    fn a_square_system_is_solved_and_nothing_gives_nothing() {
        let a = Matrix { rows: 2, cols: 2, data: vec![0.0, 2.0, 1.0, 1.0] };
        let c = least_squares(&a, &[3.0, 5.0], 1e-12).unwrap();
        assert!((c[0] - 1.0).abs() < 1e-15 && (c[1] - 3.0).abs() < 1e-15);
        assert!(least_squares(&Matrix::default(), &[], 1e-12).unwrap().is_empty());
    }
}
