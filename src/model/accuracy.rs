//! The accuracy of the host's data: of right-hand sides, by the length of the problem, and of normals, weights and
//! coordinates, by option `data_accuracy`.

use std::ops::Range;

use crate::body::Body;
use crate::constraints::{RowKind, RowSet};
use crate::error::Result;
use crate::linalg::vector::NOISE;
use crate::model::contents::Model;
use crate::model::row_sets::empty_row_contradicts;

/// A right-hand side below this part of the length is not the rounding of a difference of such lengths: it is exact.
const LAST_DIGIT: f64 = f64::EPSILON / 64.0;

/// A part of the load that nothing holds makes the answer marginal up to this multiple of the accuracy of the data.
const MARGINAL: f64 = 1e3;

/// Digits of coordinates that have been rounded: fewer may be exact, more are rounding of f64.
const DIGITS: Range<i32> = 5..13;
/// Largest accuracy that digits of coordinates may show.
const MOST: f64 = 1e-6;
/// Longest chain of pilots between a load and what holds it.
const CHAIN: usize = 8;
/// Number of points whose digits are counted.
const SAMPLE: usize = 256;

/// What counts as rounding of the host's data.
#[derive(Debug, Clone, Copy, Default)]
pub struct Accuracy {
    /// Right-hand sides below this length times the largest entry of their row: 64 eps of the length of the problem.
    pub length: f64,
    /// Of normals, weights and coordinates, relative to their terms: a motion that each row resists by less than this part
    /// of its terms is undetermined, and a part of the load along it up to this share of the load is rounding.
    pub data: f64,
}

impl Model {
    /// The length of a problem is the largest of its distances between coordinates, motions `sum_j |f_j| / K_jj` of bodies
    /// by loads, K_jj or what rows give, and lengths `|h| / max |b|` and `-c / max |b|` demanded by rows; without loads and coordinates also the
    /// smallest gap. Other gaps may be far: they say nothing.
    pub fn accuracy(&self) -> Accuracy {
        let (mut length, held) = (0.0f64, self.held());
        for (body, start) in self.bodies.iter().map(|given| &given.body).zip(&self.offsets) {
            if let (Some(load), Some(_)) = (&body.load, body.k()) {
                let moved = load.iter().zip(&held[*start..]).map(|(f, held)| f.abs() / held);
                length = length.max(moved.sum());
            }
            length = body.coordinates.as_ref().map_or(length, |given| length.max(given.length()));
        }
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
        Accuracy { length: NOISE * length, data: self.settings.data_accuracy }
    }

    /// What holds every unknown, force / length: K_jj, or the best of its rows as far as the other unknowns of this row are held,
    /// `max_i b_ij^2 / (sum_l b_il^2 / d_l + C_i)`; pilots hang on each other in chains. Infinite without stiffness.
    fn held(&self) -> Vec<f64> {
        let of = |body: &Body| match body.k() {
            Some(k) => (0..k.order()).map(|j| k.metric(j, f64::INFINITY)).collect(),
            None => vec![f64::INFINITY; body.order],
        };
        let mut held: Vec<f64> = self.bodies.iter().flat_map(|given| of(&given.body)).collect();
        for _ in 0..CHAIN {
            let mut changed = false;
            for rows in [&self.contact, &self.equalities] {
                for i in (0..rows.len()).filter(|&i| rows.is_finite(i)) {
                    // only the entry that yields most gains by the others
                    let yields = |(j, b): (usize, f64)| b * b / held[j];
                    let Some((j, b)) = rows.matrix.row(i).max_by(|x, y| yields(*x).total_cmp(&yields(*y)))
                    else {
                        continue;
                    };
                    let others = rows.matrix.row(i).filter(|(l, _)| *l != j).map(yields).sum::<f64>();
                    let given = b * b / (others + rows.compliance[i]);
                    if others > 0.0 && given > 2.0 * held[j] {
                        (held[j], changed) = (given, true);
                    }
                }
            }
            if !changed {
                break;
            }
        }
        held
    }

    /// The accuracy of rows that the host makes from coordinates: `data_accuracy`, raised to what the digits of the
    /// coordinates show.
    pub fn accuracy_of_coordinates(&self) -> f64 {
        let given = self.bodies.iter().filter_map(|given| given.body.coordinates.as_ref());
        let printed = given.map(|coordinates| of_last_digit(coordinates.places())).fold(0.0, f64::max);
        self.settings.data_accuracy.max(printed.min(MOST))
    }

    /// Refuses rows without entries whose right-hand side does not satisfy them.
    pub fn check_empty_rows(&self, accuracy: Accuracy) -> Result<()> {
        for (kind, first) in [(RowKind::Inequality, 0), (RowKind::Equality, self.contact.len())] {
            let rows = self.rows(kind);
            let largest = rows.matrix.val.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            let largest = if largest > 0.0 { largest } else { 1.0 };
            let checked = rows.check_empty_rows(kind, accuracy.length * largest);
            checked.map_err(|mut error| {
                if accuracy.length == 0.0 {
                    error.what += ", and no load, gap or coordinate of the problem tells whether its right-hand side is \
                                   rounding: give coordinates, or a right-hand side of 0";
                }
                empty_row_contradicts(error, first)
            })?;
        }
        Ok(())
    }
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
    let all: Vec<_> = some.filter(|x| (*x * 1_048_576.0).fract() != 0.0).filter_map(decimal).collect();
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

    /// The right-hand side of row i of `rows`; 0 if it demands a motion and is rounding. Gaps that are open demand nothing.
    pub fn rhs(self, kind: RowKind, rows: &RowSet, i: usize) -> f64 {
        let c = rows.rhs[i];
        let demands = match kind {
            RowKind::Inequality => c < 0.0,
            RowKind::Equality => c != 0.0,
            RowKind::Tangential => false,
        };
        let limit = self.length * if demands { rows.largest_entry(i) } else { 0.0 };
        if (LAST_DIGIT / NOISE * limit..limit).contains(&c.abs()) {
            0.0
        } else {
            c
        }
    }
}
