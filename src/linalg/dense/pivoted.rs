//! `P'A P = L L'` of a dense positive semidefinite matrix, the largest pivot first, which gives the rank. Kernels of
//! faer, sequential.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt_pivoting::factor::{
    cholesky_in_place, cholesky_in_place_scratch, PivLltParams,
};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{MatMut, MatRef, Par, Spec};

use crate::error::Result;
use crate::linalg::Matrix;
use crate::numbers::linalg::SINGULAR;
use crate::numbers::rounding;
use crate::platform::memory::{headroom, refusal, reserved, zeros, PRODUCTS};

pub struct PivotedCholesky {
    /// Row at each position.
    order: Vec<usize>,
    /// n x n; its leading rank x rank lower triangle is the factor of `P'D^-1/2 A D^-1/2 P`, D = diag A.
    factor: Matrix,
    inverse_root: Vec<f64>,
    rank: usize,
    /// Rank if only pivots that are rounding are left out.
    full_rank: usize,
}

impl PivotedCholesky {
    /// `a` is n x n, its lower triangle is read. `None`: a diagonal entry is negative or not finite.
    pub fn new(mut a: Matrix) -> Result<Option<Self>> {
        let n = a.rows;
        let mut inverse_root = zeros(n, "a dense factor")?;
        for i in 0..n {
            let d = a.get(i, i);
            inverse_root[i] = if d > 0.0 { d.sqrt().recip() } else { 1.0 };
        }
        for j in 0..n {
            let column = a.col_mut(j);
            (j..n).for_each(|i| column[i] *= inverse_root[i] * inverse_root[j]);
        }
        let mut order = reserved(n, "a dense factor")?;
        order.extend(0..n);
        if (0..n).all(|i| a.get(i, i) == 0.0) {
            return Ok(Some(Self { order, factor: a, inverse_root, rank: 0, full_rank: 0 }));
        }
        let mut inverse = order.clone();
        let need = cholesky_in_place_scratch::<usize, f64>(n, Par::Seq, Spec::<PivLltParams, f64>::default());
        let _room = headroom(PRODUCTS, "a dense factor")?;
        let mut workspace = MemBuffer::try_new(need)
            .map_err(|_| refusal(need.unaligned_bytes_required(), "a dense factor"))?;
        let done = cholesky_in_place(
            MatMut::from_column_major_slice_mut(&mut a.data, n, n),
            &mut order,
            &mut inverse,
            Par::Seq,
            MemStack::new(&mut workspace),
            Spec::<PivLltParams, f64>::default(),
        );
        let Ok(found) = done.map(|(info, _)| info.rank) else { return Ok(None) };
        let above = |limit: f64| (0..found).find(|&j| a.get(j, j) * a.get(j, j) <= limit).unwrap_or(found);
        // entries may be inaccurate; below the second limit a pivot is certainly rounding
        let (rank, full_rank) = (above(SINGULAR), above(rounding::SUM));
        Ok(Some(Self { order, factor: a, inverse_root, rank, full_rank }))
    }

    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Some pivots left out are more than rounding.
    pub fn is_truncated(&self) -> bool {
        self.rank < self.full_rank
    }

    /// The rows that are left out, and their diagonal entries.
    pub fn left_out(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.order[self.rank..].iter().map(|&i| (i, self.inverse_root[i].powi(-2)))
    }

    /// The factor including these pivots.
    pub fn in_full(self) -> Self {
        Self { rank: self.full_rank, ..self }
    }

    /// A solution of `A X = B` (n x k) if there is one: the one that is 0 on the rows beyond the rank.
    pub fn solve(&self, b: &Matrix) -> Result<Matrix> {
        let scaled = |i: usize, j: usize| b.get(i, j) * self.inverse_root[i];
        let mut y = Matrix::from_fn(self.rank, b.cols, |k, j| scaled(self.order[k], j))?;
        let n = self.factor.rows;
        let leading = MatRef::from_column_major_slice(&self.factor.data, n, n);
        let leading = leading.submatrix(0, 0, self.rank, self.rank);
        let _room = headroom(PRODUCTS, "a solution")?;
        let mut view = MatMut::from_column_major_slice_mut(&mut y.data, self.rank, b.cols);
        solve_lower_triangular_in_place(leading, view.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(leading.transpose(), view.as_mut(), Par::Seq);
        let mut x = Matrix::zeros(b.rows, b.cols)?;
        for j in 0..b.cols {
            for (k, &i) in self.order[..self.rank].iter().enumerate() {
                x.set(i, j, y.get(k, j) * self.inverse_root[i]);
            }
        }
        Ok(x)
    }

    /// A basis of the x with `A x = 0` up to rounding, n x (n - rank), with all pivots that are more than rounding.
    pub fn kernel(&self) -> Result<Matrix> {
        let (n, rank) = (self.factor.rows, self.full_rank);
        let mut along = Matrix::from_fn(rank, n - rank, |k, j| self.factor.get(rank + j, k))?;
        let leading = MatRef::from_column_major_slice(&self.factor.data, n, n).submatrix(0, 0, rank, rank);
        let _room = headroom(PRODUCTS, "the kernel of a dense factor")?;
        let view = MatMut::from_column_major_slice_mut(&mut along.data, rank, n - rank);
        solve_upper_triangular_in_place(leading.transpose(), view, Par::Seq);
        let mut kernel = Matrix::zeros(n, n - rank)?;
        for j in 0..n - rank {
            self.order[..rank]
                .iter()
                .enumerate()
                .for_each(|(k, &i)| kernel.set(i, j, -along.get(k, j) * self.inverse_root[i]));
            let own = self.order[rank + j];
            kernel.set(own, j, self.inverse_root[own]);
        }
        Ok(kernel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `C'C` with a k x n matrix C of fixed numbers, column i multiplied by `scale[i]`.
    fn gram(k: usize, scale: &[f64]) -> Matrix {
        let n = scale.len();
        let c = |l: usize, i: usize| scale[i] * (((7 * l + 3) * (3 * i + 1)) as f64).sin();
        let mut a = Matrix::zeros(n, n).unwrap();
        for i in 0..n {
            for j in 0..n {
                a.set(i, j, (0..k).map(|l| c(l, i) * c(l, j)).sum());
            }
        }
        a
    }

    fn image(a: &Matrix, x: &Matrix) -> Vec<f64> {
        let mut image = vec![0.0; a.rows];
        a.mul_add(1.0, x.col(0), &mut image);
        image
    }

    #[test]
    fn a_singular_matrix_shows_its_rank_and_what_is_in_its_range_is_solved() {
        for (rank, n) in [(1, 1), (3, 3), (3, 7), (5, 6), (150, 200)] {
            let scale: Vec<f64> = (0..n).map(|i| 10f64.powi(i as i32 % 7 - 3)).collect();
            let a = gram(rank, &scale);
            let mut x = Matrix::zeros(n, 1).unwrap();
            (0..n).for_each(|i| x.set(i, 0, (i as f64).cos() / scale[i]));
            let b = Matrix { rows: n, cols: 1, data: image(&a, &x) };
            let factor = PivotedCholesky::new(a.clone()).unwrap().unwrap();
            assert_eq!(factor.rank(), rank);
            let solution = factor.solve(&b).unwrap();
            let found = image(&a, &solution);
            assert!((0..n).all(|i| (found[i] - b.get(i, 0)).abs() <= 1e-7 * scale[i] * n as f64));
            assert!(solution.data.iter().filter(|x| **x != 0.0).count() <= rank);
            let kernel = factor.kernel().unwrap();
            assert_eq!((kernel.rows, kernel.cols), (n, n - rank));
            for j in 0..kernel.cols {
                let image = a.mul_transposed(kernel.col(j));
                assert!((0..n).all(|i| image[i].abs() <= 1e-9 * scale[i] * n as f64), "{image:?}");
            }
        }
    }

    #[test]
    fn nothing_and_zero_have_no_rank_and_a_negative_diagonal_is_refused() {
        assert_eq!(PivotedCholesky::new(Matrix::default()).unwrap().unwrap().rank(), 0);
        let zero = PivotedCholesky::new(Matrix::zeros(2, 2).unwrap()).unwrap().unwrap();
        assert_eq!(zero.rank(), 0);
        assert_eq!(zero.solve(&Matrix::zeros(2, 1).unwrap()).unwrap().data, [0.0; 2]);
        for entry in [-1.0, f64::NAN] {
            assert!(PivotedCholesky::new(Matrix { rows: 1, cols: 1, data: vec![entry] }).unwrap().is_none());
        }
    }

    #[test]
    fn weak_pivots_are_left_out_or_not_as_asked() {
        let a = Matrix { rows: 2, cols: 2, data: vec![1.0, 1.0, 1.0, 1.0 + 1e-12] };
        for (in_full, rank, x) in [(false, 1, 1.0), (true, 2, 0.0)] {
            let factor = PivotedCholesky::new(a.clone()).unwrap().unwrap();
            let factor = if in_full { factor.in_full() } else { factor };
            assert_eq!((factor.rank(), factor.is_truncated()), (rank, rank == 1));
            let b = Matrix { rows: 2, cols: 1, data: vec![1.0, 1.0 + 1e-12] };
            let found = factor.solve(&b).unwrap();
            assert!(
                (found.get(0, 0) - x).abs() < 1e-3 && (found.get(1, 0) - (1.0 - x)).abs() < 1e-3,
                "{found:?}"
            );
        }
    }

    #[test]
    fn a_pivot_of_1e_10_counts_and_one_of_1e_12_is_weak() {
        for (pivot, rank) in [(1e-9, 2), (1e-10, 2), (1e-12, 1), (1e-13, 1)] {
            let a = Matrix { rows: 2, cols: 2, data: vec![1.0, 1.0, 1.0, 1.0 + pivot] };
            assert_eq!(PivotedCholesky::new(a).unwrap().unwrap().rank(), rank, "{pivot:e}");
        }
    }
}
