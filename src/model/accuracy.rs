//! The accuracy of the host's data: of right-hand sides, by the lengths of bodies, and of normals, weights and
//! coordinates, by option `data_accuracy`.

use std::collections::HashMap;
use std::ops::Range;

use crate::body::Body;
use crate::constraints::{RowKind, RowSet};
use crate::error::Result;
use crate::linalg::hash::{hash, START};
use crate::linalg::sparse::csr::by_columns;
use crate::linalg::vector::{norm_max, NOISE};
use crate::model::contents::SolvedModel;
use crate::model::row_sets::empty_row_contradicts;
use crate::numbers::data::{BINARY, MARGINAL, MOST_BY_COORDINATES};
use crate::platform::memory::{filled, reserved};

/// A right-hand side below this part of the length is not the rounding of a difference of such lengths: it is exact.
const LAST_DIGIT: f64 = f64::EPSILON / 64.0;

/// Digits of coordinates that have been rounded: fewer may be exact, more are rounding of f64.
const DIGITS: Range<i32> = 5..13;
const WHAT: &str = "the lengths of bodies";
/// Number of points whose digits are counted.
const SAMPLE: usize = 256;

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
    /// Unknowns of rigid equality rows.
    tied: Vec<bool>,
    /// Equality rows that others may contradict, if the right-hand side of any may be rounding.
    core: Vec<bool>,
}

impl SolvedModel {
    /// The load of a body, if it is more than 64 eps of the largest.
    pub fn loads_that_count<'a>(&'a self) -> impl Fn(usize) -> Option<&'a [f64]> {
        let loads = self.bodies.iter().filter_map(|given| given.body.load.as_ref());
        let least = NOISE * loads.map(|load| norm_max(load)).fold(0.0, f64::max);
        move |body| self.bodies[body].body.load.as_deref().filter(|load| norm_max(load) > least)
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
        let of_body = |(body, by_load): (&Body, &f64)| {
            body.coordinates.as_ref().map_or(*by_load, |given| by_load.max(given.length()))
        };
        let of_bodies: Vec<f64> =
            self.bodies.iter().map(|given| &given.body).zip(by_loads).map(of_body).collect();
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
        let mut tied = filled(self.sizes().dofs, false, WHAT)?;
        let rigid = (0..self.equalities.len()).filter(|&i| self.equalities.compliance[i] == 0.0);
        rigid.flat_map(|i| self.equalities.matrix.row(i)).for_each(|(j, _)| tied[j] = true);
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
        let given = self.bodies.iter().filter_map(|given| given.body.coordinates.as_ref());
        let printed = given.map(|coordinates| of_last_digit(coordinates.places())).fold(0.0, f64::max);
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

/// Twice the unit of the last digit of coordinates that have been rounded to a few decimal digits, relative to the distance of
/// neighbours; 0 if they have not.
fn of_last_digit(places: &[[f64; 3]]) -> f64 {
    let some = places.iter().step_by(places.len().div_ceil(SAMPLE).max(1)).flatten();
    let decimal = |x: &f64| {
        let text = format!("{x:e}");
        let (digits, exponent) = text.split_once('e')?;
        Some((exponent.parse::<i32>().ok()?, digits.chars().filter(char::is_ascii_digit).count() as i32))
    };
    // multiples of 2^-20 are exact
    let all: Vec<_> = some.filter(|x| (*x * BINARY).fract() != 0.0).filter_map(decimal).collect();
    let most = all.iter().map(|number| number.1).max().unwrap_or(0);
    let long = all.iter().filter(|number| number.1 + 2 >= most).count();
    if !DIGITS.contains(&most) || 2 * long < all.len() {
        return 0.0;
    }
    let highest = all.iter().map(|number| number.0).max().unwrap_or(0);
    let along = |k: usize| {
        let ends = places.iter().map(|place| place[k]);
        ends.clone().fold(f64::NEG_INFINITY, f64::max) - ends.fold(f64::INFINITY, f64::min)
    };
    let size = (0..3).map(along).fold(0.0, f64::max);
    let dimension = (0..3).filter(|&k| along(k) > 0.0).count().max(1);
    let nodes = 1 + places.windows(2).filter(|pair| pair[0] != pair[1]).count();
    2.0 * 10f64.powi(highest - most + 1) * (nodes as f64).powf(1.0 / dimension as f64) / size
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
            _ => rows.compliance[i] == 0.0 && rows.matrix.row(i).all(|(j, _)| self.tied[j]),
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
