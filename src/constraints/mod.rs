//! Contact rows `B u <= c` and equality rows `H u = h`: the host's entries over the unknowns of all bodies
//! in sequence, and the scaling of the rows.
//!
//! A compliant row yields in proportion to its force, as if it contained a spring k: `B u - c <= lambda/k`,
//! `H u - h = mu/k`. It is equivalent to the row `[b, -1]` of a problem with one more unknown of stiffness k, so that
//! C = diag(1/k) is added to `B D^-1 B'` and to F wherever they appear.

mod accumulator;
mod decoupling;
mod dof_table;
mod entries;
mod friction;
mod grouping;
mod kind;
mod owned;
mod replaced;
mod tabled;
mod taken;
mod touched;

pub use decoupling::{Decoupling, UnitRows};
pub use dof_table::{DofTable, DofTableInput};
pub use friction::{entries, Entries, Friction, FrictionInput, FrictionNode};
pub use grouping::Grouping;
pub use kind::RowKind;
pub use owned::OwnedRows;
pub use tabled::{Table, TabledRows};
pub use taken::Taken;
pub use touched::Touched;

use std::sync::Arc;

use crate::constraints::entries::{summed, unknown};
use crate::error::{Error, Kind, Result};
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::first_non_finite;
use crate::linalg::Csr;
use crate::platform::memory::{copied, zeros};

/// Rows as given, counting from 0; without `body` the dofs count through all bodies.
#[derive(Debug, Clone, Copy)]
pub struct RowsInput<'a> {
    pub ptr: &'a [usize],
    pub body: Option<&'a [i64]>,
    pub dof: &'a [i64],
    pub val: &'a [f64],
    /// c or h, length; zeros if absent.
    pub rhs: Option<&'a [f64]>,
}

/// All rows of one kind.
#[derive(Debug, Clone)]
pub struct RowSet {
    /// m x (unknowns of all bodies); no unit. Saved states share it.
    pub matrix: Arc<Csr>,
    /// c or h, length; +infinity for a contact row that never closes.
    pub rhs: Vec<f64>,
    /// 1/k >= 0, length / force; 0 for a rigid row. Saved states, parts and equal islands share it.
    pub compliance: Arc<Vec<f64>>,
    /// What was taken from the host's rows as rounding; none if nothing was, as in nearly all of very many sets.
    pub taken: Option<Box<Taken>>,
}

impl Default for RowSet {
    fn default() -> Self {
        Self { matrix: Arc::new(Csr::empty(0)), rhs: Vec::new(), compliance: Arc::default(), taken: None }
    }
}

impl RowSet {
    pub fn len(&self) -> usize {
        self.rhs.len()
    }

    /// `b_i D^-1 b_i' + C_i` in units of `1 / unit`; `metric` is D / `unit`.
    pub fn yields(&self, i: usize, metric: &[f64], unit: f64) -> f64 {
        self.matrix.row(i).map(|(j, v)| v * v / metric[j]).sum::<f64>() + unit * self.compliance[i]
    }

    /// A copy that shares entries and compliances of the rows; `what` names it in errors.
    pub fn copied(&self, what: &str) -> Result<Self> {
        let (rhs, compliance) = (copied(&self.rhs, what)?, Arc::clone(&self.compliance));
        Ok(Self { matrix: Arc::clone(&self.matrix), rhs, compliance, taken: self.taken.clone() })
    }

    /// Entries and compliances equal those of the other, and the same rows may close.
    pub fn same_but_rhs(&self, other: &Self) -> bool {
        let same = Arc::ptr_eq(&self.matrix, &other.matrix) || self.matrix == other.matrix;
        let finite = |rows: &Self| (0..rows.len()).map(|i| rows.is_finite(i)).collect::<Vec<_>>();
        same && self.compliance == other.compliance && finite(self) == finite(other)
    }

    /// Row i may close: a row with an infinite gap never does.
    pub fn is_finite(&self, i: usize) -> bool {
        self.rhs[i] < f64::INFINITY
    }

    /// Appends rows over bodies that begin at `offsets` (one entry more than bodies: the last is the end); repeated
    /// entries of a row are summed, and rounding of such sums counts as no entry. Returns the number of the first row. An error changes nothing.
    pub fn add(&mut self, kind: RowKind, input: RowsInput<'_>, offsets: &[usize]) -> Result<usize> {
        let rows = input.ptr.len() - 1;
        if let Some(at) = first_non_finite(input.val) {
            let row = input.ptr.partition_point(|&p| p <= at) - 1;
            return Err(Error::argument("val", "the entry is not a finite number").row(row).entry(at));
        }
        let rhs = match input.rhs {
            Some(rhs) => copied(rhs, "constraint rows")?,
            None => zeros(rows, "constraint rows")?,
        };
        check_rhs(kind, &rhs, 0)?;
        let (mut added, mut taken) = (Csr::empty(0), None::<Box<Taken>>);
        for i in 0..rows {
            let mut entries = Vec::with_capacity(input.ptr[i + 1] - input.ptr[i]);
            for at in input.ptr[i]..input.ptr[i + 1] {
                entries.push((unknown(input, at, offsets).map_err(|e| e.row(i).entry(at))?, input.val[at]));
            }
            let noise = summed(&mut entries);
            if entries.iter().any(|entry| !entry.1.is_finite()) {
                let what = "the sum of entries of one unknown is not a finite number";
                return Err(Error::argument("val", what).row(i));
            }
            if entries.iter().any(|entry| entry.1 != 0.0)
                && entries.iter().all(|entry| entry.1.abs() <= noise)
            {
                taken.get_or_insert_default().entries.push(i);
            }
            entries.retain(|entry| entry.1.abs() > noise);
            added.push_row(entries);
        }
        let compliance = zeros(rows, "constraint rows")?.into();
        self.append(&Self { matrix: Arc::new(added), rhs, compliance, taken }, offsets)
    }

    /// Appends rows over the same unknowns; returns the number of the first.
    pub fn append(&mut self, more: &Self, offsets: &[usize]) -> Result<usize> {
        let first = self.append_rows(more);
        Arc::make_mut(&mut self.matrix).cols = offsets.last().copied().unwrap_or(0);
        Ok(first)
    }

    fn append_rows(&mut self, more: &Self) -> usize {
        let first = self.len();
        let matrix = Arc::make_mut(&mut self.matrix);
        matrix.append(&more.matrix);
        matrix.cols = matrix.cols.max(more.matrix.cols);
        self.rhs.extend(&more.rhs);
        Arc::make_mut(&mut self.compliance).extend(&*more.compliance);
        if !more.cancelled().is_empty() {
            self.taken.get_or_insert_default().entries.extend(more.cancelled().iter().map(|row| first + row));
        }
        first
    }

    /// Sets right-hand sides. True if some row changes between rows that may close and rows that never close.
    pub fn set_rhs(&mut self, kind: RowKind, first: usize, rhs: &[f64]) -> Result<bool> {
        let target = values_from(&mut self.rhs, first, rhs.len())?;
        check_rhs(kind, rhs, first)?;
        let turned = target.iter().zip(rhs).any(|(old, new)| old.is_finite() != new.is_finite());
        target.copy_from_slice(rhs);
        Ok(turned)
    }

    /// `inv_k`: 1/k, length / force, for the rows from `first` on; 0 makes a row rigid.
    pub fn set_compliance(&mut self, first: usize, inv_k: &[f64]) -> Result<()> {
        let all = Arc::make_mut(&mut self.compliance);
        let target = values_from(all, first, inv_k.len())?;
        if let Some(at) = inv_k.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
            let what = format!("the compliance 1/k is not a finite number >= 0: {}", inv_k[at]);
            return Err(Error::argument("inv_k", what).row(first + at).entry(at).value(inv_k[at]));
        }
        target.copy_from_slice(inv_k);
        Ok(())
    }

    /// Refuses rows with entries whose scale is 0.
    pub fn check_scales(&self, kind: RowKind, scales: &[f64]) -> Result<()> {
        match (0..self.len()).find(|&i| scales[i] == 0.0 && !self.is_empty_row(i)) {
            Some(i) => {
                let what = format!("the square of this {}, b D^-1 b', over- or underflows", kind.name());
                Err(Error::new(Kind::Overflow, what).row(i).kind(kind as usize))
            }
            None => Ok(()),
        }
    }

    pub fn is_empty_row(&self, i: usize) -> bool {
        self.matrix.ptr[i] == self.matrix.ptr[i + 1]
    }

    /// The forces of springs without entries: `-c <= lambda/k` gives lambda = max(0, -k c), `-h = mu/k` gives
    /// mu = -k h; 0 for all other rows.
    pub fn forces_without_entries(&self, kind: RowKind) -> impl Iterator<Item = f64> + '_ {
        (0..self.len()).map(move |i| self.force_without_entries(kind, i))
    }

    /// The force of row i in `forces_without_entries`.
    pub fn force_without_entries(&self, kind: RowKind, i: usize) -> f64 {
        let alone = self.is_empty_row(i) && self.compliance[i] > 0.0;
        let force = if alone { -self.rhs[i] / self.compliance[i] } else { 0.0 };
        match kind {
            RowKind::Inequality => force.max(0.0),
            RowKind::Equality => force,
            RowKind::Tangential => 0.0,
        }
    }

    /// `c_i + C_i lambda_i - b_i u`: the open gap, including the compliance of the row. In double-double arithmetic: the
    /// rounding of a long sum, in particular of equal terms, is many times that of its terms.
    pub fn open_gap(&self, i: usize, u: &[f64], multiplier: f64) -> f64 {
        self.open_gap_at(i, |j| u[j], multiplier)
    }

    /// As `open_gap`; `u`: the displacement of an unknown.
    pub fn open_gap_at(&self, i: usize, u: impl Fn(usize) -> f64, multiplier: f64) -> f64 {
        let mut left = Twofold::from(self.rhs[i]);
        left.add_product(self.compliance[i], multiplier);
        self.matrix.row(i).for_each(|(j, v)| left.add_product(-v, u(j)));
        left.value()
    }

    /// `max_j |b_ij|`
    pub fn largest_entry(&self, i: usize) -> f64 {
        self.matrix.row(i).fold(0.0, |most, (_, v)| most.max(v.abs()))
    }

    /// A rigid row without entries constrains nothing: its right-hand side must satisfy it, up to `rounding`. Its multiplier
    /// is 0.
    pub fn check_empty_rows(&self, kind: RowKind, rounding: f64) -> Result<()> {
        let empty = |i: usize| self.is_empty_row(i) && self.compliance[i] == 0.0;
        let fails = |i: usize| match kind {
            RowKind::Inequality => self.rhs[i] < -rounding,
            RowKind::Equality => self.rhs[i].abs() > rounding,
            RowKind::Tangential => false,
        };
        match (0..self.len()).find(|&i| empty(i) && fails(i)) {
            Some(i) => Err(Error::new(Kind::GapsContradict, format!("this {} has no entries", kind.name()))
                .row(i)
                .kind(kind as usize)
                .value(self.rhs[i])
                .limit(rounding)),
            None => Ok(()),
        }
    }
}

/// Checks right-hand sides of the rows from `first` on. A gap may be +infinity.
fn check_rhs(kind: RowKind, rhs: &[f64], first: usize) -> Result<()> {
    let never = |c: f64| kind == RowKind::Inequality && c == f64::INFINITY;
    let what = match kind {
        RowKind::Inequality => "the gap is neither a finite number nor +infinity",
        RowKind::Equality | RowKind::Tangential => "the entry is not a finite number",
    };
    match rhs.iter().position(|c| !c.is_finite() && !never(*c)) {
        None => Ok(()),
        Some(at) => Err(Error::argument("rhs", what).row(first + at).entry(at)),
    }
}

/// The values `first` to `first + count`. An error names `first` if there is no such row, `rows` if the count is too
/// large.
fn values_from(values: &mut [f64], first: usize, count: usize) -> Result<&mut [f64]> {
    let rows = values.len();
    let end = first.saturating_add(count);
    values.get_mut(first..end).ok_or_else(|| {
        let argument = if first < rows { "rows" } else { "first" };
        Error::argument(argument, format!("there are {rows} rows")).value(end as f64).limit(rows as f64)
    })
}

/// `s_i = (b_i D^-1 b_i' + 1/k_i)^-1/2`: with lambda = S mu every row of the dual has the same weight, whatever the
/// stiffness of the bodies it joins and of its own spring. `metric` is D / `unit`, and s_i in that unit. 0 for a rigid
/// row without entries, and for a row whose square is not a normal number.
pub fn row_scales(rows: &RowSet, metric: &[f64], unit: f64) -> Vec<f64> {
    (0..rows.len())
        .map(|i| rows.yields(i, metric, unit))
        .map(|square| if square.is_normal() { square.sqrt().recip() } else { 0.0 })
        .collect()
}

#[cfg(test)]
mod tests;
