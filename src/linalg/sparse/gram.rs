//! Gram matrices `sum_i w_i g_i' g_i` of sparse rows g_i: the coarse matrix of a face, the coupling of rows.

use std::collections::HashMap;

use crate::error::Result;
use crate::linalg::{Csr, Symmetric};
use crate::platform::memory::{copied, filled, headroom, reserved, zeros};

/// Bytes per product of two entries of a row, and per row and column, while their lists grow.
const PER_PRODUCT: usize = 24;
const PER_ROW: usize = 24;

/// Positions of the products of the entries of each row: the pattern is found once, values are computed for any weights.
pub struct Gram {
    pattern: Symmetric,
    /// Kind of each row: rows of one kind have entries in the same columns, like the rows that glue two pieces.
    kind: Vec<u32>,
    /// Per kind: positions in the pattern of its products (k, l), l <= k.
    ptr: Vec<usize>,
    position: Vec<u32>,
}

impl Gram {
    /// `rows`: m x r; the Gram matrix is r x r with a complete diagonal.
    pub fn of(rows: &Csr) -> Result<Self> {
        let (kind, kinds) = kinds(rows)?;
        let products = kinds.ptr.windows(2).map(|row| (row[1] - row[0]).pow(2)).sum::<usize>();
        let lists = products.saturating_mul(PER_PRODUCT);
        let _room = headroom(lists.saturating_add((kinds.rows() + kinds.cols) * PER_ROW), "a Gram matrix")?;
        let by_column = kinds.transposed()?;
        let pattern = pattern(&kinds, &by_column)?;
        let mut ptr = vec![0];
        for row in kinds.ptr.windows(2) {
            let entries = row[1] - row[0];
            ptr.push(ptr[ptr.len() - 1] + entries * (entries + 1) / 2);
        }
        let position = positions(&kinds, &by_column, &pattern, &ptr)?;
        Ok(Self { pattern, kind, ptr, position })
    }

    pub fn pattern(&self) -> &Symmetric {
        &self.pattern
    }

    /// The sum over the rows not in `leave_out`, each with weight 1.
    pub fn sum(&self, rows: &Csr, leave_out: &[bool]) -> Result<Symmetric> {
        self.sum_of(rows, (0..rows.rows()).filter(|&i| !leave_out[i]))
    }

    /// The sum over some rows, each with weight 1.
    pub fn sum_of(&self, rows: &Csr, some: impl Iterator<Item = usize>) -> Result<Symmetric> {
        self.of_rows(rows, some.map(|i| (i, 1.0)))
    }

    /// `sum_i w_i g_i' g_i`
    pub fn weighted(&self, rows: &Csr, weight: impl Fn(usize) -> f64) -> Result<Symmetric> {
        self.of_rows(rows, (0..rows.rows()).map(|i| (i, weight(i))).filter(|(_, w)| *w != 0.0))
    }

    fn of_rows(&self, rows: &Csr, weighted: impl Iterator<Item = (usize, f64)>) -> Result<Symmetric> {
        let mut val = zeros(self.pattern.val.len(), "a Gram matrix")?;
        for (i, w) in weighted {
            let mut at = self.ptr[self.kind[i] as usize];
            for (k, a) in rows.row(i) {
                for (_, b) in rows.row(i).take_while(|(l, _)| *l <= k) {
                    val[self.position[at] as usize] += w * a * b;
                    at += 1;
                }
            }
        }
        let (ptr, col) =
            (copied(&self.pattern.ptr, "a Gram matrix")?, copied(&self.pattern.col, "a Gram matrix")?);
        Ok(Symmetric::new(ptr, col, val))
    }
}

/// The kind of every row, and the columns of one row of each kind, in the order of first appearance.
fn kinds(rows: &Csr) -> Result<(Vec<u32>, Csr)> {
    const WHAT: &str = "a Gram matrix";
    let columns = |i: usize| &rows.col[rows.ptr[i]..rows.ptr[i + 1]];
    let _room = headroom((PER_ROW + size_of::<usize>() + size_of::<u32>()) * rows.rows(), WHAT)?;
    let mut kind: Vec<u32> = Vec::with_capacity(rows.rows());
    let mut first = Vec::new();
    let mut known: HashMap<&[usize], u32> = HashMap::new();
    for i in 0..rows.rows() {
        // rows of one face of a piece are often consecutive
        let before = i.checked_sub(1).filter(|&before| columns(before) == columns(i)).map(|at| kind[at]);
        kind.push(before.unwrap_or_else(|| {
            *known.entry(columns(i)).or_insert_with(|| {
                first.push(i);
                first.len() as u32 - 1
            })
        }));
    }
    let entries = first.iter().map(|&i| columns(i).len()).sum();
    let (mut ptr, mut col) = (reserved(first.len() + 1, WHAT)?, reserved(entries, WHAT)?);
    ptr.push(0);
    for i in first {
        col.extend_from_slice(columns(i));
        ptr.push(col.len());
    }
    Ok((kind, Csr { cols: rows.cols, ptr, val: zeros(col.len(), WHAT)?, col }))
}

/// Lower triangle of the columns that occur together in some row, with zeros.
fn pattern(rows: &Csr, by_column: &Csr) -> Result<Symmetric> {
    let (mut ptr, mut col, mut seen) = (vec![0], Vec::new(), vec![usize::MAX; rows.cols]);
    for k in 0..rows.cols {
        let start = col.len();
        seen[k] = k;
        for (i, _) in by_column.row(k) {
            for (l, _) in rows.row(i).take_while(|(l, _)| *l < k) {
                if seen[l] != k {
                    seen[l] = k;
                    col.push(l as u32);
                }
            }
        }
        col[start..].sort_unstable();
        col.push(k as u32);
        ptr.push(col.len());
    }
    let val = zeros(col.len(), "a Gram matrix")?;
    Ok(Symmetric::new(ptr, col, val))
}

/// Positions of the products of the entries of each row, column by column: the row of the pattern is expanded once for
/// all rows with an entry in the column.
fn positions(rows: &Csr, by_column: &Csr, pattern: &Symmetric, ptr: &[usize]) -> Result<Vec<u32>> {
    let mut position = filled(ptr[rows.rows()], 0, "a Gram matrix")?;
    // position of a column in the present row of the pattern; number of processed entries of each row
    let (mut place, mut done) = (vec![0; rows.cols], vec![0; rows.rows()]);
    for k in 0..rows.cols {
        (pattern.ptr[k]..pattern.ptr[k + 1]).for_each(|at| place[pattern.col[at] as usize] = at as u32);
        for (i, _) in by_column.row(k) {
            let first = ptr[i] + done[i] * (done[i] + 1) / 2;
            done[i] += 1;
            let columns = rows.row(i).map(|(l, _)| l).take(done[i]);
            columns.zip(&mut position[first..]).for_each(|(l, at)| *at = place[l]);
        }
    }
    Ok(position)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gram_matrix_of_some_rows_equals_the_one_by_hand() {
        let mut rows = Csr::empty(3);
        rows.push_row([(0, 1.0), (2, 2.0)]);
        rows.push_row([(1, 3.0)]);
        rows.push_row([(0, -1.0), (2, 1.0)]);
        let gram = Gram::of(&rows).unwrap();
        let sum = gram.sum(&rows, &[false, true, false]).unwrap();
        assert_eq!((sum.ptr, sum.col.to_vec()), (vec![0, 1, 2, 4], vec![0, 1, 0, 2]));
        assert_eq!(sum.val, [2.0, 0.0, 1.0, 5.0]);
    }
}
