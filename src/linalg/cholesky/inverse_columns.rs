//! Some columns of `B K_ff^-1 B'`: solves with L and L' for a few rows of B at a time, restricted to the elimination
//! paths of B.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, MatMut, MatRef, Par};

use crate::error::Result;
use crate::linalg::cholesky::analysis::elimination::NONE;
use crate::linalg::cholesky::analysis::supernodes::Node;
use crate::linalg::{Cholesky, Csr, Matrix};
use crate::platform::memory::{filled, headroom, zeros, PRODUCTS};

/// Number of right-hand sides per block: L is read twice for each block.
const TOGETHER: usize = 32;

const WHAT: &str = "columns of a dual operator";

/// `B K_ff^-1 b_j'` for the rows j in `which` of B (`rows`, m x n): m x `which.len()`.
pub fn inverse_columns(cholesky: &Cholesky, rows: &Csr, which: &[usize]) -> Result<Matrix> {
    let mut columns = Matrix::zeros(rows.rows(), which.len())?;
    let met = paths(cholesky, rows, 0..rows.rows())?;
    for (first, which) in which.chunks(TOGETHER).enumerate() {
        let x = solutions(cholesky, rows, which, &met)?;
        for j in 0..which.len() {
            let (x, column) = (x.col(j), columns.col_mut(first * TOGETHER + j));
            for (i, value) in column.iter_mut().enumerate() {
                *value = cholesky.eliminated(rows, i).map(|(at, v)| v * x[at]).sum();
            }
        }
    }
    Ok(columns)
}

/// L at one supernode: the rows of its columns, then the rows below.
struct Panel<'a> {
    node: Node<'a>,
    top: MatRef<'a, f64>,
    bottom: MatRef<'a, f64>,
}

impl<'a> Panel<'a> {
    fn of(cholesky: &'a Cholesky, s: usize) -> Self {
        let node = cholesky.analysis.nodes.node(s);
        let panel = &cholesky.values[node.panel.clone()];
        let panel = MatRef::from_column_major_slice(panel, node.height(), node.width);
        let (top, bottom) = panel.split_at_row(node.width);
        Self { node, top, bottom }
    }

    /// `x_own <- L11^-1 x_own`, `x_below <- x_below - L21 x_own`
    fn eliminate(&self, x: &mut Matrix, work: &mut [f64]) {
        let (n, r, height) = (x.rows, x.cols, self.node.rows.len());
        let mut x = MatMut::from_column_major_slice_mut(&mut x.data, n, r);
        let mut own = x.as_mut().subrows_mut(self.node.begin, self.node.width);
        solve_lower_triangular_in_place(self.top, own.as_mut(), Par::Seq);
        let mut change = MatMut::from_column_major_slice_mut(&mut work[..height * r], height, r);
        matmul(change.as_mut(), Accum::Replace, self.bottom, own.as_ref(), 1.0, Par::Seq);
        for j in 0..r {
            self.node.rows.iter().enumerate().for_each(|(i, &row)| x[(row as usize, j)] -= change[(i, j)]);
        }
    }

    /// `x_own <- L11^-T (x_own - L21' x_below)`
    fn substitute(&self, x: &mut Matrix, work: &mut [f64]) {
        let (n, r, height) = (x.rows, x.cols, self.node.rows.len());
        let mut below = MatMut::from_column_major_slice_mut(&mut work[..height * r], height, r);
        for j in 0..r {
            self.node
                .rows
                .iter()
                .enumerate()
                .for_each(|(i, &row)| below[(i, j)] = x.data[row as usize + j * n]);
        }
        let mut x = MatMut::from_column_major_slice_mut(&mut x.data, n, r);
        let mut own = x.as_mut().subrows_mut(self.node.begin, self.node.width);
        matmul(own.as_mut(), Accum::Add, self.bottom.transpose(), below.as_ref(), -1.0, Par::Seq);
        solve_upper_triangular_in_place(self.top.transpose(), own, Par::Seq);
    }
}

/// True for the supernodes on the paths from the entries of these rows of B to the root.
fn paths(cholesky: &Cholesky, rows: &Csr, which: impl Iterator<Item = usize>) -> Result<Vec<bool>> {
    let nodes = &cholesky.analysis.nodes;
    let mut meets = filled(nodes.count(), false, WHAT)?;
    for (at, _) in which.flat_map(|i| cholesky.eliminated(rows, i)) {
        let mut s = nodes.of_column(at);
        while s != NONE && !meets[s] {
            meets[s] = true;
            s = nodes.parent(s);
        }
    }
    Ok(meets)
}

/// `K_ff^-1 b_j'` in the order of elimination, valid on the paths in `met`.
fn solutions(cholesky: &Cholesky, rows: &Csr, which: &[usize], met: &[bool]) -> Result<Matrix> {
    let (n, r) = (cholesky.analysis.order.len(), which.len());
    let _room = headroom(PRODUCTS, WHAT)?;
    let (mut x, mut work) = (Matrix::zeros(n, r)?, zeros(n * r, WHAT)?);
    for (j, &row) in which.iter().enumerate() {
        cholesky.eliminated(rows, row).for_each(|(at, v)| x.set(at, j, v));
    }
    let own = paths(cholesky, rows, which.iter().copied())?;
    for s in (0..own.len()).filter(|&s| own[s]) {
        Panel::of(cholesky, s).eliminate(&mut x, &mut work);
    }
    for s in (0..met.len()).rev().filter(|&s| met[s]) {
        Panel::of(cholesky, s).substitute(&mut x, &mut work);
    }
    Ok(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::cholesky::inverse_form::inverse_form;
    use crate::linalg::{Analysis, Symmetric};
    use std::sync::Arc;

    /// Grid of springs, two rows of B at every third dof of its edge, more than one block.
    #[test]
    fn columns_are_those_of_the_whole_form() {
        let (side, mut ptr, mut col, mut val) = (60_usize, vec![0], Vec::new(), Vec::new());
        for i in 0..side * side {
            for j in [(i >= side).then(|| i - side), (i % side > 0).then(|| i - 1)].into_iter().flatten() {
                col.push(j as u32);
                val.push(-1.0 - 0.1 * (j % 7) as f64);
            }
            col.push(i as u32);
            val.push(7.0);
            ptr.push(col.len());
        }
        let matrix = Symmetric::new(ptr, col, val);
        let mut held = vec![false; side * side];
        held[3] = true;
        let factor =
            Arc::new(Analysis::new(&matrix, &held).unwrap()).factorize(&matrix, 1.0).unwrap().unwrap();
        let mut rows = Csr::empty(side * side);
        for i in (0..side).step_by(3) {
            rows.push_row([(i, 1.0), (2000 + i, -0.5)]);
            rows.push_row([(i, 0.3)]);
        }
        let whole = inverse_form(&factor, &rows).unwrap();
        for which in [vec![39, 2, 3], (1..38).collect()] {
            let columns = inverse_columns(&factor, &rows, &which).unwrap();
            for (k, &j) in which.iter().enumerate() {
                let error = |i: usize| (columns.get(i, k) - whole.get(i, j)).abs();
                assert!((0..rows.rows()).all(|i| error(i) < 1e-15), "column {j}");
            }
        }
    }
}
