//! The host's stiffness matrix, checked and converted to one form: the lower triangle by sorted rows.

use crate::body::in_order::lower_triangle;
use crate::body::storage::{may_differ, unsymmetric, Shape, SparseInput, Storage};
use crate::error::{Error, Kind, Result, INDEX};
use crate::linalg::vector::first_non_finite;
use crate::linalg::{Csr, Symmetric};
use crate::platform::memory::{headroom, reserved};

/// Bytes of temporary row pointers and diagonals in the conversion of a matrix, per row.
const PER_ROW: usize = 96;

/// Checks and converts a sparse matrix. Full storage is accepted when
/// `|K_ij - K_ji| <= tolerance (K_ii K_jj)^1/2`, and averaged.
pub fn from_sparse(input: SparseInput<'_>, tolerance: f64) -> Result<Symmetric> {
    from_rows(input, None, tolerance)
}

/// As `from_sparse`, for a matrix with a separate array `diag` of the diagonal, length n; `input` has the off-diagonal
/// entries.
pub fn from_split(input: SparseInput<'_>, diag: &[f64], tolerance: f64) -> Result<Symmetric> {
    from_rows(input, Some(diag), tolerance)
}

fn from_rows(input: SparseInput<'_>, diag: Option<&[f64]>, tolerance: f64) -> Result<Symmetric> {
    check_order(input.ptr.len() - 1)?;
    let _room = headroom(input.ptr.len() * PER_ROW, "a stiffness matrix")?;
    match lower_triangle(input, diag, tolerance)? {
        Some(lower) => Ok(lower),
        None => with_diagonal(lower_of(sorted(input, diag)?, input.storage, tolerance)?),
    }
}

/// The lower triangle of sorted rows.
fn lower_of(rows: Csr, storage: Storage, tolerance: f64) -> Result<Csr> {
    match storage {
        Storage::Lower => Ok(rows),
        Storage::Upper => rows.transposed(),
        Storage::Full => averaged(&rows, tolerance),
    }
}

/// Checks and converts a column-major n x n matrix with leading dimension `ld`; zeros are not stored.
pub fn from_dense(n: usize, k: &[f64], ld: usize, storage: Storage, tolerance: f64) -> Result<Symmetric> {
    check_order(n)?;
    let _room = headroom(n * PER_ROW, "a stiffness matrix")?;
    let mut rows = Csr::empty(n);
    let stored = |i: usize| match storage {
        Storage::Full => 0..n,
        Storage::Lower => 0..i + 1,
        Storage::Upper => i..n,
    };
    let used = |i: usize| stored(i).filter(|&j| k[i + ld * j] != 0.0 || i == j).count();
    reserve(&mut rows, (0..n).map(used).sum())?;
    for i in 0..n {
        let range = stored(i);
        for j in range.clone() {
            let value = k[i + ld * j];
            if !value.is_finite() {
                return Err(Error::argument("k", "the entry is not a finite number")
                    .row(i)
                    .entry(i + ld * j));
            }
        }
        let kept = range.map(|j| (j, k[i + ld * j])).filter(|&(j, v)| v != 0.0 || i == j);
        rows.push_row(kept);
    }
    with_diagonal(lower_of(rows, storage, tolerance).map_err(|e| rename(e, "k"))?)
}

/// Checks that columns fit into 32 bits.
pub(super) fn check_order(n: usize) -> Result<()> {
    let limit = u32::MAX as usize;
    if n <= limit {
        return Ok(());
    }
    let what = format!("a body of {n} unknowns has more than {limit}");
    Err(Error::new(Kind::Overflow, what).value(n as f64).limit(limit as f64))
}

/// Reserves room for the entries of an empty matrix.
fn reserve(rows: &mut Csr, entries: usize) -> Result<()> {
    rows.col = reserved(entries, "a stiffness matrix")?;
    rows.val = reserved(entries, "a stiffness matrix")?;
    Ok(())
}

fn rename(mut error: Error, argument: &'static str) -> Error {
    if matches!(error.kind, Kind::Argument(_)) {
        error.kind = Kind::Argument(argument);
    }
    error
}

/// The rows with ascending columns; refuses columns out of range, repeated entries and values not finite.
fn sorted(input: SparseInput<'_>, diag: Option<&[f64]>) -> Result<Csr> {
    let n = input.ptr.len() - 1;
    check_finite(diag.unwrap_or(&[]), "diag", |at| at)?;
    check_finite(input.val, "val", |at| input.ptr.partition_point(|&p| p <= at) - 1)?;
    let mut rows = Csr::empty(n);
    reserve(&mut rows, input.col.len() + diag.map_or(0, <[f64]>::len))?;
    let mut row = Vec::new();
    for i in 0..n {
        row.clear();
        for at in input.ptr[i]..input.ptr[i + 1] {
            row.push((column(&input, diag.is_some(), i, at)?, input.val[at], at));
        }
        row.extend(diag.map(|diag| (i, diag[i], 0)));
        row.sort_unstable_by_key(|entry| entry.0);
        if let Some(pair) = row.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            let at = pair[0].2.max(pair[1].2);
            return Err(Error::argument("col", "the row contains this column twice").row(i).entry(at));
        }
        rows.push_row(row.iter().map(|entry| (entry.0, entry.1)));
    }
    Ok(rows)
}

/// `row_of` gives the row of an entry.
pub fn check_finite(values: &[f64], name: &'static str, row_of: impl FnOnce(usize) -> usize) -> Result<()> {
    match first_non_finite(values) {
        None => Ok(()),
        Some(at) => Err(Error::argument(name, "the entry is not a finite number").row(row_of(at)).entry(at)),
    }
}

/// The column of entry `at` of row `i`; `split`: no entry may be on the diagonal.
fn column(input: &SparseInput<'_>, split: bool, i: usize, at: usize) -> Result<usize> {
    let n = input.ptr.len() - 1;
    let col = usize::try_from(input.col[at]).ok().filter(|&col| col < n).ok_or_else(|| {
        Error::argument("col", format!("column {INDEX} is outside the {n} unknowns of the body"))
            .row(i)
            .entry(at)
            .index(input.col[at])
    })?;
    let refused = |what: String| Err(Error::argument("col", what).row(i).dof(col).entry(at));
    match outside(input.storage, i, col) {
        Some(side) => refused(format!("the column lies {side}")),
        None if split && col == i => {
            refused("the entry lies on the diagonal, which is given by a separate array".to_owned())
        }
        None => Ok(col),
    }
}

/// The side of the diagonal, if the entry is on the wrong side.
fn outside(storage: Storage, row: usize, col: usize) -> Option<&'static str> {
    match storage {
        Storage::Lower if col > row => Some("right of the diagonal, in a matrix announced as lower"),
        Storage::Upper if col < row => Some("left of the diagonal, in a matrix announced as upper"),
        _ => None,
    }
}

/// Lower triangle of `(K + K') / 2`, after a check of symmetry.
fn averaged(rows: &Csr, tolerance: f64) -> Result<Csr> {
    let transposed = rows.transposed()?;
    let n = rows.rows();
    let root: Vec<f64> = (0..n).map(|i| entry(rows, i, i).abs().sqrt()).collect();
    let mut lower = Csr::empty(n);
    reserve(&mut lower, rows.col.len())?;
    for i in 0..n {
        let mut mates = transposed.row(i).take_while(|&(j, _)| j <= i).peekable();
        let mut own = rows.row(i).take_while(|&(j, _)| j <= i).peekable();
        loop {
            let column = match (own.peek(), mates.peek()) {
                (None, None) => break,
                (a, b) => a.map_or(usize::MAX, |a| a.0).min(b.map_or(usize::MAX, |b| b.0)),
            };
            let k_ij = own.next_if(|e| e.0 == column).map_or(0.0, |e| e.1);
            let k_ji = mates.next_if(|e| e.0 == column).map_or(0.0, |e| e.1);
            let limit = may_differ(tolerance, root[i], root[column]);
            if (k_ij - k_ji).abs() > limit {
                return Err(unsymmetric((shape(rows, i, column), n), (i, column), k_ij - k_ji, limit));
            }
            lower.col.push(column);
            lower.val.push(if k_ij == k_ji { k_ij } else { 0.5 * k_ij + 0.5 * k_ji });
        }
        lower.ptr.push(lower.col.len());
    }
    Ok(lower)
}

/// What the rows may be if (i, j) is not symmetric.
fn shape(rows: &Csr, i: usize, j: usize) -> Shape {
    let none = |row: usize, is_there: fn(usize, usize) -> bool| {
        rows.row(row).all(|(col, v)| v == 0.0 || !is_there(row, col))
    };
    let nowhere = |is_there: fn(usize, usize) -> bool| (0..rows.rows()).all(|row| none(row, is_there));
    if nowhere(|row, col| col > row) {
        Shape::Triangle(Storage::Lower)
    } else if nowhere(|row, col| col < row) {
        Shape::Triangle(Storage::Upper)
    } else if none(i, |row, col| row != col) || none(j, |row, col| row != col) {
        Shape::Lonely
    } else {
        Shape::Neither
    }
}

fn entry(rows: &Csr, i: usize, j: usize) -> f64 {
    rows.row(i).find(|e| e.0 == j).map_or(0.0, |e| e.1)
}

/// The lower triangle with every diagonal entry stored.
fn with_diagonal(lower: Csr) -> Result<Symmetric> {
    let n = lower.rows();
    let mut k = Symmetric::with_room(n, lower.col.len() + n, "a stiffness matrix")?;
    for i in 0..n {
        let without = lower.row(i).last().is_none_or(|e| e.0 != i);
        k.push_row(lower.row(i).chain(without.then_some((i, 0.0))));
    }
    Ok(k)
}

/// A dof may have no stiffness at all (a rigid body); a diagonal entry that is negative, or that is zero in a row with
/// other entries, makes K indefinite, which only a body with soft motions may be.
pub fn check_diagonal(k: &Symmetric) -> Result<()> {
    let n = k.order();
    if (0..n).all(|i| k.diagonal(i) > 0.0) {
        return Ok(());
    }
    let coupled = |i: usize, j: usize, v: f64| i != j && v != 0.0;
    for i in 0..n {
        let lost = k.lower_row(i).find(|&(j, v)| coupled(i, j, v) && k.diagonal(i).min(k.diagonal(j)) <= 0.0);
        let dof = lost.map_or(i, |(j, _)| if k.diagonal(i) <= 0.0 { i } else { j });
        if lost.is_some() || k.diagonal(i) < 0.0 {
            let mut what =
                format!("the diagonal entry is {:.3e}: the stiffness matrix is indefinite", k.diagonal(dof));
            if k.diagonal(dof) == 0.0 {
                what.push_str(
                    "; a row with other entries than its diagonal is that of a Lagrange multiplier: its constraint is \
                     to be given as an equality row, without this unknown",
                );
            }
            return Err(Error::new(Kind::Indefinite, what).dof(dof).value(k.diagonal(dof)).limit(0.0));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PTR: [usize; 3] = [0, 2, 4];

    fn full(val: &[f64]) -> Result<Symmetric> {
        from_sparse(SparseInput { ptr: &PTR, col: &[1, 0, 0, 1], val, storage: Storage::Full }, 1e-10)
    }

    #[test]
    fn the_three_storages_give_the_same_matrix() {
        let expected = Symmetric::new(vec![0, 1, 3], vec![0, 0, 1], vec![2.0, -1.0, 3.0]);
        assert_eq!(full(&[-1.0, 2.0, -1.0, 3.0]).unwrap(), expected);
        let lower =
            SparseInput { ptr: &[0, 1, 3], col: &[0, 1, 0], val: &[2.0, 3.0, -1.0], storage: Storage::Lower };
        assert_eq!(from_sparse(lower, 0.0).unwrap(), expected);
        let upper =
            SparseInput { ptr: &[0, 2, 3], col: &[1, 0, 1], val: &[-1.0, 2.0, 3.0], storage: Storage::Upper };
        assert_eq!(from_sparse(upper, 0.0).unwrap(), expected);
        for storage in [Storage::Full, Storage::Lower, Storage::Upper] {
            let dense = from_dense(2, &[2.0, -1.0, 9.0, -1.0, 3.0], 3, storage, 0.0).unwrap();
            assert_eq!(dense, expected);
        }
    }

    #[test]
    fn more_unknowns_than_32_bits_count_are_refused() {
        assert!(check_order(u32::MAX as usize).is_ok());
        let error = check_order(1 << 32).unwrap_err();
        assert_eq!((error.kind, error.place.value), (Kind::Overflow, Some(4294967296.0)));
    }

    #[test]
    fn an_unsymmetric_matrix_is_refused_with_row_and_column() {
        let error = full(&[-1.0, 2.0, -1.1, 3.0]).unwrap_err();
        assert_eq!(error.kind, Kind::Argument("val"));
        assert_eq!((error.place.row, error.place.dof), (Some(1), Some(0)));
    }

    #[test]
    fn an_identity_row_with_a_full_column_gets_its_own_advice() {
        let error = full(&[-1.0, 2.0, 0.0, 1.0]).unwrap_err();
        assert!(error.what.contains("eliminate supports symmetrically"), "{error}");
        let chain = [1.0, -2.0, 0.0, 0.0, 4.0, -2.0, 0.0, -2.0, 4.0]; // by columns, unknown 0 supported in its row only
        let error = from_dense(3, &chain, 3, Storage::Full, 1e-10).unwrap_err();
        assert!(error.what.starts_with("an identity row"), "{error}");
    }

    #[test]
    fn a_triangle_given_as_a_full_matrix_is_told_its_storage() {
        let lower = [2.0, -1.0, 0.0, 0.0, 2.0, -1.0, 0.0, 0.0, 2.0]; // by columns
        let upper = [2.0, 0.0, 0.0, -1.0, 2.0, 0.0, 0.0, -1.0, 2.0];
        for (k, says, storage) in
            [(lower, "FETI_LOWER", Storage::Lower), (upper, "FETI_UPPER", Storage::Upper)]
        {
            let error = from_dense(3, &k, 3, Storage::Full, 1e-10).unwrap_err();
            assert!(error.what.contains(says) && !error.what.contains("support"), "{error}");
            assert!(from_dense(3, &k, 3, storage, 1e-10).is_ok());
        }
    }

    #[test]
    fn a_dof_may_lack_stiffness_but_not_couple_without_it() {
        let rigid = SparseInput { ptr: &[0, 0], col: &[], val: &[], storage: Storage::Full };
        assert_eq!(from_sparse(rigid, 0.0).unwrap().diagonal(0), 0.0);
        let error = check_diagonal(&full(&[-1.0, 2.0, -1.0, 0.0]).unwrap()).unwrap_err();
        assert_eq!((error.kind, error.place.dof), (Kind::Indefinite, Some(1)));
    }

    #[test]
    fn an_entry_in_the_wrong_triangle_is_refused_with_its_position() {
        let input = |storage| SparseInput { ptr: &PTR, col: &[0, 1, 0, 1], val: &[1.0; 4], storage };
        let above = from_sparse(input(Storage::Lower), 0.0).unwrap_err();
        assert_eq!(
            (above.kind, above.place.row, above.place.entry),
            (Kind::Argument("col"), Some(0), Some(1))
        );
        let below = from_sparse(input(Storage::Upper), 0.0).unwrap_err();
        assert_eq!((below.place.row, below.place.entry), (Some(1), Some(2)));
    }

    #[test]
    fn entries_out_of_range_twice_or_not_finite_are_refused_with_their_position() {
        let refuse = |col: &[i64], val: &[f64]| {
            from_sparse(SparseInput { ptr: &PTR, col, val, storage: Storage::Full }, 0.0).unwrap_err()
        };
        assert_eq!(refuse(&[0, 1, 0, 2], &[1.0; 4]).place.entry, Some(3));
        assert_eq!(refuse(&[0, -1, 0, 1], &[1.0; 4]).place.entry, Some(1));
        assert_eq!(refuse(&[0, 0, 0, 1], &[1.0; 4]).place.entry, Some(1));
        let nan = refuse(&[0, 1, 0, 1], &[1.0, 1.0, f64::NAN, 1.0]);
        assert_eq!((nan.kind, nan.place.row, nan.place.entry), (Kind::Argument("val"), Some(1), Some(2)));
    }
}
