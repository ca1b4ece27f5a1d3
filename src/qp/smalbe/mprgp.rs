//! MPRGP, modified proportioning with reduced gradient projections (Dostal 2009, chapter 5), for
//!
//! ```text
//! q(x) = 1/2 x'H x - c'x -> min   subject to   x_i >= 0 (i bounded)
//! ```
//!
//! An expansion first tries the projected conjugate gradient step; if q does not decrease, the step of fixed length
//! follows.

use crate::error::Result;
use crate::linalg::vector::{axpy, dot};
use crate::qp::gradient::{at_bound, feasible_step, Split};

/// H, given by its products.
pub trait Hessian {
    /// `H p`, followed by further entries that are linear in p.
    fn product(&mut self, p: &[f64]) -> Result<Vec<f64>>;
    /// An approximation of `H^-1 r` on the face of the rows that are not held; 0 on the others, where r is also 0.
    fn precondition(&mut self, held: &[bool], r: &[f64]) -> Result<Vec<f64>>;
}

/// The result of a step.
pub enum Move {
    ConjugateGradient,
    Expansion,
    Proportioning,
    /// q decreases without end along `-p`.
    Unbounded {
        p: Vec<f64>,
    },
}

#[derive(Debug, Clone, Copy)]
pub struct Rule {
    /// Gamma > 0 of the proportionality test, no unit.
    pub gamma: f64,
    /// Fixed length of a gradient projection, below 2 / |H|.
    pub step: f64,
    /// `p'H p` counts as zero below this multiple of `p'p`.
    pub flat: f64,
}

/// x >= 0 with its gradient `g = H x - c`, and its parts on the face. Products, and so g, may have further entries,
/// linear in x, which are updated in all steps.
pub struct Bounded<'a> {
    bounded: &'a [bool],
    pub x: Vec<f64>,
    pub g: Vec<f64>,
    pub split: Split,
    /// Search direction of the last conjugate gradient step on this face, with its image: (p, H p).
    conjugate: Option<(Vec<f64>, Vec<f64>)>,
}

impl<'a> Bounded<'a> {
    /// The nearest x within the bounds; its gradient is not yet known.
    pub fn new(bounded: &'a [bool], mut x: Vec<f64>) -> Self {
        clip(bounded, &mut x);
        let (g, split) = (vec![0.0; x.len()], Split::of(at_bound(bounded, &x)));
        Self { bounded, x, g, split, conjugate: None }
    }

    /// Sets another gradient at this x: q itself has changed, or g was recomputed.
    pub fn set_gradient(&mut self, g: Vec<f64>) {
        self.g = g;
        self.conjugate = None;
        self.update();
    }

    /// One step: towards the minimum on the face if x is proportional, otherwise off the face.
    pub fn step(&mut self, hessian: &mut dyn Hessian, rule: &Rule) -> Result<Move> {
        if self.is_proportional(rule) {
            self.explore(hessian, rule)
        } else {
            self.proportion(hessian, rule)
        }
    }

    /// `|g^C|^2 <= Gamma^2 (g^R)'g^F` with the reduced free gradient `g^R = min(x / step, g^F)`: the part that a step of
    /// fixed length can still move on the face.
    fn is_proportional(&self, rule: &Rule) -> bool {
        let reduced = |i: usize| match self.bounded[i] {
            true => self.split.free[i].min(self.x[i] / rule.step),
            false => self.split.free[i],
        };
        let face: f64 = (0..self.x.len()).map(|i| reduced(i) * self.split.free[i]).sum();
        dot(&self.split.chopped, &self.split.chopped) <= rule.gamma * rule.gamma * face
    }

    /// A conjugate gradient step if it stays within the bounds, otherwise an expansion of the active set.
    fn explore(&mut self, hessian: &mut dyn Hessian, rule: &Rule) -> Result<Move> {
        let p = self.direction(hessian)?;
        let image = hessian.product(&p)?;
        let (t, bound) =
            (self.minimum_along(&p, &image, rule), feasible_step(&self.x, &p, |i| self.bounded[i]));
        if t <= bound && t.is_finite() {
            let same_face = self.advance(t, &p, &image);
            self.conjugate = same_face.then_some((p, image));
            return Ok(Move::ConjugateGradient);
        }
        if bound.is_infinite() {
            return Ok(Move::Unbounded { p });
        }
        if !(t.is_finite() && self.project_if_lower(hessian, t, &p)?) {
            self.advance(bound, &p, &image);
            let free = self.split.free.clone();
            self.project(hessian, rule.step, &free)?;
        }
        Ok(Move::Expansion)
    }

    /// The proportioning step, the exact minimum along the chopped gradient: rows leave the active set.
    fn proportion(&mut self, hessian: &mut dyn Hessian, rule: &Rule) -> Result<Move> {
        let p = self.split.chopped.clone();
        let image = hessian.product(&p)?;
        let t = self.minimum_along(&p, &image, rule);
        if t.is_infinite() {
            return Ok(Move::Unbounded { p });
        }
        self.advance(t, &p, &image);
        self.conjugate = None;
        Ok(Move::Proportioning)
    }

    /// `p = z - (z'H p_old / p_old'H p_old) p_old`, z the preconditioned g^F.
    fn direction(&mut self, hessian: &mut dyn Hessian) -> Result<Vec<f64>> {
        let mut p = hessian.precondition(&self.split.active, &self.split.free)?;
        if let Some((old, image)) = self.conjugate.take() {
            let beta = dot(&p, &image) / dot(&old, &image);
            axpy(-beta, &old, &mut p);
        }
        Ok(p)
    }

    /// t of the minimum of `q(x - t p)`; infinite if q has no curvature.
    fn minimum_along(&self, p: &[f64], image: &[f64], rule: &Rule) -> f64 {
        let curvature = dot(p, image);
        if curvature <= rule.flat * dot(p, p) {
            f64::INFINITY
        } else {
            dot(&self.g, p) / curvature
        }
    }

    /// `x - t p` for a t within the bounds; rows that meet their bound there are set to exactly 0. Returns whether the
    /// face is unchanged.
    fn advance(&mut self, t: f64, p: &[f64], image: &[f64]) -> bool {
        for ((x, p), bounded) in self.x.iter_mut().zip(p).zip(self.bounded) {
            let hits = *bounded && *p > 0.0 && *x <= t * p;
            *x = if hits { 0.0 } else { *x - t * p };
        }
        axpy(-t, image, &mut self.g);
        self.update()
    }

    /// The step to the point within the bounds nearest to `x - t p`, with its image: (s, H s).
    fn way(&self, hessian: &mut dyn Hessian, t: f64, p: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        let mut s = self.x.clone();
        axpy(-t, p, &mut s);
        clip(self.bounded, &mut s);
        axpy(-1.0, &self.x, &mut s);
        let image = hessian.product(&s)?;
        Ok((s, image))
    }

    /// Moves to the point nearest to `x - t p` if q decreases.
    fn project_if_lower(&mut self, hessian: &mut dyn Hessian, t: f64, p: &[f64]) -> Result<bool> {
        let (s, image) = self.way(hessian, t, p)?;
        let lower = dot(&self.g, &s) + 0.5 * dot(&s, &image) < 0.0;
        if lower {
            self.walk(&s, &image);
        }
        Ok(lower)
    }

    /// Moves to the point nearest to `x - t p`.
    fn project(&mut self, hessian: &mut dyn Hessian, t: f64, p: &[f64]) -> Result<()> {
        let (s, image) = self.way(hessian, t, p)?;
        self.walk(&s, &image);
        Ok(())
    }

    fn walk(&mut self, s: &[f64], image: &[f64]) {
        axpy(1.0, s, &mut self.x);
        clip(self.bounded, &mut self.x);
        axpy(1.0, image, &mut self.g);
        self.update();
    }

    /// Returns whether the active set is unchanged.
    fn update(&mut self) -> bool {
        self.split.update(at_bound(self.bounded, &self.x), &self.g)
    }
}

/// Sets bounded entries below zero to zero.
fn clip(bounded: &[bool], x: &mut [f64]) {
    x.iter_mut().zip(bounded).filter(|(x, bounded)| **bounded && **x < 0.0).for_each(|(x, _)| *x = 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Operator, Packed};

    impl Hessian for Packed {
        fn product(&mut self, p: &[f64]) -> Result<Vec<f64>> {
            let mut image = vec![0.0; p.len()];
            self.apply(p, &mut image);
            Ok(image)
        }

        fn precondition(&mut self, _: &[bool], r: &[f64]) -> Result<Vec<f64>> {
            Ok(r.to_vec())
        }
    }

    const RULE: Rule = Rule { gamma: 1.0, step: 1.5 / 4.0, flat: 1e-11 };

    /// (-1, 2, -1) on m rows, of norm below 4.
    fn chain(m: usize) -> Packed {
        let mut h = Packed::zeros(m).unwrap();
        for i in 0..m {
            h.add(i, i, 2.0);
            (i > 0).then(|| h.add(i, i - 1, -1.0));
        }
        h
    }

    fn start<'a>(h: &mut Packed, bounded: &'a [bool], x: Vec<f64>, c: &[f64]) -> Bounded<'a> {
        let mut point = Bounded::new(bounded, x);
        let mut g = h.product(&point.x).unwrap();
        axpy(-1.0, c, &mut g);
        point.set_gradient(g);
        point
    }

    #[test]
    fn no_step_raises_q_and_every_kind_is_taken() {
        let (m, mut kinds) = (40, [0; 3]);
        let bounded: Vec<bool> = (0..m).map(|i| i % 7 != 6).collect();
        for wave in 1..20 {
            let mut h = chain(m);
            let c: Vec<f64> = (0..m).map(|i| (0.3 * (wave * i) as f64).sin() - 0.1).collect();
            let mut point = start(&mut h, &bounded, vec![0.4 * wave as f64; m], &c);
            let q = |x: &[f64], g: &[f64]| 0.5 * (dot(x, g) - dot(x, &c));
            while point.split.norm() > 1e-12 {
                let before = q(&point.x, &point.g);
                match point.step(&mut h, &RULE).unwrap() {
                    Move::ConjugateGradient => kinds[0] += 1,
                    Move::Expansion => kinds[1] += 1,
                    Move::Proportioning => kinds[2] += 1,
                    Move::Unbounded { p } => panic!("H is positive definite, {p:?}"),
                }
                assert!(q(&point.x, &point.g) <= before + 1e-13 * before.abs(), "wave {wave}");
                assert!(point.x.iter().zip(&bounded).all(|(x, bounded)| !bounded || *x >= 0.0));
            }
        }
        assert!(kinds.iter().all(|taken| *taken > 5), "{kinds:?}");
    }

    #[test]
    fn only_what_the_fixed_step_can_move_on_the_face_counts_against_the_chopped_gradient() {
        // H = I: g = x - c; row 0 is active with g = -1
        let kind = |x: f64, c: f64, bounded: [bool; 2]| {
            let mut h = Packed::zeros(2).unwrap();
            (0..2).for_each(|i| h.add(i, i, 1.0));
            let mut point = start(&mut h, &bounded, vec![0.0, x], &[1.0, c]);
            point.step(&mut h, &RULE).unwrap()
        };
        // g^F = 2 on a row that is free to move, on a row with x / step = 0.01 / 0.375, on a row without a bound
        assert!(matches!(kind(3.0, 1.0, [true, true]), Move::ConjugateGradient));
        assert!(matches!(kind(0.01, -1.99, [true, true]), Move::Proportioning));
        assert!(matches!(kind(0.01, -1.99, [true, false]), Move::ConjugateGradient));
    }
}
