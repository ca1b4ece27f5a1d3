//! Matrices by triplets of row, column and value in any order: values at one place are added.

use crate::body::stiffness::{check_order, from_sparse};
use crate::body::storage::{SparseInput, Storage};
use crate::body::values::Places;
use crate::error::{Error, Result, INDEX};
use crate::linalg::sparse::csr::by_columns;
use crate::linalg::vector::first_non_finite;
use crate::linalg::Symmetric;
use crate::platform::memory::{filled, reserved, zeros};

const WHAT: &str = "the triplets of a stiffness matrix";

/// A matrix by triplets as given: equally many rows, columns and values; rows and columns count from 0.
#[derive(Debug, Clone, Copy)]
pub struct TripletInput<'a> {
    pub row: &'a [i64],
    pub col: &'a [i64],
    pub val: &'a [f64],
    pub storage: Storage,
}

/// Where the values of triplets are added.
#[derive(Debug, PartialEq)]
pub struct Triplets {
    /// For each triplet the position of its entry in the sorted rows.
    entry: Vec<usize>,
    places: Places,
}

impl Triplets {
    /// The places of the triplets in the matrix of order n, and the matrix.
    pub fn of(n: usize, input: TripletInput<'_>, tolerance: f64) -> Result<(Self, Symmetric)> {
        check_order(n)?;
        let counts = [input.row.len(), input.col.len(), input.val.len()];
        if counts != [input.val.len(); 3] {
            let what = format!("{} rows, {} columns and {} values", counts[0], counts[1], counts[2]);
            return Err(Error::argument("nnz", what));
        }
        check_finite(input.val)?;
        (0..input.val.len()).try_for_each(|at| check_place(n, &input, at))?;
        let (ptr, col, entry) = sorted(n, &input)?;
        let val = summed(&entry, col.len(), input.val)?;
        let rows = SparseInput { ptr: &ptr, col: &col, val: &val, storage: input.storage };
        let k = from_sparse(rows, tolerance)?;
        let places = Places::of(rows, false, &k)?;
        Ok((Self { entry, places }, k))
    }

    /// Number of triplets.
    pub fn entries(&self) -> usize {
        self.entry.len()
    }

    /// The new values of `k`.
    pub fn values(&self, k: &Symmetric, val: &[f64], tolerance: f64) -> Result<Vec<f64>> {
        check_finite(val)?;
        let val = summed(&self.entry, self.places.entries(), val)?;
        self.places.values(k, &[], &val, tolerance)
    }
}

/// The rows of the triplets, columns ascending, every place once: start of each row, columns, position of each triplet.
fn sorted(n: usize, input: &TripletInput<'_>) -> Result<(Vec<usize>, Vec<i64>, Vec<usize>)> {
    let by_col = || (0..input.val.len()).map(|at| (at, input.col[at] as usize, 0.0));
    let (_, by_col, _) = by_columns(n, by_col, WHAT)?;
    let by_row = || by_col.iter().map(|&at| (at, input.row[at] as usize, 0.0));
    let (start, order, _) = by_columns(n, by_row, WHAT)?;
    let (mut ptr, mut col) = (reserved(n + 1, WHAT)?, reserved(order.len(), WHAT)?);
    let mut entry = filled(order.len(), 0, WHAT)?;
    ptr.push(0);
    for range in start.windows(2).map(|pair| pair[0]..pair[1]) {
        let first = col.len();
        for &at in &order[range] {
            if col.len() == first || col.last() != Some(&input.col[at]) {
                col.push(input.col[at]);
            }
            entry[at] = col.len() - 1;
        }
        ptr.push(col.len());
    }
    Ok((ptr, col, entry))
}

/// The sums of values with the same entry, in the order of the triplets.
fn summed(entry: &[usize], entries: usize, val: &[f64]) -> Result<Vec<f64>> {
    let mut sums = zeros(entries, WHAT)?;
    entry.iter().zip(val).for_each(|(&of, v)| sums[of] += v);
    let Some(of) = first_non_finite(&sums) else { return Ok(sums) };
    let error = Error::argument("val", "the sum of the entries at this place is not a finite number");
    Err(match entry.iter().rposition(|e| *e == of) {
        Some(at) => error.entry(at),
        None => error,
    })
}

fn check_finite(val: &[f64]) -> Result<()> {
    match first_non_finite(val) {
        None => Ok(()),
        Some(at) => Err(Error::argument("val", "the entry is not a finite number").entry(at)),
    }
}

fn check_place(n: usize, input: &TripletInput<'_>, at: usize) -> Result<()> {
    let (row, col) = (input.row[at], input.col[at]);
    for (name, what, index) in [("row", "row", row), ("col", "column", col)] {
        if !usize::try_from(index).is_ok_and(|index| index < n) {
            let what = format!("{what} {INDEX} is outside the {n} unknowns of the body");
            return Err(Error::argument(name, what).entry(at).index(index));
        }
    }
    let what = match input.storage {
        Storage::Lower if col > row => "the entry lies above the diagonal, in a matrix announced as lower",
        Storage::Upper if col < row => "the entry lies below the diagonal, in a matrix announced as upper",
        _ => return Ok(()),
    };
    Err(Error::argument("col", what).row(row as usize).dof(col as usize).entry(at))
}
