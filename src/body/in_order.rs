//! Matrices by rows of ascending columns; in full storage with entries on both sides of the diagonal. The lower triangle
//! is taken directly from the arrays of the host. All other input, valid or not, goes to [`stiffness`](super::stiffness).

use crate::body::storage::{may_differ, SparseInput, Storage};
use crate::error::Result;
use crate::linalg::Symmetric;
use crate::platform::memory::{copied, filled, reserved, zeros};

const WHAT: &str = "a stiffness matrix";

/// The lower triangle with every diagonal entry stored; `None` if the input does not have this form. `diag`: a separate
/// array of the diagonal.
pub fn lower_triangle(input: SparseInput, diag: Option<&[f64]>, tolerance: f64) -> Result<Option<Symmetric>> {
    match input.storage {
        Storage::Upper => by_columns(input, diag),
        _ => by_rows(input, diag, tolerance),
    }
}

/// Row i of the input.
struct InOrderRow<'a> {
    col: &'a [i64],
    val: &'a [f64],
    /// Number of entries left of the diagonal.
    left: usize,
    /// The diagonal is among the entries.
    given: bool,
    /// 0 if the diagonal entry is not given.
    diagonal: f64,
}

/// `None` if columns do not ascend, a number is out of range, or a diagonal entry occurs twice.
fn row<'a>(input: &SparseInput<'a>, diag: Option<&[f64]>, i: usize) -> Option<InOrderRow<'a>> {
    let (n, range) = (input.ptr.len() - 1, input.ptr[i]..input.ptr[i + 1]);
    let (col, val) = (input.col.get(range.clone())?, input.val.get(range)?);
    let left = col.partition_point(|&j| (j as usize) < i);
    let given = col.get(left).is_some_and(|&j| j as usize == i);
    let diagonal = diag.map_or(if given { val[left] } else { 0.0 }, |diag| diag[i]);
    let ascending = col.windows(2).all(|pair| pair[0] < pair[1]);
    let within = col.first().is_none_or(|&j| j >= 0) && col.last().is_none_or(|&j| (j as usize) < n);
    let once = !(given && diag.is_some()) && diagonal.is_finite();
    let of_this_form = ascending && within && once && val.iter().all(|v| v.is_finite());
    of_this_form.then_some(InOrderRow { col, val, left, given, diagonal })
}

/// Full or lower storage.
fn by_rows(input: SparseInput, diag: Option<&[f64]>, tolerance: f64) -> Result<Option<Symmetric>> {
    let (n, entries) = (input.ptr.len() - 1, input.val.len());
    let full = input.storage == Storage::Full;
    let stored = n + if full { entries / 2 } else { entries };
    let mut rows = LowerRows {
        input,
        diag,
        tolerance,
        lower: Symmetric::with_room(n, stored, WHAT)?,
        next: reserved(n, WHAT)?,
        root: reserved(n, WHAT)?,
    };
    let is_of_this_form = (0..n).all(|i| rows.take(i).is_some());
    let is_paired = rows.next.iter().zip(&input.ptr[1..]).all(|(next, end)| next == end);
    Ok((is_of_this_form && is_paired).then_some(rows.lower))
}

struct LowerRows<'a> {
    input: SparseInput<'a>,
    diag: Option<&'a [f64]>,
    tolerance: f64,
    lower: Symmetric,
    /// For each row processed: its first entry right of the diagonal that has not been compared with its transpose.
    next: Vec<usize>,
    /// `|K_ii|^1/2` of each row processed.
    root: Vec<f64>,
}

impl LowerRows<'_> {
    fn take(&mut self, i: usize) -> Option<()> {
        let row = row(&self.input, self.diag, i)?;
        self.root.push(row.diagonal.abs().sqrt());
        self.next.push(self.input.ptr[i] + row.left + usize::from(row.given));
        match self.input.storage {
            Storage::Full => self.take_with_mates(i, &row)?,
            _ => self.lower.val.to_mut().extend_from_slice(&row.val[..row.left]),
        }
        self.lower.col.to_mut().extend(row.col[..row.left].iter().map(|&j| j as u32));
        self.lower.col.push(i as u32);
        self.lower.val.push(row.diagonal);
        self.lower.ptr.push(self.lower.col.len());
        Some(())
    }

    /// Adds the values left of the diagonal, each averaged with its transpose, which is in column i of the rows processed
    /// before.
    fn take_with_mates(&mut self, i: usize, row: &InOrderRow) -> Option<()> {
        for (&j, &k_ij) in row.col[..row.left].iter().zip(row.val) {
            let j = j as usize;
            let mate = self.next[j];
            if mate == self.input.ptr[j + 1] || self.input.col[mate] != i as i64 {
                return None;
            }
            self.next[j] += 1;
            let k_ji = self.input.val[mate];
            if k_ij != k_ji && (k_ij - k_ji).abs() > may_differ(self.tolerance, self.root[i], self.root[j]) {
                return None;
            }
            self.lower.val.push(if k_ij == k_ji { k_ij } else { 0.5 * k_ij + 0.5 * k_ji });
        }
        Some(())
    }
}

/// Upper storage: its columns are the rows of the lower triangle.
fn by_columns(input: SparseInput, diag: Option<&[f64]>) -> Result<Option<Symmetric>> {
    let n = input.ptr.len() - 1;
    let mut ptr = filled(n + 1, 0_usize, WHAT)?;
    for i in 0..n {
        let Some(row) = row(&input, diag, i).filter(|row| row.left == 0) else { return Ok(None) };
        row.col.iter().for_each(|&j| ptr[j as usize + 1] += 1);
        ptr[i + 1] += usize::from(!row.given);
    }
    (0..n).for_each(|j| ptr[j + 1] += ptr[j]);
    let mut next = copied(&ptr[..n], WHAT)?;
    let (mut col, mut val) = (filled(ptr[n], 0, WHAT)?, zeros(ptr[n], WHAT)?);
    for i in 0..n {
        // rows before i have filled row i of the lower triangle up to its diagonal
        (col[next[i]], val[next[i]]) = (i as u32, diag.map_or(0.0, |diag| diag[i]));
        for at in input.ptr[i]..input.ptr[i + 1] {
            let place = &mut next[input.col[at] as usize];
            (col[*place], val[*place]) = (i as u32, input.val[at]);
            *place += 1;
        }
    }
    Ok(Some(Symmetric::new(ptr, col, val)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::from_sparse;

    /// Rows of a matrix of order 40 with about 6 entries left of the diagonal; entries above are 1 + 1e-13 times those
    /// below, some diagonal entries are not stored, and rows in `turned` have descending columns.
    fn rows(storage: Storage, turned: impl Fn(usize) -> bool) -> (Vec<usize>, Vec<i64>, Vec<f64>) {
        let coupled = |i: usize, j: usize| (3 * i + 7 * j) % 6 == 1 && i % 9 != 4 && j % 9 != 4;
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..40 {
            let mut row: Vec<(i64, f64)> = Vec::new();
            for j in 0..40 {
                let (low, high) = (i.min(j), i.max(j));
                let wanted = match storage {
                    Storage::Full => true,
                    Storage::Lower => j <= i,
                    Storage::Upper => j >= i,
                };
                let value = 1.0 + (low as f64).sin() * (high as f64).cos();
                if wanted && (coupled(high, low) && i != j || i == j && i % 9 != 4) {
                    row.push((
                        j as i64,
                        if i == j { 50.0 } else { value * (1.0 + f64::from(j > i) * 1e-13) },
                    ));
                }
            }
            if turned(i) {
                row.reverse();
            }
            col.extend(row.iter().map(|entry| entry.0));
            val.extend(row.iter().map(|entry| entry.1));
            ptr.push(col.len());
        }
        (ptr, col, val)
    }

    #[test]
    fn rows_in_order_and_out_of_order_give_the_same_matrix() {
        for storage in [Storage::Full, Storage::Lower, Storage::Upper] {
            let matrix = |turned: bool| {
                let (ptr, col, val) = rows(storage, |i| turned && i == 37);
                let input = SparseInput { ptr: &ptr, col: &col, val: &val, storage };
                assert_eq!(lower_triangle(input, None, 1e-10).unwrap().is_none(), turned, "{storage:?}");
                from_sparse(input, 1e-10).unwrap()
            };
            let in_order = matrix(false);
            assert!(in_order.col.len() > 100 && in_order.diagonal(4) == 0.0);
            assert_eq!(in_order, matrix(true), "{storage:?}");
        }
    }

    /// An entry whose transpose is not stored or too different, and entries on the wrong side.
    #[test]
    fn what_is_not_symmetric_is_left_to_the_check_of_it() {
        let (ptr, col, val) = rows(Storage::Full, |_| false);
        let input = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Full };
        assert!(lower_triangle(input, None, 1e-16).unwrap().is_none());
        for storage in [Storage::Lower, Storage::Upper] {
            assert!(lower_triangle(SparseInput { storage, ..input }, None, 1e-10).unwrap().is_none());
        }
        for gone in 0..col.len() {
            let row = ptr.partition_point(|&p| p <= gone) - 1;
            let ptr: Vec<usize> = ptr.iter().enumerate().map(|(i, &p)| p - usize::from(i > row)).collect();
            let (mut col, mut val) = (col.clone(), val.clone());
            if col.remove(gone) == row as i64 {
                continue;
            }
            val.remove(gone);
            let input = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Full };
            assert!(lower_triangle(input, None, 1e-10).unwrap().is_none(), "{gone}");
        }
    }
}
