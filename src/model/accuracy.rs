//! The accuracy of the host's data: of right-hand sides, by the lengths of bodies, and of normals, weights and
//! coordinates, by option `data_accuracy`.

use std::collections::HashMap;

use crate::constraints::{RowKind, RowSet};
use crate::error::Result;
use crate::linalg::hash::{hash, START};
use crate::linalg::sparse::csr::by_columns;
use crate::linalg::vector::NOISE;
use crate::model::contents::{GivenBody, SolvedModel};
use crate::model::row_sets::empty_row_contradicts;
use crate::numbers::data::{MARGINAL, MOST_BY_COORDINATES};
use crate::platform::memory::reserved;

/// A right-hand side below this part of the length is not the rounding of a difference of such lengths: it is exact.
const LAST_DIGIT: f64 = f64::EPSILON / 64.0;

const WHAT: &str = "the lengths of bodies";

/// What counts as rounding of the host's normals, weights and coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Accuracy {
    /// Relative to their terms: a motion that each row resists by less than this part of its terms is undetermined, and a
    /// part of the load along it up to this share of the load is rounding.
    pub data: f64,
}

/// The lengths of which right-hand sides are differences.
pub struct Lengths<'a> {
    model: &'a SolvedModel,
    /// Of every body, its largest distance between coordinates and its motion `sum_j |f_j| / D^_j` by its load; 0 without
    /// both. A load below 64 eps of the largest is none.
    of_bodies: Vec<f64>,
    /// Of the problem: the largest of all bodies and of the lengths `|h| / max |b|` and `-c / max |b|` that rows demand;
    /// without loads and coordinates also the smallest gap. Other gaps may be far: they say nothing.
    whole: f64,
    /// Unknowns of rigid equality rows, ascending.
    tied: Vec<usize>,
    /// Equality rows that others may contradict, if the right-hand side of any may be rounding.
    core: Vec<bool>,
}

impl SolvedModel {
    /// Whether the load of a body is more than 64 eps of the largest.
    pub fn loads_that_count(&self) -> impl Fn(usize) -> bool + '_ {
        let largest = |given: &GivenBody| given.body.largest_load();
        let least = NOISE * self.bodies.iter().filter_map(largest).fold(0.0, f64::max);
        move |body| self.bodies[body].body.largest_load().is_some_and(|largest| largest > least)
    }

    /// Some row demands a motion, or has no entries.
    pub fn may_contradict(&self) -> bool {
        [RowKind::Inequality, RowKind::Equality].into_iter().any(|kind| {
            let rows = self.rows(kind);
            (0..rows.len()).any(|i| demands(kind, rows.rhs[i]) || rows.is_empty_row(i))
        })
    }

    /// `by_loads`: of every body `sum_j |f_j| / D^_j`.
    pub fn lengths(&self, by_loads: &[f64]) -> Result<Lengths<'_>> {
        let of_body = |(given, by_load): (&GivenBody, &f64)| given.body.length().max(*by_load);
        let of_bodies: Vec<f64> = self.bodies.iter().zip(by_loads).map(of_body).collect();
        let mut length = of_bodies.iter().copied().fold(0.0, f64::max);
        let gaps = || {
            let with_entries = (0..self.contact.len()).filter(|&i| !self.contact.is_empty_row(i));
            with_entries.map(|i| self.contact.rhs[i] / self.contact.largest_entry(i))
        };
        let open = || gaps().filter(|gap| *gap > 0.0);
        if length == 0.0 {
            length = Some(open().fold(f64::INFINITY, f64::min)).filter(|c| *c < f64::INFINITY).unwrap_or(0.0);
        }
        let equalities = (0..self.equalities.len()).filter(|&i| !self.equalities.is_empty_row(i));
        length = equalities
            .map(|i| self.equalities.rhs[i].abs() / self.equalities.largest_entry(i))
            .chain(gaps().map(|gap| -gap))
            .fold(length, f64::max);
        let rigid = (0..self.equalities.len()).filter(|&i| self.equalities.compliance[i] == 0.0);
        let mut tied = reserved(self.equalities.matrix.col.len(), WHAT)?;
        tied.extend(rigid.flat_map(|i| self.equalities.matrix.row(i)).map(|(j, _)| j));
        tied.sort_unstable();
        tied.dedup();
        let mut lengths = Lengths { model: self, of_bodies, whole: length, tied, core: Vec::new() };
        let doubtful = |i: usize| {
            let (c, limit) = (self.equalities.rhs[i], NOISE * length * self.equalities.largest_entry(i));
            demands(RowKind::Equality, c) && is_rounding(c, limit)
        };
        if (0..self.equalities.len()).any(doubtful) {
            lengths.core = core(&self.equalities)?;
        }
        Ok(lengths)
    }

    /// The accuracy of rows that the host makes from coordinates: `data_accuracy`, raised to what the digits of the
    /// coordinates show.
    pub fn accuracy_of_coordinates(&self) -> f64 {
        let printed = self.bodies.iter().map(|given| given.body.last_digit()).fold(0.0, f64::max);
        self.settings.data_accuracy.max(printed.min(MOST_BY_COORDINATES))
    }
}

/// Rigid rows that others may contradict by the rounding of their right-hand sides: without those that an unknown of theirs alone
/// satisfies, then those that this leaves with such an unknown, and so on. Rows that say the same contradict nothing.
fn core(rows: &RowSet) -> Result<Vec<bool>> {
    let (mut said, mut first) = (HashMap::new(), reserved(rows.len(), WHAT)?);
    let is_rigid = |i: usize| rows.compliance[i] == 0.0;
    first.extend((0..rows.len()).map(|i| if is_rigid(i) { said_first(rows, i, &mut said) } else { i }));
    let mut core: Vec<bool> = (0..rows.len()).map(|i| is_rigid(i) && first[i] == i).collect();
    let own = |i: usize| rows.matrix.row(i).map(move |(j, v)| (i, j, v));
    let entries = || (0..rows.len()).filter(|&i| is_rigid(i) && first[i] == i).flat_map(own);
    let (starts, row, _) = by_columns(rows.matrix.cols, entries, WHAT)?;
    let mut left: Vec<usize> = starts.windows(2).map(|ends| ends[1] - ends[0]).collect();
    let mut alone: Vec<usize> = (0..left.len()).filter(|&j| left[j] == 1).collect();
    while let Some(j) = alone.pop() {
        let Some(&i) = row[starts[j]..starts[j + 1]].iter().find(|i| core[**i]) else { continue };
        core[i] = false;
        for (k, _) in rows.matrix.row(i) {
            left[k] -= 1;
            alone.extend((left[k] == 1).then_some(k));
        }
    }
    Ok(first.iter().map(|&i| core[i]).collect())
}

/// The first row of which this one is a multiple, with its right-hand side; `said`: those that are no multiples, by their unknowns.
fn said_first(rows: &RowSet, i: usize, said: &mut HashMap<u64, Vec<usize>>) -> usize {
    let leading = |i: usize| rows.matrix.row(i).next().map_or(1.0, |(_, b)| b);
    let all = |i: usize| rows.matrix.row(i).chain([(usize::MAX, rows.rhs[i])]);
    let is_multiple = |k: &usize| {
        let by = leading(i) / leading(*k);
        let near =
            |((j, a), (l, b)): ((usize, f64), (usize, f64))| j == l && (a - by * b).abs() <= NOISE * a.abs();
        all(i).count() == all(*k).count() && all(i).zip(all(*k)).all(near)
    };
    let same = said.entry(hash(START, rows.matrix.row(i).map(|(j, _)| j as u64))).or_default();
    same.iter().copied().find(is_multiple).unwrap_or_else(|| {
        same.push(i);
        i
    })
}

/// A right-hand side that demands a motion. Gaps that are open demand nothing.
fn demands(kind: RowKind, c: f64) -> bool {
    match kind {
        RowKind::Inequality => c < 0.0,
        RowKind::Equality => c != 0.0,
        RowKind::Tangential => false,
    }
}

/// A right-hand side of this rounding, unless it is too small to be rounding.
fn is_rounding(c: f64, limit: f64) -> bool {
    (LAST_DIGIT / NOISE * limit..limit).contains(&c.abs())
}

impl Accuracy {
    /// The largest share of the load that may be left out of a marginal answer.
    pub fn marginal(self) -> f64 {
        MARGINAL * self.data
    }
}

impl Lengths<'_> {
    pub fn model(&self) -> &SolvedModel {
        self.model
    }

    /// The rounding of the right-hand side of row i of a kind, times its largest entry: 64 eps of the longest body that it
    /// touches. Where rigid equality rows may contradict a rigid row, or its bodies have no length, that of the problem: there
    /// rounding contradicts, elsewhere, as beside a spring, it is as harmless as it is small.
    pub fn rounding(&self, kind: RowKind, i: usize) -> f64 {
        let (rows, ends) = (self.model.rows(kind), &self.model.offsets[1..]);
        let is_tied = match kind {
            RowKind::Equality => self.core.get(i).copied().unwrap_or_default(),
            _ => {
                rows.compliance[i] == 0.0
                    && rows.matrix.row(i).all(|(j, _)| self.tied.binary_search(&j).is_ok())
            }
        };
        let bodies = rows.matrix.row(i).map(|(j, _)| ends.partition_point(|end| *end <= j));
        let own = bodies.map(|p| self.of_bodies[p]).fold(0.0, f64::max);
        let length = if is_tied || own == 0.0 { self.whole } else { own };
        NOISE * length * rows.largest_entry(i)
    }

    /// The right-hand side of row i of a kind; 0 if it demands a motion and is rounding.
    pub fn rhs(&self, kind: RowKind, i: usize) -> f64 {
        let c = self.model.rows(kind).rhs[i];
        if demands(kind, c) && is_rounding(c, self.rounding(kind, i)) {
            0.0
        } else {
            c
        }
    }

    /// Refuses rows without entries whose right-hand side does not satisfy them.
    pub fn check_empty_rows(&self) -> Result<()> {
        let (model, length) = (self.model, self.whole);
        for (kind, first) in [(RowKind::Inequality, 0), (RowKind::Equality, model.contact.len())] {
            let rows = model.rows(kind);
            let largest = rows.matrix.val.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            let largest = if largest > 0.0 { largest } else { 1.0 };
            let checked = rows.check_empty_rows(kind, NOISE * length * largest);
            checked.map_err(|mut error| {
                if length == 0.0 {
                    error.what += ", and no load, gap or coordinate of the problem tells whether its right-hand side is \
                                   rounding: give coordinates, or a right-hand side of 0";
                }
                empty_row_contradicts(error, first)
            })?;
        }
        Ok(())
    }
}
