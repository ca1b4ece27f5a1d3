//! Dual operators for new rows, made from previous ones: kept for the same rows. Where K+ is a function of the host, also
//! the entries F_p(i, j) of two rows that body p already had.

use std::iter::Sum;
use std::sync::{Arc, Mutex};

use crate::body::{GeneralizedInverse, HostMultiple};
use crate::dual::elsewhere::Form;
use crate::error::{Error, Kind, Result};
use crate::linalg::hash::{hash, START};
use crate::linalg::{Csr, Packed};

/// `F_p` and the rows of B over body p for which it was made, or, not assembled, would have been.
pub struct Kept {
    rows: Arc<Csr>,
    operator: Option<Form>,
}

/// Counts of the columns of dual operators, one for each row and body that it touches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ColumnCounts {
    pub computed: usize,
    pub kept: usize,
}

/// What the new rows of a body have in common with the previous ones.
pub(super) enum Reuse {
    /// All rows, in the same order.
    All(Mutex<Option<Box<Kept>>>, usize),
    /// Some rows, and every column costs the host a solution: for every new row its number among the previous ones.
    Some { kept: Box<Kept>, old: Vec<Option<usize>> },
    /// The whole operator, with this number of rows, is assembled: a column computed alone or beside other rows differs
    /// by rounding.
    Nothing(usize),
}

impl Kept {
    pub(super) fn new(rows: Arc<Csr>, operator: Option<Form>) -> Self {
        Self { rows, operator }
    }

    pub fn bytes(&self) -> usize {
        self.operator.as_ref().map_or(0, Form::bytes_kept)
    }

    pub(super) fn is_assembled(&self) -> bool {
        self.operator.is_some()
    }

    /// At least half of these rows are among its own.
    pub(super) fn has_most(&self, rows: &Csr) -> bool {
        2 * matched(&self.rows, rows).iter().flatten().count() >= rows.rows()
    }
}

impl Sum for ColumnCounts {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |a, b| Self { computed: a.computed + b.computed, kept: a.kept + b.kept })
    }
}

impl Reuse {
    pub fn of(kept: Option<Box<Kept>>, kplus: &GeneralizedInverse, rows: &Csr) -> Self {
        let m = rows.rows();
        let Some(kept) = kept.filter(|kept| kept.is_assembled()) else { return Self::Nothing(m) };
        let old = matched(&kept.rows, rows);
        if m == kept.rows.rows() && old.iter().enumerate().all(|(i, old)| *old == Some(i)) {
            return Self::All(Mutex::new(Some(kept)), m);
        }
        if kplus.host().is_some() && old.iter().any(Option::is_some) {
            return Self::Some { kept, old };
        }
        Self::Nothing(m)
    }

    pub fn columns(&self) -> ColumnCounts {
        match self {
            Self::All(_, kept) => ColumnCounts { computed: 0, kept: *kept },
            Self::Some { old, .. } => {
                let kept = old.iter().flatten().count();
                ColumnCounts { computed: old.len() - kept, kept }
            }
            Self::Nothing(computed) => ColumnCounts { computed: *computed, kept: 0 },
        }
    }

    /// No row is new.
    pub fn is_all(&self) -> bool {
        matches!(self, Self::All(..))
    }

    /// `F_p = B_p K_p+ B_p'` of the new rows; must be called only once.
    pub fn operator(&self, kplus: &GeneralizedInverse, rows: &Csr) -> Result<Form> {
        let made = match (self, kplus.host()) {
            (Self::All(kept, _), _) => {
                let kept = kept.lock().ok().and_then(|mut kept| kept.take());
                let twice = || Error::new(Kind::Internal, "a dual operator was asked for twice");
                return kept.and_then(|kept| kept.operator).ok_or_else(twice);
            }
            (Self::Some { kept, old }, Some(host)) => match &kept.operator {
                Some(Form::Own(before)) => extended(before, old, host, rows)?,
                Some(Form::Elsewhere(_)) | None => kplus.inverse_form(rows)?,
            },
            _ => kplus.inverse_form(rows)?,
        };
        Ok(Form::Own(Arc::new(made)))
    }
}

/// Copies the entries of two previous rows, and computes `F_p(i, j) = b_i K+ b_j'` for all others.
fn extended(from: &Packed, old: &[Option<usize>], kplus: &HostMultiple, rows: &Csr) -> Result<Packed> {
    let m = old.len();
    let mut operator = Packed::zeros(m)?;
    for (i, of_i) in old.iter().enumerate().filter_map(|(i, old)| Some((i, (*old)?))) {
        for (j, of_j) in old[..=i].iter().enumerate().filter_map(|(j, old)| Some((j, (*old)?))) {
            operator.add(i, j, from.get(of_i, of_j));
        }
    }
    let new: Vec<usize> = (0..m).filter(|&j| old[j].is_none()).collect();
    let columns = kplus.inverse_columns(rows, &new)?;
    for (k, &j) in new.iter().enumerate() {
        let others = (0..m).filter(|&i| i <= j || old[i].is_some());
        others.for_each(|i| operator.add(i, j, columns.get(i, k)));
    }
    Ok(operator)
}

/// For every row of `new` its number in `old`, if it occurs there bit by bit; equal rows get different numbers.
fn matched(old: &Csr, new: &Csr) -> Vec<Option<usize>> {
    let mut known: Vec<(u64, usize)> = (0..old.rows()).map(|i| (key(old, i), i)).collect();
    known.sort_unstable();
    let mut taken = vec![false; known.len()];
    let mut find = |i: usize| {
        let key = key(new, i);
        let first = known.partition_point(|entry| entry.0 < key);
        let mut alike = (first..known.len()).take_while(|&at| known[at].0 == key);
        let at = alike.find(|&at| !taken[at] && same_row((old, known[at].1), (new, i)))?;
        taken[at] = true;
        Some(known[at].1)
    };
    (0..new.rows()).map(&mut find).collect()
}

fn same_row((a, i): (&Csr, usize), (b, j): (&Csr, usize)) -> bool {
    let bits = |(dof, value): (usize, f64)| (dof, value.to_bits());
    a.row(i).map(bits).eq(b.row(j).map(bits))
}

/// Hash key of dofs and values.
fn key(rows: &Csr, i: usize) -> u64 {
    let words = rows.row(i).flat_map(|(dof, value)| [dof as u64, value.to_bits()]);
    hash(START, words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(all: &[&[(usize, f64)]]) -> Csr {
        let mut rows = Csr::empty(9);
        all.iter().for_each(|row| rows.push_row(row.iter().copied()));
        rows
    }

    #[test]
    fn rows_are_known_again_bit_by_bit_in_any_order_and_each_only_once() {
        let old = rows(&[&[(0, 1.0)], &[(0, 1.0), (2, -3.0)], &[(0, 1.0)], &[(5, 0.1)]]);
        let new =
            rows(&[&[(5, 0.1)], &[(0, 1.0)], &[(5, 0.1 + 1e-17)], &[(0, 1.0)], &[(0, 1.0)], &[(0, -1.0)]]);
        assert_eq!(matched(&old, &new), [Some(3), Some(0), None, Some(2), None, None]);
    }
}
