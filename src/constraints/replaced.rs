//! The first rows of a set replaced by others.

use std::sync::Arc;

use crate::constraints::{RowSet, Taken};
use crate::error::Result;
use crate::linalg::Csr;
use crate::platform::memory::reserved;

impl RowSet {
    /// The rows of all sets, one after the other.
    pub fn joined(mut sets: Vec<Self>) -> Self {
        if sets.len() == 1 {
            return sets.swap_remove(0);
        }
        let count = |of: &dyn Fn(&Self) -> usize| sets.iter().map(of).sum::<usize>();
        let (rows, entries) = (count(&|set| set.len()), count(&|set| set.matrix.col.len()));
        let mut all = Self {
            matrix: Arc::new(Csr::with_room(0, rows, entries)),
            rhs: Vec::with_capacity(rows),
            compliance: Arc::new(Vec::with_capacity(rows)),
            taken: None,
        };
        for set in &sets {
            all.append_rows(set);
        }
        all
    }

    /// A copy in which `first` stands in place of as many first rows; `cols`: all unknowns. `what` names it in errors.
    pub fn with_first(&self, first: &Self, cols: usize, what: &str) -> Result<Self> {
        let (rows, from) = (self.len().max(first.len()), first.len());
        if rows == from {
            return first.copied(what);
        }
        let rest = from..rows;
        let mut matrix = Csr {
            cols,
            ptr: reserved(rows + 1, what)?,
            col: reserved(first.matrix.col.len() + self.matrix.col.len(), what)?,
            val: reserved(first.matrix.val.len() + self.matrix.val.len(), what)?,
        };
        let (mut rhs, mut compliance) = (reserved(rows, what)?, reserved(rows, what)?);
        matrix.ptr.push(0);
        (0..from).for_each(|i| matrix.push_row(first.matrix.row(i)));
        rest.clone().for_each(|i| matrix.push_row(self.matrix.row(i)));
        rhs.extend(first.rhs.iter().chain(&self.rhs[rest.clone()]));
        compliance.extend(first.compliance.iter().chain(&self.compliance[rest.clone()]));
        let entries: Vec<usize> = first
            .cancelled()
            .iter()
            .chain(self.cancelled().iter().filter(|i| rest.contains(i)))
            .copied()
            .collect();
        let rounding: Vec<f64> = rest.clone().map(|i| self.rounding(i)).collect();
        let names: Vec<bool> = rest.map(|i| self.is_named(i)).collect();
        let mut taken = None;
        if !entries.is_empty() || rounding.iter().any(|v| *v > 0.0) || names.contains(&true) {
            let rhs = std::iter::repeat_n(0.0, from).chain(rounding).collect();
            let named = std::iter::repeat_n(false, from).chain(names).collect();
            taken = Some(Box::new(Taken { entries, rhs, named }));
        }
        Ok(Self { matrix: Arc::new(matrix), rhs, compliance: Arc::new(compliance), taken })
    }

    /// Drops all rows but the first `count`.
    pub fn keep_first(&mut self, count: usize) {
        if count == 0 {
            *self = Self::default();
            return;
        }
        Arc::make_mut(&mut self.matrix).truncate(count);
        self.rhs.truncate(count);
        Arc::make_mut(&mut self.compliance).truncate(count);
        if let Some(taken) = &mut self.taken {
            taken.entries.retain(|row| *row < count);
            taken.rhs.truncate(count);
            taken.named.truncate(count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::{RowKind, RowsInput};

    fn set(rows: &[(&[i64], f64)]) -> RowSet {
        let mut all = RowSet::default();
        for (dof, rhs) in rows {
            let val = vec![1.0; dof.len()];
            let input = RowsInput { ptr: &[0, dof.len()], body: None, dof, val: &val, rhs: Some(&[*rhs]) };
            all.add(RowKind::Inequality, input, &[0, 9]).unwrap();
        }
        all
    }

    #[test]
    fn rows_behind_those_replaced_stay() {
        let mut all = set(&[(&[], f64::INFINITY), (&[], f64::INFINITY), (&[3, 4], 2.0)]);
        all.set_compliance(2, &[0.5]).unwrap();
        all.name(2);
        let first = set(&[(&[1], 1.0), (&[], f64::INFINITY)]);
        let new = all.with_first(&first, 9, "rows").unwrap();
        assert_eq!(
            (new.rhs.clone(), &new.compliance[..]),
            (vec![1.0, f64::INFINITY, 2.0], &[0.0, 0.0, 0.5][..])
        );
        assert_eq!((&new.matrix.ptr[..], &new.matrix.col[..]), (&[0, 1, 1, 3][..], &[1, 3, 4][..]));
        assert_eq!([0, 1, 2].map(|i| new.is_named(i)), [false, false, true]);
        let mut kept = new;
        kept.keep_first(2);
        assert!(kept.same_but_rhs(&first) && kept.rhs == first.rhs && kept.matrix.ptr.len() == 3);
    }
}
