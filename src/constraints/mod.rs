//! Contact rows `B u <= c` and equality rows `H u = h`: the host's entries over the unknowns of all bodies
//! one after the other, and the scaling of the rows.

mod grouping;

pub use grouping::Grouping;

use crate::error::{Error, Kind, Result};
use crate::linalg::memory::{copied, zeros};
use crate::linalg::vector::first_non_finite;
use crate::linalg::Csr;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowKind {
    /// `B u <= c`, multipliers lambda >= 0.
    Inequality,
    /// `H u = h`, multipliers mu of any sign.
    Equality,
}

/// Rows as they arrived, counting from 0; without `body` the dofs count through all bodies.
#[derive(Debug, Clone, Copy)]
pub struct RowsInput<'a> {
    pub ptr: &'a [usize],
    pub body: Option<&'a [i64]>,
    pub dof: &'a [i64],
    pub val: &'a [f64],
    /// c or h, length; zeros when absent.
    pub rhs: Option<&'a [f64]>,
}

/// All rows of one kind.
#[derive(Debug, Clone)]
pub struct RowSet {
    /// m x (unknowns of all bodies); no unit.
    pub matrix: Csr,
    /// c or h, length.
    pub rhs: Vec<f64>,
}

impl Default for RowSet {
    fn default() -> Self {
        Self { matrix: Csr::empty(0), rhs: Vec::new() }
    }
}

impl RowSet {
    pub fn len(&self) -> usize {
        self.rhs.len()
    }

    /// Appends rows to those of bodies that begin at `offsets` (one more than bodies: the last is their end);
    /// repeated entries of a row are added up. Returns the number of the first. Nothing is kept on an error.
    pub fn add(&mut self, input: RowsInput<'_>, offsets: &[usize]) -> Result<usize> {
        let rows = input.ptr.len() - 1;
        if let Some(at) = first_non_finite(input.val) {
            let row = input.ptr.partition_point(|&p| p <= at) - 1;
            return Err(Error::argument("val", "the entry is not a finite number").row(row).entry(at));
        }
        let rhs = match input.rhs {
            Some(rhs) => copied(rhs, "constraint rows")?,
            None => zeros(rows, "constraint rows")?,
        };
        check_rhs(&rhs)?;
        let mut added = Csr::empty(0);
        for i in 0..rows {
            let mut entries = Vec::with_capacity(input.ptr[i + 1] - input.ptr[i]);
            for at in input.ptr[i]..input.ptr[i + 1] {
                entries.push((unknown(input, at, offsets).map_err(|e| e.row(i).entry(at))?, input.val[at]));
            }
            entries.sort_by_key(|entry| entry.0);
            entries.dedup_by(|next, kept| {
                let same = next.0 == kept.0;
                kept.1 += if same { next.1 } else { 0.0 };
                same
            });
            entries.retain(|entry| entry.1 != 0.0);
            added.push_row(entries);
        }
        let first = self.len();
        (0..rows).for_each(|i| self.matrix.push_row(added.row(i)));
        self.matrix.cols = offsets.last().copied().unwrap_or(0);
        self.rhs.extend(rhs);
        Ok(first)
    }

    pub fn set_rhs(&mut self, first: usize, rhs: &[f64]) -> Result<()> {
        check_rhs(rhs)?;
        let target = first.checked_add(rhs.len()).and_then(|end| self.rhs.get_mut(first..end));
        match target {
            Some(target) => target.copy_from_slice(rhs),
            None => {
                let what = format!("the rows end at {}", self.len());
                return Err(Error::argument("first", what).value((first + rhs.len()) as f64));
            }
        }
        Ok(())
    }

    /// A row without entries constrains nothing: it must hold by itself. Its multiplier is 0.
    pub fn check_empty_rows(&self, kind: RowKind) -> Result<()> {
        let empty = |i: usize| self.matrix.ptr[i] == self.matrix.ptr[i + 1];
        let fails = |i: usize| match kind {
            RowKind::Inequality => self.rhs[i] < 0.0,
            RowKind::Equality => self.rhs[i] != 0.0,
        };
        match (0..self.len()).find(|&i| empty(i) && fails(i)) {
            Some(i) => Err(Error::new(Kind::GapsContradict, format!("this {} has no entries", kind.name()))
                .row(i)
                .value(self.rhs[i])
                .limit(0.0)),
            None => Ok(()),
        }
    }
}

impl RowKind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Inequality => "contact row",
            Self::Equality => "equality row",
        }
    }
}

fn check_rhs(rhs: &[f64]) -> Result<()> {
    first_non_finite(rhs).map_or(Ok(()), |at| {
        Err(Error::argument("rhs", "the entry is not a finite number").row(at).entry(at))
    })
}

/// Number among all unknowns of entry `at`.
fn unknown(input: RowsInput<'_>, at: usize, offsets: &[usize]) -> Result<usize> {
    let bodies = offsets.len() - 1;
    let (start, end) = match input.body {
        None => (0, offsets[bodies]),
        Some(body) => {
            let body = usize::try_from(body[at]).ok().filter(|&b| b < bodies).ok_or_else(|| {
                Error::argument("body", format!("there are {bodies} bodies")).value(body[at] as f64)
            })?;
            (offsets[body], offsets[body + 1])
        }
    };
    let dof = usize::try_from(input.dof[at]).ok().filter(|&dof| dof < end - start).ok_or_else(|| {
        let what = format!("the dof is outside the {} unknowns", end - start);
        Error::argument("dof", what).value(input.dof[at] as f64)
    })?;
    Ok(start + dof)
}

/// `s_i = (b_i D^-1 b_i')^-1/2`: with lambda = S mu every row of the dual has the same weight, whatever the
/// stiffness of the bodies it joins. 0 for a row without entries.
pub fn row_scales(matrix: &Csr, metric: &[f64]) -> Vec<f64> {
    (0..matrix.rows())
        .map(|i| matrix.row(i).map(|(j, v)| v * v / metric[j]).sum::<f64>())
        .map(|square| if square > 0.0 { square.sqrt().recip() } else { 0.0 })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input<'a>(body: Option<&'a [i64]>, dof: &'a [i64], val: &'a [f64]) -> RowsInput<'a> {
        RowsInput { ptr: &[0, 3], body, dof, val, rhs: None }
    }

    #[test]
    fn repeated_entries_of_a_row_are_added_up() {
        let mut rows = RowSet::default();
        assert_eq!(rows.add(input(Some(&[1, 0, 1]), &[2, 0, 2], &[1.0, 4.0, 2.0]), &[0, 3, 6]).unwrap(), 0);
        assert_eq!(rows.matrix.row(0).collect::<Vec<_>>(), [(0, 4.0), (5, 3.0)]);
        assert_eq!(rows.add(input(None, &[5, 5, 1], &[1.0, -1.0, 2.0]), &[0, 3, 6]).unwrap(), 1);
        assert_eq!(rows.matrix.row(1).collect::<Vec<_>>(), [(1, 2.0)]);
    }

    #[test]
    fn a_refused_row_leaves_nothing_behind() {
        let mut rows = RowSet::default();
        let error = rows.add(input(Some(&[0, 1, 2]), &[0, 0, 0], &[1.0; 3]), &[0, 3, 6]).unwrap_err();
        assert_eq!(
            (error.kind, error.place.row, error.place.entry),
            (Kind::Argument("body"), Some(0), Some(2))
        );
        let error = rows.add(input(Some(&[0, 1, 1]), &[0, 3, 0], &[1.0; 3]), &[0, 3, 6]).unwrap_err();
        assert_eq!((error.kind, error.place.entry), (Kind::Argument("dof"), Some(1)));
        assert_eq!(rows.len(), 0);
    }

    #[test]
    fn an_empty_row_is_refused_only_where_it_cannot_hold() {
        let mut rows = RowSet::default();
        let empty = |rhs| RowsInput { ptr: &[0, 0], body: None, dof: &[], val: &[], rhs: Some(rhs) };
        rows.add(empty(&[1.0]), &[0, 3]).unwrap();
        assert!(rows.check_empty_rows(RowKind::Inequality).is_ok());
        rows.add(empty(&[-1.0]), &[0, 3]).unwrap();
        let error = rows.check_empty_rows(RowKind::Inequality).unwrap_err();
        assert_eq!((error.kind, error.place.row), (Kind::GapsContradict, Some(1)));
    }

    #[test]
    fn a_row_between_a_soft_and_a_stiff_body_weighs_as_the_soft_one() {
        let mut matrix = Csr::empty(2);
        matrix.push_row([(0, 1.0), (1, -1.0)]);
        let s = row_scales(&matrix, &[4.0, 4e12]);
        assert!((s[0] - 2.0).abs() < 1e-11);
    }
}
