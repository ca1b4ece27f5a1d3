//! The end of an elimination: the Schur complement of the dofs eliminated last, read from the factor, and dofs among
//! them that are held afterwards. Only their dense block is computed anew.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};

use crate::error::Result;
use crate::linalg::memory::{copied, room, zeros, PRODUCTS};
use crate::linalg::{Cholesky, Matrix};

const WHAT: &str = "the end of an elimination";

/// Dofs of one connected part, the last to be eliminated, in this order; all coupled with each other in the pattern.
pub struct Trailing<'a> {
    pub dofs: &'a [usize],
    /// Their Schur complement, m x m, to be factorised anew.
    pub schur: &'a Matrix,
    /// Those to be held.
    pub held: &'a [usize],
}

impl Cholesky {
    /// `L_tt L_tt'` of the dofs t (m x m): the Schur complement of the matrix that was factorised.
    pub fn trailing(&self, dofs: &[usize]) -> Result<Matrix> {
        let m = dofs.len();
        let mut l = Matrix::zeros(m, m)?;
        for k in 0..m {
            for j in k..m {
                let at = self.entry(dofs[j], dofs[k]);
                l.set(j, k, at.map_or(0.0, |at| self.values[at]));
            }
        }
        let mut schur = Matrix::zeros(m, m)?;
        for k in 0..m {
            for j in 0..m {
                schur.set(j, k, (0..=j.min(k)).map(|q| l.get(j, q) * l.get(k, q)).sum());
            }
        }
        Ok(schur)
    }

    /// The factor with the trailing dofs of every part factorised anew and some of them held. `Err` names a dof at
    /// which what is left is not positive definite.
    pub fn holding(mut self, parts: &[Trailing<'_>]) -> Result<std::result::Result<Self, usize>> {
        let mut held: Vec<usize> = parts.iter().flat_map(|part| part.held.iter().copied()).collect();
        held.sort_unstable();
        self.clear_rows(&held)?;
        for part in parts {
            let m = part.dofs.len();
            let mut l = Matrix { rows: m, cols: m, data: copied(&part.schur.data, WHAT)? };
            for k in (0..m).filter(|&k| part.held.contains(&part.dofs[k])) {
                (0..m).for_each(|i| {
                    l.set(i, k, 0.0);
                    l.set(k, i, 0.0);
                });
                l.set(k, k, 1.0);
            }
            if let Err(at) = cholesky_in_place(&mut l) {
                return Ok(Err(part.dofs[at]));
            }
            for k in 0..m {
                for j in k..m {
                    if let Some(at) = self.entry(part.dofs[j], part.dofs[k]) {
                        self.values[at] = l.get(j, k);
                    }
                }
            }
        }
        self.held = held;
        Ok(Ok(self))
    }

    /// Displacements without forces outside the trailing dofs: `x_t` given (m x r), `x_i = -K_ii^-1 K_it x_t`. One block
    /// of columns for every part, over all dofs.
    pub fn extended(&self, parts: &[(&[usize], &Matrix)]) -> Result<Matrix> {
        let order = &self.analysis.order;
        let (n, columns) = (order.len(), parts.iter().map(|part| part.1.cols).sum());
        let mut y = Matrix::zeros(n, columns)?;
        let mut first = 0;
        for (dofs, given) in parts {
            for (k, &dof) in dofs.iter().enumerate() {
                let row = self.analysis.position[dof];
                for (j, at) in (k..dofs.len()).filter_map(|j| Some((j, self.entry(dofs[j], dof)?))) {
                    (0..given.cols)
                        .for_each(|c| y.data[row + (first + c) * n] += self.values[at] * given.get(j, c));
                }
            }
            first += given.cols;
        }
        self.back_substitute(&mut y)?;
        let mut x = Matrix::zeros(self.analysis.position.len(), columns)?;
        for c in 0..columns {
            let column = x.col_mut(c);
            y.col(c).iter().zip(order).for_each(|(y, &dof)| column[dof] = *y);
        }
        Ok(x)
    }

    /// `y <- L^-T y`, n x r in the order of elimination.
    fn back_substitute(&self, y: &mut Matrix) -> Result<()> {
        let (symbolic, factor) = (&self.analysis.symbolic, self.factor());
        let (n, r) = (y.rows, y.cols);
        let _room = room(2 * n * r * size_of::<f64>() + PRODUCTS, WHAT)?;
        let mut below = zeros(n * r, WHAT)?;
        let mut y = MatMut::from_column_major_slice_mut(&mut y.data, n, r);
        for s in (0..symbolic.n_supernodes()).rev() {
            let (begin, width) = (symbolic.supernode_begin()[s], factor.supernode(s).val().ncols());
            let (top, bottom) = factor.supernode(s).val().split_at_row(width);
            let pattern = symbolic.supernode(s).pattern();
            let height = pattern.len();
            for c in 0..r {
                let column = &mut below[c * height..(c + 1) * height];
                column.iter_mut().zip(pattern).for_each(|(b, &row)| *b = y[(row, c)]);
            }
            let below = MatRef::from_column_major_slice(&below[..height * r], height, r);
            let mut own = y.as_mut().subrows_mut(begin, width);
            matmul(own.as_mut(), Accum::Add, bottom.transpose(), below, -1.0, Par::Seq);
            solve_upper_triangular_in_place(top.transpose(), own, Par::Seq);
        }
        Ok(())
    }

    /// Where `values` has L at the row of dof i and the column of dof j.
    fn entry(&self, i: usize, j: usize) -> Option<usize> {
        let symbolic = &self.analysis.symbolic;
        let (row, column) = (self.analysis.position[i], self.analysis.position[j]);
        let s = symbolic.supernode_end().partition_point(|&end| end <= column);
        let (begin, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
        let node = symbolic.supernode(s);
        let (width, pattern) = (end - begin, node.pattern());
        let local =
            if row < end { row - begin } else { width + pattern.iter().position(|&other| other == row)? };
        Some(symbolic.col_ptr_for_val()[s] + (column - begin) * (width + pattern.len()) + local)
    }

    /// Zeros in the rows of these dofs, in all columns but those of the trailing dofs, which are written later.
    fn clear_rows(&mut self, held: &[usize]) -> Result<()> {
        let symbolic = &self.analysis.symbolic;
        let mut marked = zeros(symbolic.nrows(), WHAT)?;
        held.iter().for_each(|&dof| marked[self.analysis.position[dof]] = 1.0);
        for s in 0..symbolic.n_supernodes() {
            let (begin, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
            let node = symbolic.supernode(s);
            let (start, height) = (symbolic.col_ptr_for_val()[s], end - begin + node.pattern().len());
            for (local, row) in (begin..end).chain(node.pattern().iter().copied()).enumerate() {
                if marked[row] > 0.0 {
                    (0..end - begin).for_each(|column| self.values[start + column * height + local] = 0.0);
                }
            }
        }
        Ok(())
    }
}

/// `A = L L'`, the lower triangle in place; `Err` with the position of a pivot that is not positive.
fn cholesky_in_place(a: &mut Matrix) -> std::result::Result<(), usize> {
    let n = a.rows;
    for k in 0..n {
        let pivot = a.get(k, k);
        if pivot.is_nan() || pivot <= 0.0 {
            return Err(k);
        }
        let root = pivot.sqrt();
        a.col_mut(k)[k..].iter_mut().for_each(|v| *v /= root);
        for j in k + 1..n {
            let factor = a.get(j, k);
            for i in j..n {
                a.set(i, j, a.get(i, j) - a.get(i, k) * factor);
            }
        }
    }
    Ok(())
}
