//! Matrices by their profile: column j of the upper triangle, from its first entry on, is row j of the lower triangle.

use std::iter::once;

use crate::body::stiffness::check_order;
use crate::error::{Error, Result};
use crate::linalg::vector::first_non_finite;
use crate::linalg::Symmetric;
use crate::platform::memory::{copied, zeros};

const WHAT: &str = "a stiffness matrix";

/// The order of the values of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// From the first entry of the column down to the diagonal.
    Down,
    /// From the diagonal up to the first entry of the column.
    Up,
}

/// A matrix by its profile as given: `ptr` has n + 1 nondecreasing entries from 0; column j has the values `ptr[j]..ptr[j + 1]`.
#[derive(Debug, Clone, Copy)]
pub struct SkylineInput<'a> {
    pub ptr: &'a [usize],
    pub val: &'a [f64],
    pub direction: Direction,
}

/// Where the values of a profile stand.
#[derive(Debug, PartialEq)]
pub struct Skyline {
    ptr: Vec<usize>,
    direction: Direction,
    /// The diagonal is a separate array.
    apart: bool,
    /// New values have given the matrix entries that it did not have.
    pub has_grown: bool,
}

impl Skyline {
    /// The profile of `input`, with the diagonal `diag` or in its columns, and its matrix: zeros beside the diagonal are not stored.
    pub fn of(input: SkylineInput<'_>, diag: Option<&[f64]>) -> Result<(Self, Symmetric)> {
        check_order(input.ptr.len() - 1)?;
        let entries = input.ptr[input.ptr.len() - 1];
        if input.val.len() != entries {
            let what = format!("the profile has {entries} values, not {}", input.val.len());
            return Err(Error::argument("val", what).value(input.val.len() as f64).limit(entries as f64));
        }
        check_heights(input.ptr, diag.is_some())?;
        check_values(input.ptr, diag.unwrap_or(&[]), input.val)?;
        let ptr = copied(input.ptr, "the profile of a stiffness matrix")?;
        let apart = diag.is_some();
        let profile = Self { ptr, direction: input.direction, apart, has_grown: false };
        let matrix = profile.matrix(diag.unwrap_or(&[]), input.val)?;
        Ok((profile, matrix))
    }

    /// Number of values, without those of a separate diagonal.
    pub fn entries(&self) -> usize {
        self.ptr[self.ptr.len() - 1]
    }

    /// True if the diagonal is a separate array.
    pub fn is_split(&self) -> bool {
        self.apart
    }

    /// The matrix of these values, which have been checked.
    pub fn matrix(&self, diag: &[f64], val: &[f64]) -> Result<Symmetric> {
        let rows = 0..self.ptr.len() - 1;
        let entries = rows.clone().map(|i| 1 + self.beside(i, val).count()).sum();
        let mut k = Symmetric::with_room(rows.len(), entries, WHAT)?;
        rows.for_each(|i| k.push_row(self.beside(i, val).chain(once((i, self.diagonal(i, diag, val))))));
        Ok(k)
    }

    /// The new values of `k`; an entry that has become 0 stays. None if an entry that `k` does not have is not 0 any more.
    pub fn values(&self, k: &Symmetric, diag: &[f64], val: &[f64]) -> Result<Option<Vec<f64>>> {
        check_values(&self.ptr, diag, val)?;
        let mut new = zeros(k.col.len(), "new values of a stiffness matrix")?;
        for i in 0..k.order() {
            let (mut at, diagonal) = (k.ptr[i], k.ptr[i + 1] - 1);
            for (j, v) in self.beside(i, val) {
                at += k.col[at..diagonal].partition_point(|&col| (col as usize) < j);
                if at == diagonal || k.col[at] as usize != j {
                    return Ok(None);
                }
                new[at] = v;
            }
            new[diagonal] = self.diagonal(i, diag, val);
        }
        Ok(Some(new))
    }

    /// Entries left of the diagonal in row i of the lower triangle that are not 0, columns ascending.
    fn beside<'a>(&'a self, i: usize, val: &'a [f64]) -> impl Iterator<Item = (usize, f64)> + 'a {
        let (start, end) = (self.ptr[i], self.ptr[i + 1]);
        let count = end - start - usize::from(!self.apart);
        let entries = (0..count).map(move |k| match self.direction {
            Direction::Down => (i - count + k, val[start + k]),
            Direction::Up => (i - count + k, val[end - 1 - k]),
        });
        entries.filter(|entry| entry.1 != 0.0)
    }

    fn diagonal(&self, i: usize, diag: &[f64], val: &[f64]) -> f64 {
        match self.direction {
            _ if self.apart => diag[i],
            Direction::Down => val[self.ptr[i + 1] - 1],
            Direction::Up => val[self.ptr[i]],
        }
    }
}

/// No column begins above the first row, and each has its diagonal entry, unless that is `apart`.
fn check_heights(ptr: &[usize], apart: bool) -> Result<()> {
    let own = usize::from(!apart);
    for (j, pair) in ptr.windows(2).enumerate() {
        let height = pair[1] - pair[0];
        let (what, limit) = if height < own {
            ("the column has no entry: a profile contains the diagonal".to_owned(), own)
        } else if height > j + own {
            (
                format!(
                    "the column has {height} entries, of which only {} lie in the upper triangle",
                    j + own
                ),
                j + own,
            )
        } else {
            continue;
        };
        return Err(Error::argument("ptr", what).dof(j).value(height as f64).limit(limit as f64));
    }
    Ok(())
}

fn check_values(ptr: &[usize], diag: &[f64], val: &[f64]) -> Result<()> {
    let bad = |name, at: usize, dof| {
        Err(Error::argument(name, "the entry is not a finite number").dof(dof).entry(at))
    };
    match (first_non_finite(diag), first_non_finite(val)) {
        (Some(at), _) => bad("diag", at, at),
        (None, Some(at)) => bad("val", at, ptr.partition_point(|&start| start <= at) - 1),
        (None, None) => Ok(()),
    }
}
