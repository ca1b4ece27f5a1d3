//! Which of the softest motions of a part form its null space. At the few dofs t of the search, a motion that K resists
//! only by rounding of its entries seems stiffer by (dofs of the part) / (dofs t). The measure that distinguishes it from
//! a support is `theta = v'K v / v'D v` over the whole part, compared with the possible effect of rounding.

use std::fmt;

use crate::body::digits::Digits;
use crate::numbers::rounding;

use crate::error::{Error, Kind, Result};
use crate::linalg::dense::spectrum::symmetric_eigen;
use crate::linalg::vector::{dot, NOISE};
use crate::linalg::{Matrix, Multiple};
use crate::numbers::body::{DEVIATIONS, GAP, MAY_BE_FREE, MEASURED, NEGATIVE, TRIFLE, WEAK_SPRINGS};
use crate::ranks::wire_struct;

/// Weak springs of a host hold up to six rigid motions of a part, ...
const RIGID: usize = 6;

/// Motions with a resistance in K that may be rounding of its entries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Doubt {
    pub digits: Digits,
    pub motions: usize,
    /// Their largest v'K v / v'D v, ...
    pub resisted: f64,
    /// ... and the value that rounding of the entries may cause.
    pub rounding: f64,
    /// They are treated as free; as supports if no gap separates them from the other motions.
    pub free: bool,
}

wire_struct!(Doubt { digits, motions, resisted, rounding, free });

impl fmt::Display for Doubt {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { digits, motions, resisted, rounding, free } = self;
        write!(out, "the entries of K have {digits}: ")?;
        if *free {
            write!(
                out,
                "{motions} motions are taken as free that K resists by {resisted:.1e} of its stiffness: rounding \
                 explains up to {rounding:.1e}"
            )
        } else {
            write!(
                out,
                "{motions} motions that K resists only by {resisted:.1e} of its stiffness are taken as supports; \
                 rounding may be {rounding:.1e} of it: give the null space, or more digits"
            )
        }
    }
}

/// The softest motions of a part, Ritz vectors of K in the metric D, ascending.
pub struct Ritz {
    /// theta
    pub values: Vec<f64>,
    /// Rounding of theta: of the entries and of the products.
    pub noise: Vec<f64>,
    /// Rounding of theta by the products alone.
    products: Vec<f64>,
    /// Coefficients of the Ritz vectors in the motions measured, q x q.
    pub turn: Matrix,
}

/// The classification of the softest motions of a part.
#[derive(Debug, PartialEq)]
pub enum MotionVerdict {
    /// The first `dimension` motions are free.
    Free {
        dimension: usize,
        gap: f64,
    },
    /// No motion is free; the resistance to the first `doubtful` may be rounding of the entries.
    Held {
        doubtful: usize,
        gap: f64,
    },
    Indefinite,
    Unclear(Digits),
}

/// Dimension of the null space and the ratio of the stiffness beyond it to that within, from ascending eigenvalues of a
/// matrix of unit diagonal or a Schur complement of it; `None` if some are soft but no gap separates them.
pub fn cut(values: &[f64]) -> Option<(usize, f64)> {
    let m = values.len();
    let stiffest = values[m - 1];
    // eigenvalues below this are rounding
    if stiffest <= rounding::SUM {
        return Some((m, rounding::SUM.recip()));
    }
    let relative = |k: usize| (values[k] / stiffest).max(rounding::SUM);
    if relative(0) >= MAY_BE_FREE {
        return Some((0, relative(0) / rounding::SUM));
    }
    let gaps = (1..m).filter(|&k| relative(k - 1) < MAY_BE_FREE).map(|k| (k, relative(k) / relative(k - 1)));
    gaps.reduce(|best, gap| if gap.1 > best.1 { gap } else { best }).filter(|(_, gap)| *gap >= GAP)
}

/// Whether weak springs alone may hold motions beyond the softest `dimension` at t.
pub fn may_be_weak(values: &[f64], dimension: usize) -> bool {
    values.get(dimension).is_some_and(|value| *value < MEASURED * values[values.len() - 1])
}

/// How many of the softest motions at t are to be measured; 0 if none is soft, or so soft that rounding of its digits may
/// explain it.
pub fn to_measure(values: &[f64], digits: Option<Digits>) -> usize {
    let soft = digits.map_or(MEASURED, |digits| MEASURED.max(digits.relative()));
    match values.partition_point(|value| *value < soft * values[values.len() - 1]) {
        0 => 0,
        soft => (soft + 1).min(values.len()),
    }
}

/// Measures the motions x, n x q.
pub fn measured(k: &Multiple, digits: Option<Digits>, mut x: Matrix) -> Result<Ritz> {
    let (n, q) = (x.rows, x.cols);
    let (image, _) = k.mul_columns(&x)?;
    let metric = |a: usize, b: usize| (0..n).map(|i| x.get(i, a) * k.metric(i, 1.0) * x.get(i, b)).sum();
    let stiff = |a: usize, b: usize| (0..n).map(|i| x.get(i, a) * image.get(i, b)).sum();
    let turn = turned(&symmetric(q, metric)?, &symmetric(q, stiff)?)?;
    x.turn_rows(&turn);
    let (image, terms) = k.mul_columns(&x)?;
    let work = |of: &Matrix, c: usize, size: fn(f64) -> f64| -> f64 {
        x.col(c).iter().zip(of.col(c)).map(|(x, v)| size(*x) * v).sum()
    };
    let values = (0..q).map(|c| work(&image, c, |v| v)).collect();
    let products: Vec<f64> = (0..q).map(|c| NOISE * work(&terms, c, f64::abs)).collect();
    let mut noise = products.clone();
    if let Some(digits) = digits {
        let entries = digits.noise(&k.matrix, &x)?;
        noise.iter_mut().zip(entries).for_each(|(noise, e)| *noise += DEVIATIONS * k.by * e);
    }
    Ok(Ritz { values, noise, products, turn })
}

/// The symmetric part of q x q entries.
pub fn symmetric(q: usize, entry: impl Fn(usize, usize) -> f64) -> Result<Matrix> {
    let mut matrix = Matrix::zeros(q, q)?;
    for a in 0..q {
        for b in 0..=a {
            let value = 0.5 * (entry(a, b) + entry(b, a));
            matrix.set(a, b, value);
            matrix.set(b, a, value);
        }
    }
    Ok(matrix)
}

/// T with `T'M T = I` and `T'A T` diagonal, ascending.
fn turned(m: &Matrix, a: &Matrix) -> Result<Matrix> {
    let q = m.rows;
    let (sizes, mut unit) = symmetric_eigen(m)?;
    for (j, size) in sizes.iter().enumerate() {
        unit.col_mut(j).iter_mut().for_each(|v| *v /= size.sqrt());
    }
    let mut image = Matrix::zeros(q, q)?;
    (0..q).for_each(|j| a.mul_add(1.0, unit.col(j), image.col_mut(j)));
    let (_, vectors) = symmetric_eigen(&symmetric(q, |a, b| dot(unit.col(a), image.col(b)))?)?;
    let mut turn = Matrix::zeros(q, q)?;
    (0..q).for_each(|j| unit.mul_add(1.0, vectors.col(j), turn.col_mut(j)));
    Ok(turn)
}

impl Ritz {
    /// Whether K shows that its entries are exact, whatever digits they have: it has motions that it resists by no more than
    /// rounding of the products, and none between these and the rounding of the entries.
    pub fn is_exact(&self) -> bool {
        let below =
            |bounds: &[f64]| self.values.iter().zip(bounds).take_while(|(v, b)| v.abs() <= **b).count();
        let exact = below(&self.products);
        exact > 0 && below(&self.noise) == exact
    }

    /// Number of motions whose resistance may be rounding.
    pub fn explained(&self) -> usize {
        self.values.iter().zip(&self.noise).take_while(|(value, noise)| value <= noise).count()
    }

    pub fn take_as_exact(&mut self) {
        self.noise.clone_from(&self.products);
    }

    /// Motions that rounding explains are free if a gap separates them from the next motion.
    pub fn judged(&self, digits: Option<Digits>) -> MotionVerdict {
        let (values, noise) = (&self.values, &self.noise);
        if values[0] < -noise[0].max(NEGATIVE) {
            return MotionVerdict::Indefinite;
        }
        let explained = self.explained();
        let most = (0..explained).map(|k| noise[k].max(values[k].abs())).fold(0.0, f64::max);
        match values.get(explained) {
            None => return MotionVerdict::Free { dimension: explained, gap: rounding::SUM.recip() },
            Some(next) if explained > 0 && *next >= GAP * most => {
                return MotionVerdict::Free { dimension: explained, gap: next / most }
            }
            Some(_) => {}
        }
        let Some(digits) = digits else {
            return match cut(&[values, &[1.0][..]].concat()) {
                Some((0, gap)) => MotionVerdict::Held { doubtful: 0, gap },
                Some((dimension, gap)) => MotionVerdict::Free { dimension, gap },
                // those that K resists count as soft
                None => MotionVerdict::Free { dimension: explained, gap: 1.0 },
            };
        };
        if values[0] <= self.products[0] {
            return MotionVerdict::Unclear(digits);
        }
        let doubtful = (0..values.len()).take_while(|&k| GAP * noise[k] >= values[k]).count();
        MotionVerdict::Held { doubtful, gap: values[0] / noise[0] }
    }

    /// The first `count` Ritz vectors, from the motions measured.
    pub fn turned(&self, measured: &Matrix, count: usize) -> Result<Matrix> {
        let mut turned = Matrix::zeros(measured.rows, count)?;
        (0..count).for_each(|j| measured.mul_add(1.0, self.turn.col(j), turned.col_mut(j)));
        Ok(turned)
    }

    /// Number of motions, beyond the first `free`, that only springs hold which are so weak that a gap follows, or that are as soft
    /// as the bending of a very slender body.
    pub fn weak(&self, free: usize) -> usize {
        let values = &self.values;
        let apart =
            |q: &usize| values[q - 1] <= WEAK_SPRINGS && values[*q] >= GAP * values[q - 1].max(rounding::SUM);
        let springs = (free + 1..values.len()).take_while(|q| *q <= RIGID).filter(apart).last();
        let slender = (free + 1..values.len()).take_while(|q| values[q - 1] < MAY_BE_FREE).last();
        springs.max(slender).map_or(0, |q| q - free)
    }

    /// The doubt about the first motions: if they are free but would be supports with exact entries, or if rounding is
    /// not negligible against the next motion.
    pub fn doubt(&self, digits: Option<Digits>, motions: usize, free: bool) -> Option<Doubt> {
        let resisted = self.values[..motions].iter().fold(0.0f64, |most, v| most.max(v.abs()));
        let rounding = self.noise[..motions].iter().fold(0.0f64, |most, v| most.max(*v));
        let trifle = self.values.get(motions).filter(|_| free).map_or(0.0, |next| TRIFLE * next);
        let digits = digits.filter(|_| motions > 0 && (rounding > trifle || resisted >= MAY_BE_FREE))?;
        Some(Doubt { digits, motions, resisted, rounding, free })
    }
}

/// The error if no gap separates the soft motions.
pub fn unclear(digits: Digits) -> Error {
    let what = format!(
        "the null space cannot be distinguished from soft motions: no gap of {GAP:.0e} above the possible rounding of K, whose \
         entries have {digits}; give it, or coordinates"
    );
    Error::new(Kind::NullSpace, what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_null_space_ends_at_the_largest_leap_below_the_soft_limit() {
        assert_eq!(cut(&[0.1, 0.5, 1.0]).map(|c| c.0), Some(0));
        assert_eq!(cut(&[-1e-17, 1e-16, 1e-4, 1.0]).map(|c| c.0), Some(2));
        assert_eq!(cut(&[1e-20, 1e-16, 1e-9, 1e-4, 1.0]).map(|c| c.0), Some(2));
        assert_eq!(cut(&[0.0, 0.0]).map(|c| c.0), Some(2));
        assert_eq!(cut(&[3e-13, 2e-12, 3e-11, 4e-10, 1.0]), None);
    }

    fn verdict(values: &[f64], noise: f64, digits: Option<Digits>) -> MotionVerdict {
        let all = vec![noise; values.len()];
        let turn = Matrix::default();
        Ritz { values: values.to_vec(), products: vec![1e-15; all.len()], noise: all, turn }.judged(digits)
    }

    #[test]
    fn weak_springs_end_where_motions_stand_apart_and_a_slender_body_has_none() {
        let weak = |values: &[f64], free| {
            let (noise, turn) = (vec![1e-15; values.len()], Matrix::default());
            Ritz { values: values.to_vec(), products: noise.clone(), noise, turn }.weak(free)
        };
        assert_eq!(weak(&[1e-9, 2e-9, 3e-7, 1e-3], 0), 3);
        assert_eq!(weak(&[0.0, 2e-9, 3e-7, 1e-3], 1), 2);
        assert_eq!(weak(&[1e-12, 1e-8, 1e-8, 1e-3], 0), 3);
        assert_eq!(weak(&[1e-7, 4e-6, 3e-5, 1e-3], 0), 0);
        assert_eq!(weak(&[1e-4, 2e-1], 0), 0);
        assert_eq!(weak(&[1e-9; 8], 0), 0);
    }

    #[test]
    fn motions_that_rounding_explains_are_free_where_a_gap_shows_them_and_held_where_none_does() {
        let nine = Some(Digits::Decimal(9));
        let dimension = |verdict| match verdict {
            MotionVerdict::Free { dimension, .. } => Some(dimension),
            _ => None,
        };
        assert_eq!(dimension(verdict(&[-2e-10, 1e-10, 3e-10, 1e-3], 1e-9, nine)), Some(3));
        assert_eq!(dimension(verdict(&[1e-14, 1e-14, 1e-14, 5e-4], 1e-13, None)), Some(3));
        let slender = verdict(&[1e-10, 1e-10, 3e-10, 1e-7, 1e-5], 1e-9, nine);
        assert!(matches!(slender, MotionVerdict::Held { doubtful: 4, .. }), "{slender:?}");
        assert_eq!(verdict(&[-2e-8, 1e-3], 1e-9, nine), MotionVerdict::Indefinite);
        assert!(matches!(verdict(&[-2e-10, 1e-7], 1e-9, nine), MotionVerdict::Unclear(_)));
        // springs stiffer than rounding explains
        let springs = verdict(&[1e-7, 2e-7, 1e-3], 1e-11, nine);
        assert!(matches!(springs, MotionVerdict::Held { doubtful: 0, .. }), "{springs:?}");
    }
}
