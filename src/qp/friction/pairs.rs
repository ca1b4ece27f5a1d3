//! Directions stored with their images under F. They stay valid for all states of the nodes, coefficients, bounds and
//! loads.

use std::collections::VecDeque;
use std::sync::Mutex;

use crate::error::Result;
use crate::linalg::dense::growing::Growing;
use crate::linalg::vector::{axpy, dot, norm};
use crate::numbers::rounding;
use crate::platform::memory::headroom;
use crate::platform::{interrupt, tally};
use crate::qp::between_solves::locked;
use crate::qp::friction::face::Model;

/// Limit of pairs; the oldest pair is dropped first.
const MOST: usize = 200;
/// Multiplications per row and square of the number of pairs in a step beside its product: the images of all pairs on a new face, made
/// orthonormal.
const BESIDE: usize = 2;
/// So many multiplications are cheap beside all else that a step does.
const CHEAP: usize = 1_500_000;

/// Data that solves pass to later solves with equal F, G and rows.
#[derive(Debug, Default, Clone)]
pub struct Pairs {
    kept: VecDeque<Pair>,
    /// Pairs dropped before the first one kept.
    dropped: usize,
}

/// A direction of length 1, orthogonal to the others, with its image.
#[derive(Debug, Clone)]
pub struct Pair {
    pub v: Vec<f64>,
    /// `F v`
    pub image: Vec<f64>,
    /// `|G'(G G')^+ G v|`, the imbalance due to rounding.
    pub unbalanced: f64,
}

/// Pairs for some rows of a problem, while no solve uses them.
#[derive(Default)]
pub struct PairsBetween {
    kept: Mutex<Option<Box<(Vec<usize>, Pairs)>>>,
    answer: Mutex<Option<Box<DualAnswer>>>,
}

/// The last answer with friction, for measurements.
pub struct DualAnswer {
    /// The rows that took part.
    pub rows: Vec<usize>,
    pub x: Vec<f64>,
    pub alpha: Vec<f64>,
}

impl PairsBetween {
    /// The pairs for these rows; pairs for other rows are dropped.
    pub fn take(&self, rows: &[usize]) -> Option<Pairs> {
        locked(&self.kept).take().filter(|kept| kept.0 == rows).map(|kept| kept.1)
    }

    /// Keeps the newest pairs of these rows, as many as save more than they cost: with as many new ones, minimisations over them
    /// must be cheap, or not dearer than a product, of `work` multiplications.
    pub fn keep(&self, rows: &[usize], mut pairs: Pairs, work: usize) {
        let beside = |count: usize| BESIDE.saturating_mul(rows.len()).saturating_mul(4 * count * count);
        while beside(pairs.count()) > work.max(CHEAP) {
            pairs.kept.pop_front();
        }
        *locked(&self.kept) = Some(Box::new((rows.to_vec(), pairs)));
    }

    /// Drops the pairs, so that earlier solves do not affect the next one.
    pub fn forget(&self) {
        *locked(&self.kept) = None;
    }

    pub fn keep_answer(&self, answer: DualAnswer) {
        *locked(&self.answer) = Some(Box::new(answer));
    }

    pub fn take_answer(&self) -> Option<DualAnswer> {
        locked(&self.answer).take().map(|answer| *answer)
    }
}

/// The combination of all pairs that minimises the residual of the linear model.
pub struct Step {
    pub dx: Vec<f64>,
    pub dg: Vec<f64>,
    /// Remaining part of the residual.
    pub rest: f64,
}

impl Step {
    /// `x + t dx` and `g + t dg`
    pub fn from(&self, x: &[f64], g: &[f64], t: f64) -> (Vec<f64>, Vec<f64>) {
        let (mut x, mut g) = (x.to_vec(), g.to_vec());
        axpy(t, &self.dx, &mut x);
        axpy(t, &self.dg, &mut g);
        (x, g)
    }
}

impl Pairs {
    pub fn count(&self) -> usize {
        self.kept.len()
    }

    /// The pairs if they have m rows; otherwise none.
    pub fn of_order(self, order: usize) -> Self {
        if self.kept.iter().all(|pair| pair.v.len() == order) {
            self
        } else {
            Self::default()
        }
    }

    /// Copies for a problem with `more` rows, on which they are 0.
    pub fn extended(&self, more: usize) -> Self {
        let mut all = self.clone();
        for pair in &mut all.kept {
            pair.v.resize(pair.v.len() + more, 0.0);
            pair.image.resize(pair.image.len() + more, 0.0);
        }
        all
    }

    /// Images for supports, the rows from `first` on, whose stiffness is multiplied by `by`.
    pub fn stiffen(&mut self, first: usize, by: f64) {
        let images = self.kept.iter_mut().flat_map(|pair| &mut pair.image[first..]);
        images.for_each(|image| *image /= by);
    }

    /// The unit vector that v adds to the directions kept; none if v adds nothing. Combinations of directions that nearly agree would
    /// multiply the rounding of `G v`. In two passes, as rounding grows with what is removed.
    pub fn orthonormal(&self, mut v: Vec<f64>) -> Option<Vec<f64>> {
        for least in [0.0, rounding::METHOD] {
            let size = norm(&v);
            if !(size > least && size < f64::INFINITY) {
                return None;
            }
            v.iter_mut().for_each(|v| *v /= size);
            self.kept.iter().for_each(|pair| axpy(-dot(&pair.v, &v), &pair.v, &mut v));
        }
        Some(v)
    }

    pub fn keep(&mut self, pair: Pair) {
        if self.kept.len() >= MOST {
            self.kept.pop_front();
            self.dropped += 1;
        }
        self.kept.push_back(pair);
    }

    /// Appends the images that the model does not have yet, reduced, with the rounding of `G v` and `F v`; pairs that were dropped leave
    /// it.
    fn reduce(&self, model: &mut Model) -> Result<()> {
        if model.images.0 != self.dropped {
            model.images = (self.dropped, Growing::default());
        }
        let (known, m) = (model.images.1.columns(), model.face.coordinates.len());
        let rows = m + self.count();
        let _room = headroom((self.count() - known) * rows * size_of::<f64>(), "directions on a face")?;
        let column = |(j, Pair { v, image, unbalanced }): (usize, &Pair)| {
            let mut column = model.reduced(model.face.image(v, image))?;
            column.resize(rows, 0.0);
            column[m + j] = 16.0 * f64::EPSILON * (norm(image) + 1.0) + unbalanced / model.face.rho;
            Ok(column)
        };
        let columns = self.kept.iter().enumerate().skip(known).map(column).collect::<Result<_>>()?;
        model.images.1.extend(columns, rounding::METHOD);
        Ok(())
    }

    /// `dx = V c`, `c = argmin | [L V; P w (W'F V + D S V); N] c + [first; P w q; 0] |`, with N = diag of the rounding of
    /// `G v` and `F v`: without N, pairs of far larger steps would seem to reduce the residual by their rounding.
    pub fn minimise(&self, model: &mut Model, (x, r): (&[f64], &[f64])) -> Result<Step> {
        interrupt::check()?;
        tally::costly();
        let mut left = model.reduced(model.face.residual(x, r))?;
        self.reduce(model)?;
        let (m, whole) = (left.len(), norm(&left));
        left.resize(m + self.kept.len(), 0.0);
        let c = model.images.1.solve(&mut left);
        let rest = norm(&left) / whole.max(f64::MIN_POSITIVE);
        let (mut dx, mut dg) = (vec![0.0; m], vec![0.0; m]);
        for (c, pair) in c.iter().zip(&self.kept).filter(|(c, _)| **c != 0.0) {
            axpy(-c, &pair.v, &mut dx);
            axpy(-c, &pair.image, &mut dg);
        }
        Ok(Step { dx, dg, rest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_serve_the_rows_that_they_are_of_and_no_others() {
        let between = PairsBetween::default();
        between.keep(&[0, 2], Pairs::default(), 0);
        assert!(between.take(&[0, 2]).is_some() && between.take(&[0, 2]).is_none());
        between.keep(&[0, 2], Pairs::default(), 0);
        assert!(between.take(&[0, 1]).is_none() && between.take(&[0, 2]).is_none());
        between.keep(&[0, 2], Pairs::default(), 0);
        between.forget();
        assert!(between.take(&[0, 2]).is_none());
    }

    #[test]
    fn a_direction_that_nearly_agrees_with_others_is_kept_as_what_it_adds_to_them() {
        let mut pairs = Pairs::default();
        for v in [[3.0, 4.0, 0.0], [3.0, 4.0, 1e-7]] {
            let v = pairs.orthonormal(v.to_vec()).unwrap();
            pairs.keep(Pair { v, image: vec![], unbalanced: 0.0 });
        }
        let [first, second] = [0, 1].map(|k| &pairs.kept[k].v);
        assert!(dot(first, second).abs() < 1e-16 && (norm(second) - 1.0).abs() < 1e-15, "{second:?}");
        assert!((second[2] - 1.0).abs() < 1e-15);
        for nothing in [[0.0; 3], [6.0, 8.0, 0.0], [f64::NAN, 0.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
            assert!(pairs.orthonormal(nothing.to_vec()).is_none(), "{nothing:?}");
        }
        assert!(pairs.orthonormal(vec![0.0, 1e-100, 0.0]).is_some());
    }

    /// 30 pairs of 1000 rows: 60 with those of the next solve, 2 x 1000 x 3600 multiplications.
    #[test]
    fn no_more_pairs_are_kept_than_are_cheap_or_no_dearer_than_a_product() {
        for (work, kept) in [(7_200_000, 30), (7_199_999, 29), (0, 13)] {
            let (between, mut pairs) = (PairsBetween::default(), Pairs::default());
            (0..30).for_each(|_| pairs.keep(Pair { v: vec![], image: vec![], unbalanced: 0.0 }));
            let rows: Vec<usize> = (0..1000).collect();
            between.keep(&rows, pairs, work);
            assert_eq!(between.take(&rows).unwrap().count(), kept, "{work}");
        }
    }
}
