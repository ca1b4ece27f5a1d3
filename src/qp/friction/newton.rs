//! The semismooth Newton method: the linear model of a face is minimised over all stored pairs, and each step adds one
//! pair.

use crate::error::Result;
use crate::linalg::vector::dot;
use crate::linalg::Operator;
use crate::numbers::friction::{CYCLING, INNER_TRIALS, MODEL_SOLVED, NEWTON_FALLS, RHO, TRIALS};
use crate::platform::{interrupt, tally};
use crate::qp::friction::face::{Face, Model};
use crate::qp::friction::motions::{Motions, Turned};
use crate::qp::friction::pairs::{Pair, Pairs, Step};
use crate::qp::friction::{FrictionProblem, OnFace, Slide};
use crate::qp::{Counts, Observer, Rung, StepKind, StepReport};

/// Limit of directions on one face.
const DIRECTIONS: usize = 10;
const INNER_STEPS: usize = 3;
const STEPS: usize = 4;
const PRODUCTS: usize = 8;

/// x with `G x = e`, `g = F x - d`, `r = g - G'alpha`, and the violation of the laws.
#[derive(Clone, Default)]
pub struct Point {
    pub x: Vec<f64>,
    pub g: Vec<f64>,
    pub alpha: Vec<f64>,
    pub r: Vec<f64>,
    pub merit: f64,
}

pub struct Run<'a, 'w> {
    pub problem: FrictionProblem<'a>,
    pub motions: Motions<'a>,
    /// `(G G')^+`
    pub all_rows: Turned,
    pub pairs: Pairs,
    pub counts: Counts,
    /// Limit of products.
    pub limit: usize,
    /// `|P d|`, to which gaps are relative, and the merit that counts as zero.
    pub scale: f64,
    pub small: f64,
    /// The best point so far.
    pub last: Point,
    /// A slide that weak supports have shown.
    pub slide: Option<Slide>,
    pub observer: &'w mut dyn Observer,
}

impl Run<'_, '_> {
    /// Continues from `now` until the laws are satisfied, or the merit falls too slowly: steps to new faces with the existing pairs
    /// while the merit falls, then one with a new pair.
    pub fn newton(&mut self, mut now: Point) -> Result<Point> {
        let mut best = (now.merit, self.counts.newton, self.counts.products);
        let mut inner = 0;
        while !self.is_met(&now) {
            let mut model = self.model(Face::at(self.problem.cones, &now.x, &now.r, RHO))?;
            if inner < INNER_STEPS && self.pairs.count() > 0 && Rung::Inner.is_tried() {
                let step = self.pairs.minimise(&mut model, (&now.x, &now.r))?;
                let (next, falls) = self.best_trial(&model, &now, &step, &INNER_TRIALS)?;
                if falls {
                    (now, inner) = (next, inner + 1);
                    continue;
                }
            }
            self.reached(&now);
            if now.merit < CYCLING * best.0 {
                best = (now.merit, self.counts.newton, self.counts.products);
            }
            let most = self.limit.min(best.2 + PRODUCTS);
            if self.counts.newton >= best.1 + STEPS || self.counts.products >= most {
                break;
            }
            let Some((next, falls)) = self.step(&mut model, &now)? else { break };
            self.counts.newton += 1;
            (now, inner) = (next, if falls { 0 } else { INNER_STEPS });
        }
        self.reached(&now);
        Ok(now)
    }

    /// Adds directions to the pairs until a trial reduces the merit, the model is solved or no direction is new; returns whether the
    /// merit fell.
    fn step(&mut self, model: &mut Model, now: &Point) -> Result<Option<(Point, bool)>> {
        let preconditioner = self.problem.preconditioner.map(|m| m.on(&model.face)).transpose()?;
        let mut there = (now.x.clone(), now.r.clone());
        for count in 1..=DIRECTIONS {
            let v = self.direction(model, preconditioner.as_deref(), (&there.0, &there.1))?;
            let is_new = self.keep(v, now, model)?;
            if self.pairs.count() == 0 {
                return Ok(None);
            }
            let step = self.pairs.minimise(model, (&now.x, &now.r))?;
            let (best, falls) = self.best_trial(model, now, &step, &TRIALS)?;
            let is_last = !is_new || count == DIRECTIONS || self.counts.products >= self.limit;
            if falls || step.rest < MODEL_SOLVED || is_last {
                return Ok(Some((best, falls)));
            }
            there = step.from(&now.x, &now.r, 1.0);
        }
        Ok(None)
    }

    /// The first trial that reduces the merit sufficiently, otherwise the best trial; a is that of the old face at the
    /// new point.
    fn best_trial(
        &mut self,
        model: &Model,
        now: &Point,
        step: &Step,
        lengths: &[f64],
    ) -> Result<(Point, bool)> {
        let mut best = Point { merit: f64::INFINITY, ..now.clone() };
        for &t in lengths {
            let (x, g) = step.from(&now.x, &now.g, t);
            let alpha = self.turned(model, &x, &g, &now.alpha)?;
            let next = self.point(x, g, alpha)?;
            if next.merit <= (1.0 - NEWTON_FALLS * t) * now.merit {
                return Ok((next, true));
            }
            if next.merit < best.merit {
                best = next;
            }
        }
        // a step that is NaN is not taken
        let best = if best.merit < f64::INFINITY { best } else { now.clone() };
        Ok((best, false))
    }

    /// The laws are satisfied; false for NaN.
    pub fn is_met(&self, now: &Point) -> bool {
        now.merit <= self.small
    }

    /// Stores the best point, for the case that no answer is found.
    pub fn reached(&mut self, now: &Point) {
        if !(self.last.merit <= now.merit) {
            self.last.clone_from(now);
        }
    }

    pub fn model(&mut self, face: Face) -> Result<Model> {
        self.counts.coarse_factorisations += 2 * usize::from(!self.problem.qp.e.is_empty());
        Model::new(face, &mut self.motions)
    }

    /// The direction from a point with x and r: `v = v0 + Z y`, `G v = 0`.
    ///
    /// ```text
    /// v0 = -rho first;   y = -Q Q M (q - A'da);   y -= w^2 A_Z'(A_Z w^2 A_Z')^+ (G v0 + A_Z y);   v -= G'(G G')^+ G v
    /// ```
    pub fn direction(
        &mut self,
        model: &Model,
        preconditioner: Option<&(dyn OnFace + '_)>,
        (x, r): (&[f64], &[f64]),
    ) -> Result<Vec<f64>> {
        let face = &model.face;
        let mut q = face.residual(x, r);
        let mut v = vec![0.0; x.len()];
        for (q, coordinate) in q.iter_mut().zip(&face.coordinates).filter(|(_, at)| !at.is_free()) {
            coordinate.add(-face.rho * *q, &mut v);
            *q = 0.0;
        }
        model.turned(&mut q)?;
        let mut y: Vec<f64> =
            q.iter().zip(&face.coordinates).map(|(q, at)| q * at.weight(face.rho)).collect();
        if let Some(preconditioner) = preconditioner {
            interrupt::check()?;
            tally::costly();
            self.counts.preconditioned += 1;
            preconditioner.apply(&q, &mut y)?;
        }
        y.iter_mut().for_each(|y| *y = -*y);
        model.balance(&mut y, None)?;
        model.balance(&mut y, None)?;
        let image = self.problem.qp.g_transposed.mul_transposed(&v);
        model.balance(&mut y, Some(&image))?;
        face.add(&y, &mut v);
        self.without_motions(&mut v)?;
        Ok(v)
    }

    /// `v <- v - G'(G G')^+ G v`
    pub fn without_motions(&mut self, v: &mut [f64]) -> Result<()> {
        if self.problem.qp.e.is_empty() {
            return Ok(());
        }
        let beta = self.all_rows.solve(&self.problem.qp.g_transposed.mul_transposed(v))?;
        self.counts.coarse_solves += 1;
        v.iter_mut().enumerate().for_each(|(i, v)| *v -= self.problem.qp.g_transposed.row_dot(i, &beta));
        Ok(())
    }

    /// Adds the pair of a direction, orthonormal to the others, and its image: the only product of a step. False: there is no
    /// new direction.
    pub fn keep(&mut self, v: Vec<f64>, now: &Point, model: &Model) -> Result<bool> {
        let Some(mut v) = self.pairs.orthonormal(v) else { return Ok(false) };
        // normalisation leaves a larger error
        self.without_motions(&mut v)?;
        let none = vec![0.0; self.problem.qp.e.len()];
        let unbalanced = self.imbalance(&v, &none)?.sqrt();
        let image = self.approximate(&v)?;
        self.pairs.keep(Pair { v, image, unbalanced });
        let nodes = self.problem.cones.nodes().iter().zip(&model.face.closed);
        let open: Vec<bool> = nodes.filter_map(|(node, closed)| node.own_normal().map(|_| !closed)).collect();
        self.observer.step(&StepReport {
            kind: StepKind::Newton,
            counts: &self.counts,
            active: &open,
            theta: f64::NAN,
            residual: now.merit,
            free: f64::NAN,
            chopped: f64::NAN,
            small: self.small,
        })?;
        Ok(true)
    }

    /// `F v`, counted.
    pub fn product(&mut self, v: &[f64]) -> Result<Vec<f64>> {
        self.counted(v, |a, image| a.try_apply(v, image))
    }

    /// `F v` or an approximation, counted: steps from a gradient that was computed anew need no more.
    fn approximate(&mut self, v: &[f64]) -> Result<Vec<f64>> {
        self.counted(v, |a, image| a.approximate(v, image))
    }

    fn counted(
        &mut self,
        v: &[f64],
        product: impl Fn(&dyn Operator, &mut [f64]) -> Result<()>,
    ) -> Result<Vec<f64>> {
        interrupt::check()?;
        tally::costly();
        let mut image = vec![0.0; v.len()];
        product(self.problem.qp.a, &mut image)?;
        self.counts.products += 1;
        Ok(image)
    }

    /// `a + da` for a face at x and g.
    pub fn turned(&mut self, model: &Model, x: &[f64], g: &[f64], alpha: &[f64]) -> Result<Vec<f64>> {
        let turn = model.turn(&model.face.residual(x, &self.gaps(g, alpha)))?;
        self.counts.coarse_solves += 1;
        Ok(alpha.iter().zip(turn).map(|(alpha, turn)| alpha + turn).collect())
    }

    /// `r = g - G'a`
    pub fn gaps(&self, g: &[f64], alpha: &[f64]) -> Vec<f64> {
        let g_transposed = self.problem.qp.g_transposed;
        g.iter().enumerate().map(|(i, g)| g - g_transposed.row_dot(i, alpha)).collect()
    }

    /// `merit = |r_E ; (x - NAT(xi))/rho ; G'(G G')^+ (G x - e)/rho|`
    pub fn point(&mut self, x: Vec<f64>, g: Vec<f64>, alpha: Vec<f64>) -> Result<Point> {
        let r = self.gaps(&g, &alpha);
        let law = self.problem.cones.law(&x, &r, RHO);
        let square = dot(&law, &law) + self.balance_missed(&x)?;
        Ok(Point { x, g, alpha, r, merit: square.sqrt() / RHO })
    }

    /// `|G'(G G')^+ (G x - e)|^2`
    pub fn balance_missed(&mut self, x: &[f64]) -> Result<f64> {
        self.imbalance(x, self.problem.qp.e)
    }

    /// As `balance_missed`, for any e.
    fn imbalance(&mut self, x: &[f64], e: &[f64]) -> Result<f64> {
        if e.is_empty() {
            return Ok(0.0);
        }
        let mut left = e.to_vec();
        self.problem.qp.g_transposed.mul_transposed_add(-1.0, x, &mut left);
        self.counts.coarse_solves += 1;
        // NaN stays NaN
        let square = dot(&left, &self.all_rows.solve(&left)?);
        Ok(if square < 0.0 { 0.0 } else { square })
    }
}
