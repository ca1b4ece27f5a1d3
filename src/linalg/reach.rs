//! `B K_ff^-1 B'` by supernode reach: each supernode of L sees only the rows of B whose elimination path
//! meets it. With `Y = L^-1 P B'` the result is `Y'Y`: exactly symmetric and positive semidefinite.

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{linalg::matmul::matmul, Accum, Mat, Par};

use crate::error::Result;
use crate::linalg::elimination::NONE;
use crate::linalg::memory::{copied, reserved, room, PRODUCTS};
use crate::linalg::{Cholesky, Csr, Interrupt, Packed};

/// What a supernode passes on to its parent: update rows for the columns (rows of B) seen so far.
struct Update {
    /// Positions in L of the rows.
    rows: Vec<usize>,
    /// Rows of B, ascending.
    columns: Vec<usize>,
    values: Mat<f64>,
}

const WHAT: &str = "the dual operator of a body";

/// `rows` (m x n, over all dofs of the body) gives the m x m matrix.
pub fn inverse_form(cholesky: &Cholesky, rows: &Csr) -> Result<Packed> {
    let factor = cholesky.factor();
    let symbolic = &cholesky.analysis.symbolic;
    let _room = room(small_pieces(cholesky, rows) + PRODUCTS, WHAT)?;
    let mut form = Packed::zeros(rows.rows())?;
    let mut own = entries_by_supernode(cholesky, rows)?;
    let mut waiting: Vec<Vec<Update>> = (0..symbolic.n_supernodes()).map(|_| Vec::new()).collect();
    let mut local = vec![NONE; symbolic.nrows()];
    let interrupt = Interrupt::present();
    for s in 0..symbolic.n_supernodes() {
        interrupt.check()?;
        let updates = std::mem::take(&mut waiting[s]);
        let columns = merged_columns(&own[s], &updates)?;
        if columns.is_empty() {
            continue;
        }
        let (begin, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
        let node = factor.supernode(s);
        let front_rows = || (begin..end).chain(node.pattern().iter().copied());
        front_rows().enumerate().for_each(|(at, row)| local[row] = at);
        let mut front =
            assemble(&local, &columns, std::mem::take(&mut own[s]), updates, front_rows().count())?;
        let width = end - begin;
        let (top, bottom) = node.val().split_at_row(width);
        let (mut y, mut rest) = front.as_mut().split_at_row_mut(width);
        solve_lower_triangular_in_place(top, y.as_mut(), Par::Seq);
        add_gram(&mut form, &columns, y.as_ref())?;
        if let Some(&next) = node.pattern().first() {
            matmul(rest.as_mut(), Accum::Add, bottom, y.as_ref(), -1.0, Par::Seq);
            let parent = symbolic.supernode_end().partition_point(|&end| end <= next);
            let mut values = zero_matrix(rest.nrows(), rest.ncols())?;
            values.copy_from(rest);
            waiting[parent].push(Update { rows: copied(node.pattern(), WHAT)?, columns, values });
        }
    }
    Ok(form)
}

/// Bytes of the lists by supernode, by dof and by entry of B, which grow piece by piece.
fn small_pieces(cholesky: &Cholesky, rows: &Csr) -> usize {
    let symbolic = &cholesky.analysis.symbolic;
    96 * symbolic.n_supernodes() + 8 * symbolic.nrows() + 96 * rows.col.len()
}

/// The entries of P B': per supernode (row of B, position in L, value), rows of B ascending.
fn entries_by_supernode(cholesky: &Cholesky, rows: &Csr) -> Result<Vec<Vec<(usize, usize, f64)>>> {
    let ends = cholesky.analysis.symbolic.supernode_end();
    let mut entries = reserved(ends.len(), WHAT)?;
    entries.resize(ends.len(), Vec::new());
    for i in 0..rows.rows() {
        for (dof, value) in rows.row(i) {
            let at = cholesky.position(dof);
            if at != NONE {
                entries[ends.partition_point(|&end| end <= at)].push((i, at, value));
            }
        }
    }
    Ok(entries)
}

fn merged_columns(own: &[(usize, usize, f64)], updates: &[Update]) -> Result<Vec<usize>> {
    let count = own.len() + updates.iter().map(|update| update.columns.len()).sum::<usize>();
    let mut columns = reserved(count, WHAT)?;
    columns.extend(own.iter().map(|entry| entry.0));
    updates.iter().for_each(|update| columns.extend(&update.columns));
    columns.sort_unstable();
    columns.dedup();
    Ok(columns)
}

/// The rows of the front (own columns of the supernode, then its pattern) of the partly eliminated P B'.
fn assemble(
    local: &[usize],
    columns: &[usize],
    own: Vec<(usize, usize, f64)>,
    updates: Vec<Update>,
    rows: usize,
) -> Result<Mat<f64>> {
    let mut front = zero_matrix(rows, columns.len())?;
    let find = |column: usize| columns.partition_point(|&c| c < column);
    for (column, at, value) in own {
        front[(local[at], find(column))] += value;
    }
    for update in updates {
        for (j, &column) in update.columns.iter().enumerate() {
            let to = find(column);
            for (i, &row) in update.rows.iter().enumerate() {
                front[(local[row], to)] += update.values[(i, j)];
            }
        }
    }
    Ok(front)
}

/// Zeros, rows padded by faer to lines of the cache.
fn zero_matrix(rows: usize, columns: usize) -> Result<Mat<f64>> {
    let _room = room((rows + 8) * columns * size_of::<f64>(), WHAT)?;
    Ok(Mat::zeros(rows, columns))
}

/// `form += Y'Y` on the given rows of B.
fn add_gram(form: &mut Packed, columns: &[usize], y: faer::MatRef<'_, f64>) -> Result<()> {
    let k = columns.len();
    let mut gram = zero_matrix(k, k)?;
    triangular::matmul(
        gram.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        y.transpose(),
        BlockStructure::Rectangular,
        y,
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
    for j in 0..k {
        for i in j..k {
            form.add(columns[i], columns[j], gram[(i, j)]);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Analysis, Symmetric};
    use std::sync::Arc;

    #[test]
    fn the_form_equals_one_solution_per_row() {
        let (n, mut ptr, mut col, mut val) = (60usize, vec![0], Vec::new(), Vec::new());
        for i in 0..n {
            for j in [i.wrapping_sub(13), i.wrapping_sub(2), i.wrapping_sub(1)] {
                if j < i {
                    col.push(j);
                    val.push(-0.2 - 0.01 * (i % 5) as f64);
                }
            }
            col.push(i);
            val.push(2.0 + 0.1 * (i % 3) as f64);
            ptr.push(col.len());
        }
        let matrix = Symmetric { ptr, col, val };
        let mut held = vec![false; n];
        held[5] = true;
        let factor = Arc::new(Analysis::new(&matrix, &held).unwrap()).factorize(&matrix).unwrap().unwrap();
        let mut rows = Csr::empty(n);
        for i in 0..9 {
            rows.push_row([(i, 1.0), (5 * i + 10, -0.5), (59, 0.1 * i as f64)]);
        }
        let form = inverse_form(&factor, &rows).unwrap();
        let ended = Interrupt::new(Arc::new(true.into())).during(|| inverse_form(&factor, &rows));
        assert_eq!(ended.unwrap_err().kind, crate::error::Kind::Cancelled);
        for j in 0..9 {
            let mut x = vec![0.0; n];
            rows.row(j).for_each(|(dof, v)| x[dof] += v);
            factor.solve(&mut x).unwrap();
            for i in 0..9 {
                assert!((rows.row_dot(i, &x) - form.get(i, j)).abs() < 1e-14, "({i}, {j})");
            }
        }
    }
}
