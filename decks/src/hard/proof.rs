//! Whether a proof that there is no answer is one: from the data alone, in double-double arithmetic.
//!
//! D = diag K, s_i = (b_i D^-1 b_i' + C_i)^-1/2, eps = 2^-52 (docs/certificate.md).

use crate::dd::{self, Dd};
use crate::yardstick::all_grounded;
use crate::{Deck, Rows};

/// What a resistance counts beside what it resists.
const CLEAR: f64 = 1e6;
const NOISE: f64 = 64.0 * f64::EPSILON;
/// What K may resist a rigid motion by, of itself.
const RIGID: f64 = 1e-8;

/// A motion v that should be rigid, opened or kept by every row, and driven by the load.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Largest |K v|_{D^-1} / | |K||v| |_{D^-1} of all bodies.
    pub strain: f64,
    /// f.v
    pub work: f64,
    /// |f|_{D^-1} |((S B v)_+, S_H H v)|, f of the bodies that v moves, without grounded unknowns.
    pub resisted: f64,
    /// f.v / (|f|_{D^-1} |v|_D), f of the bodies that v moves.
    pub share: f64,
}

impl Motion {
    /// `digits` of K, 16 for all.
    pub fn holds(&self, digits: usize) -> bool {
        let strain = RIGID.max(10f64.powi(2 - digits as i32));
        self.strain <= strain && self.work > 0.0 && self.work > CLEAR * self.resisted
    }
}

pub fn motion(deck: &Deck, v: &[f64]) -> Motion {
    let diagonal = diagonal(deck);
    let mut load = deck.load();
    let mut strain = 0.0f64;
    for (p, body) in deck.bodies.iter().enumerate() {
        let range = deck.offset(p)..deck.offset(p + 1);
        let own = &v[range.clone()];
        if own.iter().all(|v| *v == 0.0) {
            load[range].fill(0.0);
        }
        let (mut force, mut terms) = (0.0, 0.0);
        for (i, d) in body.stiffness.diagonal().iter().enumerate() {
            force += dd::dot(body.stiffness.row(i).map(|(j, k)| (k, own[j]))).value().powi(2) / d;
            terms += body.stiffness.row(i).map(|(j, k)| (k * own[j]).abs()).sum::<f64>().powi(2) / d;
        }
        if force > 0.0 {
            strain = strain.max((force / terms).sqrt());
        }
    }
    let mut resistance = 0.0;
    for (rows, both) in [(&deck.contact, false), (&deck.equalities, true)] {
        for i in (0..rows.len()).filter(|&i| rows.rhs[i] != f64::INFINITY) {
            let along = dd::dot(rows.matrix.row(i).map(|(j, value)| (value, v[j]))).value();
            let felt = if both { along.abs() } else { along.max(0.0) };
            resistance += (felt * scale(rows, i, &diagonal)).powi(2);
        }
    }
    let work = dd::dot(load.iter().copied().zip(v.iter().copied())).value();
    // loads on grounded unknowns drive no motion, and however large they are press on nothing else
    let grounded = all_grounded(deck);
    let force = length(&load, |j| if grounded[j] { 0.0 } else { 1.0 / diagonal[j] });
    let share = work / (force * length(v, |j| diagonal[j]));
    Motion { strain, work, resisted: force * f64::sqrt(resistance), share }
}

/// Weights of rows, contact rows before equality rows, that should leave nothing of the rows but a negative gap.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// Smallest weight of a contact row, 0 where none is negative.
    pub negative: f64,
    /// A weight on a row that does not exist, never closes, or gives way.
    pub astray: bool,
    /// w'c, then what a displacement of X and rounding could make of it:
    /// X |B'w|_{D^-1} + 64 eps (|w|'|c| + X | |B|'|w| |_{D^-1}).
    pub demanded: f64,
    pub doubt: f64,
}

impl Weights {
    pub fn hold(&self) -> bool {
        self.negative >= 0.0 && !self.astray && self.demanded + self.doubt < 0.0
    }
}

/// X = 1e6 max(|S c_-|, |S_H h|, |f|_{D^-1}): weights prove that there is no answer of |u|_D up to this.
pub fn reach(deck: &Deck) -> f64 {
    let diagonal = diagonal(deck);
    CLEAR * overlap(deck).max(length(&deck.load(), |j| 1.0 / diagonal[j]))
}

/// |u|_D
pub fn travel(deck: &Deck, u: &[f64]) -> f64 {
    let diagonal = diagonal(deck);
    length(u, |j| diagonal[j])
}

/// What weights w of rows prove.
pub fn weights(deck: &Deck, weights: &[(usize, f64)]) -> Weights {
    let diagonal = diagonal(deck);
    let contact = deck.contact.len();
    let reach = reach(deck);
    let (mut left, mut terms) = (vec![Dd::ZERO; deck.dofs()], vec![0.0; deck.dofs()]);
    let (mut demanded, mut sum) = (Dd::ZERO, 0.0);
    let mut found = Weights { negative: 0.0, astray: false, demanded: 0.0, doubt: 0.0 };
    for &(place, w) in weights {
        let (rows, i) =
            if place < contact { (&deck.contact, place) } else { (&deck.equalities, place - contact) };
        if i >= rows.len() || !rows.rhs[i].is_finite() || rows.compliance[i] > 0.0 || !w.is_finite() {
            found.astray = true;
            continue;
        }
        if place < contact {
            found.negative = w.min(found.negative);
        }
        demanded = demanded + Dd::product(w, rows.rhs[i]);
        sum += (w * rows.rhs[i]).abs();
        for (j, value) in rows.matrix.row(i) {
            left[j] = left[j] + Dd::product(w, value);
            terms[j] += (w * value).abs();
        }
    }
    let left: Vec<f64> = left.iter().map(|v| v.value()).collect();
    let over = |v: &[f64]| length(v, |j| 1.0 / diagonal[j]);
    found.demanded = demanded.value();
    found.doubt = reach * over(&left) + NOISE * (sum + reach * over(&terms));
    found
}

/// max(|S c_-|, |S_H h|)
pub fn overlap(deck: &Deck) -> f64 {
    let diagonal = diagonal(deck);
    let sets = [(&deck.contact, false), (&deck.equalities, true)];
    let all = sets.map(|(rows, both)| {
        let gap = |i: usize| if both { rows.rhs[i] } else { rows.rhs[i].min(0.0) };
        let scaled: Vec<f64> = (0..rows.len()).map(|i| gap(i) * scale(rows, i, &diagonal)).collect();
        length(&scaled, |_| 1.0)
    });
    all[0].max(all[1])
}

fn diagonal(deck: &Deck) -> Vec<f64> {
    deck.bodies.iter().flat_map(|body| body.stiffness.diagonal()).collect()
}

/// s_i; 0 for a row without entries.
fn scale(rows: &Rows, i: usize, diagonal: &[f64]) -> f64 {
    let square = rows.matrix.row(i).map(|(j, v)| v * v / diagonal[j]).sum::<f64>() + rows.compliance[i];
    if square > 0.0 {
        square.sqrt().recip()
    } else {
        0.0
    }
}

fn length(v: &[f64], weight: impl Fn(usize) -> f64) -> f64 {
    v.iter().enumerate().map(|(j, v)| v * v * weight(j)).sum::<f64>().sqrt()
}
