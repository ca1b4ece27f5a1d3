//! New values for a matrix whose pattern is known: the position of each value, and the checks of the first input.

use crate::body::stiffness::check_finite;
use crate::body::storage::{may_differ, unsymmetric, Shape, SparseInput, Storage};
use crate::error::{Error, Result};
use crate::linalg::vector::first_non_finite;
use crate::linalg::Symmetric;
use crate::platform::memory::{filled, reserved, zeros};

const WHAT: &str = "new values of a stiffness matrix";
/// Position of an entry that the host does not give.
const NONE: usize = usize::MAX;

/// Positions of the host's values in the lower triangle. If rows have ascending columns, with both sides of the diagonal
/// in full storage, the triangle itself determines the positions.
#[derive(Debug, PartialEq)]
pub struct Places {
    storage: Storage,
    /// Number of values.
    entries: usize,
    /// The diagonal is a separate array.
    apart: bool,
    /// Rows whose diagonal entry is not given, ascending.
    without: Vec<usize>,
    /// Positions for rows in any order.
    listed: Option<Listed>,
}

/// For every entry of the lower triangle, the position of its value.
#[derive(Debug, PartialEq)]
struct Listed {
    own: Vec<usize>,
    /// In full storage: position of the transposed entry; `NONE` for the diagonal.
    mate: Vec<usize>,
}

/// An entry of the lower triangle, and the positions of its values among those of the host.
struct GivenEntry {
    row: usize,
    col: usize,
    at: usize,
    own: usize,
    mate: usize,
}

impl Places {
    /// The positions for the matrix `k` made from `input`, with the diagonal `apart` or in its rows.
    pub fn of(input: SparseInput<'_>, apart: bool, k: &Symmetric) -> Result<Self> {
        let row = |i: usize| &input.col[input.ptr[i]..input.ptr[i + 1]];
        let (n, storage, entries) = (k.order(), input.storage, input.col.len());
        let ascending = (0..n).all(|i| row(i).windows(2).all(|pair| pair[0] < pair[1]));
        let given = |i: &usize| apart || row(*i).iter().any(|&j| j as usize == *i);
        let mut without = reserved(n - (0..n).filter(given).count(), WHAT)?;
        without.extend((0..n).filter(|i| !given(i)));
        let beside = if apart { entries } else { entries - (n - without.len()) };
        let paired = storage != Storage::Full || beside == 2 * (k.col.len() - n);
        let listed = if ascending && paired { None } else { Some(Listed::of(input, k)?) };
        Ok(Self { storage, entries, apart, without, listed })
    }

    /// The positions for rows that are those of the lower triangle `k`.
    pub fn of_lower(k: &Symmetric) -> Self {
        let (storage, entries) = (Storage::Lower, k.col.len());
        Self { storage, entries, apart: false, without: Vec::new(), listed: None }
    }

    /// Number of values, without those of a separate diagonal.
    pub fn entries(&self) -> usize {
        self.entries
    }

    /// True if the diagonal is a separate array.
    pub fn is_split(&self) -> bool {
        self.apart
    }

    /// The new values of `k` from those of the host; in full storage they are checked for symmetry and averaged. `diag`:
    /// the diagonal, if it is a separate array.
    pub fn values(&self, k: &Symmetric, diag: &[f64], val: &[f64], tolerance: f64) -> Result<Vec<f64>> {
        check_finite(diag, "diag", |at| at)?;
        if let Some(at) = first_non_finite(val) {
            let error = Error::argument("val", "the entry is not a finite number").entry(at);
            return Err(match self.row_of(k, at)? {
                Some(row) => error.row(row),
                None => error,
            });
        }
        let mut new = zeros(k.col.len(), WHAT)?;
        self.visit(k, |entry| new[entry.at] = value(val, entry.own))?;
        diag.iter().enumerate().for_each(|(i, v)| new[k.ptr[i + 1] - 1] = *v);
        if self.storage == Storage::Full {
            self.average(k, val, tolerance, &mut new)?;
        }
        Ok(new)
    }

    /// `(K + K')/2` for `new`, which contains the diagonal and the entries left of it.
    fn average(&self, k: &Symmetric, val: &[f64], tolerance: f64, new: &mut [f64]) -> Result<()> {
        let mut worst = None;
        self.visit(k, |GivenEntry { row, col, at, mate, .. }| {
            let (k_ij, k_ji) = (new[at], value(val, mate));
            if row == col || k_ij == k_ji {
                return;
            }
            let root = |i: usize| new[k.ptr[i + 1] - 1].abs().sqrt();
            let limit = may_differ(tolerance, root(row), root(col));
            if (k_ij - k_ji).abs() > limit && worst.is_none() {
                worst = Some((row, col, k_ij - k_ji, limit));
            }
            new[at] = 0.5 * k_ij + 0.5 * k_ji;
        })?;
        let Some((row, col, difference, limit)) = worst else { return Ok(()) };
        let lonely = self.lonely(k, val, row)? || self.lonely(k, val, col)?;
        let shape = if lonely { Shape::Lonely } else { Shape::Neither };
        Err(unsymmetric((shape, k.order()), (row, col), difference, limit))
    }

    /// Whether the host's row has only its diagonal entry.
    fn lonely(&self, k: &Symmetric, val: &[f64], row: usize) -> Result<bool> {
        let mut lonely = true;
        self.visit(k, |entry| {
            let beside = entry.row != entry.col;
            let own = beside && entry.row == row && value(val, entry.own) != 0.0;
            let mate = beside && entry.col == row && value(val, entry.mate) != 0.0;
            lonely &= !own && !mate;
        })?;
        Ok(lonely)
    }

    /// The host's row of value number `at`.
    fn row_of(&self, k: &Symmetric, at: usize) -> Result<Option<usize>> {
        let mut found = None;
        self.visit(k, |entry| {
            if entry.own == at {
                found = Some(if self.storage == Storage::Upper { entry.col } else { entry.row });
            } else if entry.mate == at {
                found = Some(entry.col);
            }
        })?;
        Ok(found)
    }

    /// Calls `visit` for every entry of the lower triangle, row by row.
    fn visit(&self, k: &Symmetric, mut visit: impl FnMut(GivenEntry)) -> Result<()> {
        if let Some(Listed { own, mate }) = &self.listed {
            for row in 0..k.order() {
                for at in k.ptr[row]..k.ptr[row + 1] {
                    let mate = mate.get(at).copied().unwrap_or(NONE);
                    visit(GivenEntry { row, col: k.col[at] as usize, at, own: own[at], mate });
                }
            }
            return Ok(());
        }
        // Row i of the triangle is read before later rows: the next value of row j < i of the host belongs to its entry
        // i.
        let mut next = self.starts(k)?;
        let mut take = |row: usize| {
            next[row] += 1;
            next[row] - 1
        };
        let mut without = self.without.iter().copied().peekable();
        for row in 0..k.order() {
            let diagonal = k.ptr[row + 1] - 1;
            for at in k.ptr[row]..diagonal {
                let col = k.col[at] as usize;
                let (own, mate) = match self.storage {
                    Storage::Lower => (take(row), NONE),
                    Storage::Upper => (take(col), NONE),
                    Storage::Full => (take(row), take(col)),
                };
                visit(GivenEntry { row, col, at, own, mate });
            }
            let given = without.next_if_eq(&row).is_none() && !self.apart;
            let own = if given { take(row) } else { NONE };
            visit(GivenEntry { row, col: row, at: diagonal, own, mate: NONE });
        }
        Ok(())
    }

    /// Position of the first value of every row of the host, for ascending columns.
    fn starts(&self, k: &Symmetric) -> Result<Vec<usize>> {
        let mut starts = filled(k.order() + 1, 0, WHAT)?;
        for i in 0..k.order() {
            starts[i + 1] += usize::from(!self.apart);
            for &j in &k.col[k.ptr[i]..k.ptr[i + 1] - 1] {
                starts[i + 1] += usize::from(self.storage != Storage::Upper);
                starts[j as usize + 1] += usize::from(self.storage != Storage::Lower);
            }
        }
        self.without.iter().for_each(|&i| starts[i + 1] -= 1);
        (0..k.order()).for_each(|i| starts[i + 1] += starts[i]);
        Ok(starts)
    }
}

impl Listed {
    fn of(input: SparseInput<'_>, k: &Symmetric) -> Result<Self> {
        let full = input.storage == Storage::Full;
        let mut own = filled(k.col.len(), NONE, WHAT)?;
        let mut mate = filled(if full { k.col.len() } else { 0 }, NONE, WHAT)?;
        for i in 0..k.order() {
            for at in input.ptr[i]..input.ptr[i + 1] {
                let j = input.col[at] as usize;
                let (row, col) = (i.max(j), i.min(j));
                let place = k.ptr[row]
                    + k.col[k.ptr[row]..k.ptr[row + 1]].partition_point(|&other| (other as usize) < col);
                if full && j > i {
                    mate[place] = at;
                } else {
                    own[place] = at;
                }
            }
        }
        Ok(Self { own, mate })
    }
}

fn value(val: &[f64], at: usize) -> f64 {
    if at == NONE {
        0.0
    } else {
        val[at]
    }
}

#[cfg(test)]
mod tests;
