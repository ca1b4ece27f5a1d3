//! The end of an elimination: the Schur complement of the dofs eliminated last, read from the factor, and a factor in
//! which some of them are held. Only their dense block is recomputed.

use crate::error::Result;
use crate::linalg::{Cholesky, Matrix};
use crate::platform::memory::{copied, zeros};

const WHAT: &str = "the end of an elimination";

/// Dofs eliminated last in this order; the pattern couples all of them.
pub struct Trailing<'a> {
    pub dofs: &'a [usize],
    /// Their Schur complement, m x m, to be factorised again.
    pub schur: &'a Matrix,
    /// The dofs to be held.
    pub held: &'a [usize],
}

impl Cholesky {
    /// `L_tt L_tt'` of the dofs t (m x m): the Schur complement of the factorised matrix.
    pub fn trailing(&self, dofs: &[usize]) -> Result<Matrix> {
        let m = dofs.len();
        let lower = |j: usize, k: usize| if j < k { None } else { self.entry(dofs[j], dofs[k]) };
        let l = Matrix::from_fn(m, m, |j, k| lower(j, k).map_or(0.0, |at| self.values[at]))?;
        Matrix::from_fn(m, m, |j, k| (0..=j.min(k)).map(|q| l.get(j, q) * l.get(k, q)).sum())
    }

    /// The factor with the trailing dofs factorised again and some of them held. `Err`: a dof at which the remaining block
    /// is not positive definite.
    pub fn holding(mut self, last: &Trailing) -> Result<std::result::Result<Self, usize>> {
        let Trailing { dofs, schur, held } = last;
        let (m, mut held) = (dofs.len(), held.to_vec());
        held.sort_unstable();
        self.clear_rows(&held)?;
        let mut l = Matrix { rows: m, cols: m, data: copied(&schur.data, WHAT)? };
        for k in (0..m).filter(|&k| held.binary_search(&dofs[k]).is_ok()) {
            (0..m).for_each(|i| {
                l.set(i, k, 0.0);
                l.set(k, i, 0.0);
            });
            l.set(k, k, 1.0);
        }
        if let Err(at) = cholesky_in_place(&mut l) {
            return Ok(Err(dofs[at]));
        }
        for k in 0..m {
            for j in k..m {
                if let Some(at) = self.entry(dofs[j], dofs[k]) {
                    self.values[at] = l.get(j, k);
                }
            }
        }
        self.held = held;
        Ok(Ok(self))
    }

    /// Displacements without forces outside the trailing dofs t: given `x_t` (m x r), `x_i = -K_ii^-1 K_it x_t`.
    pub fn extended(&self, dofs: &[usize], given: &Matrix) -> Result<Matrix> {
        let order = &self.analysis.order;
        let (n, columns) = (order.len(), given.cols);
        let mut y = Matrix::zeros(n, columns)?;
        for (k, &dof) in dofs.iter().enumerate() {
            let row = self.analysis.position[dof];
            for (j, at) in (k..dofs.len()).filter_map(|j| Some((j, self.entry(dofs[j], dof)?))) {
                (0..columns).for_each(|c| y.data[row + c * n] += self.values[at] * given.get(j, c));
            }
        }
        let mut workspace = self.workspace()?;
        (0..columns)
            .for_each(|c| self.backward(0..self.analysis.nodes.count(), y.col_mut(c), &mut workspace));
        let mut x = Matrix::zeros(self.analysis.position.len(), columns)?;
        for c in 0..columns {
            let column = x.col_mut(c);
            y.col(c).iter().zip(order).for_each(|(y, &dof)| column[dof] = *y);
        }
        Ok(x)
    }

    /// Position in `values` of the entry of L in the row of dof i and the column of dof j.
    fn entry(&self, i: usize, j: usize) -> Option<usize> {
        let nodes = &self.analysis.nodes;
        let (row, column) = (self.analysis.position[i], self.analysis.position[j]);
        let node = nodes.node(nodes.of_column(column));
        let local = if row < node.end() {
            row - node.begin
        } else {
            node.width + node.rows.binary_search(&(row as u32)).ok()?
        };
        Some(node.panel.start + (column - node.begin) * node.height() + local)
    }

    /// Sets the rows of these dofs to zero, in all columns except those of the trailing dofs, which are written later.
    fn clear_rows(&mut self, held: &[usize]) -> Result<()> {
        let nodes = &self.analysis.nodes;
        let mut marked = zeros(nodes.order(), WHAT)?;
        held.iter().for_each(|&dof| marked[self.analysis.position[dof]] = 1.0);
        for node in nodes.nodes() {
            let panel = &mut self.values[node.panel.clone()];
            for (local, _) in node.front_rows().enumerate().filter(|(_, row)| marked[*row] > 0.0) {
                panel.iter_mut().skip(local).step_by(node.height()).for_each(|v| *v = 0.0);
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
