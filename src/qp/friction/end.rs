//! The method from start to verdict: what is tried, in which order, and the answer.

use crate::error::{Kind, Result};
use crate::linalg::vector::{axpy, norm, ratio};
use crate::qp::friction::cones::Cones;
use crate::qp::friction::coordinates::Law;
use crate::qp::friction::direct::Dense;
use crate::qp::friction::face::{Face, State};
use crate::qp::friction::nearest::{project, Projected};
use crate::qp::friction::newton::{Laws, Point, Run};
use crate::qp::friction::path::{Solves, Way};
use crate::qp::friction::{
    FrictionLimits, FrictionObserver, FrictionProblem, FrictionSolution, FrictionStart,
};
use crate::qp::{AcceptanceTest, Direct, Verdict};

/// rho at first: rows have the compliance `b K_d^-1 b' + C = 1`.
const RHO: f64 = 0.2;
/// In these multiples where the merit is not halved for long; with the first two comes a path along smoothed laws, before
/// them where the merit is far from zero.
const MULTIPLES: [f64; 5] = [5.0, 0.2, 25.0, 0.04, 1.0];
/// A merit above this part of the scale is no better than the start.
const FAR: f64 = 1e-3;
/// One below it may be as good as rounding allows.
const NEAR: f64 = 1e-7;
/// The first path ends where states are known, the second goes on near to sliding.
const PATHS: [Way; 2] = [
    Way { relaxed: 0.0, last: 1e-3, solves: Solves::Pairs { products: 60 } },
    Way { relaxed: 1.0, last: LAST, solves: Solves::Pairs { products: 100 } },
];
/// eps of the first that is rounding.
const LAST: f64 = 1e-14;
/// rho of the paths with dense matrices, and by how much bounds are relaxed.
const DENSE: [(f64, f64); 4] = [(RHO, 0.0), (RHO, 1.0), (5.0 * RHO, 1.0), (RHO, 3.0)];
/// Each time that the answer is not accepted the laws are to be met this much better, ...
const TIGHTER: f64 = 0.1;
/// ... so many times at most.
const REFUSALS: usize = 3;

/// An answer of the laws of friction, or why there is none.
pub fn friction(
    problem: FrictionProblem,
    limits: FrictionLimits,
    start: FrictionStart,
    judge: &mut dyn AcceptanceTest,
    observer: &mut dyn FrictionObserver,
) -> Result<FrictionSolution> {
    let alpha = start.alpha.map_or_else(|| vec![0.0; problem.e.len()], <[f64]>::to_vec);
    let (mut run, first) = Run::new(problem, limits, start, observer)?;
    run.last =
        Point { x: first.point.clone(), alpha: alpha.clone(), merit: f64::INFINITY, ..Point::default() };
    if !first.met {
        let margin = ratio(norm(&first.left), norm(problem.e));
        return Ok(run.solution(Verdict::Infeasible { direction: first.left, margin }));
    }
    let verdict = match run.solve(limits, (first, alpha), judge) {
        Ok(verdict) => verdict,
        Err(error) => Verdict::of_refusal(error)?,
    };
    Ok(run.solution(verdict))
}

/// Products of the linear problem in which the states of an answer, its slip directions and slips are known: what friction is
/// measured against.
pub fn known_face(
    problem: FrictionProblem,
    limits: FrictionLimits,
    answer: &FrictionSolution,
    observer: &mut dyn FrictionObserver,
) -> Result<usize> {
    let (mut run, first) = Run::new(problem, limits, FrictionStart::default(), observer)?;
    let g = run.gradient(&answer.x)?;
    let r = run.gaps(&g, &answer.alpha);
    run.counts.products = 0;
    let model = run.model(Face::at(problem.cones, &answer.x, &r, RHO))?;
    let (x, mut g) = (first.point, run.gradient(&vec![0.0; r.len()])?);
    run.measure(&g, limits.tolerance)?;
    g = run.gradient(&x)?;
    let alpha = run.turned(&model, &x, &g, &vec![0.0; problem.e.len()])?;
    let start = run.point(Laws { cones: problem.cones, rho: RHO }, x, g, alpha)?;
    let preconditioner = problem.preconditioner.map(|m| m.on(&model.face)).transpose()?;
    let size = norm(&model.reduced(model.face.residual(&start.x, &start.r))?);
    let (mut there, mut rest) = ((start.x.clone(), start.r.clone()), 1.0);
    while rest * size > run.small && run.counts.products < limits.products {
        let v = run.direction(&model, preconditioner.as_deref(), (&there.0, &there.1))?;
        if !run.keep(v, &start, &model)? {
            break;
        }
        let step = run.pairs.minimise(&model, model.face.residual(&start.x, &start.r))?;
        rest = step.rest;
        there = (start.x.clone(), start.r.clone());
        axpy(1.0, &step.dx, &mut there.0);
        axpy(1.0, &step.dg, &mut there.1);
    }
    Ok(run.counts.products + 1)
}

impl<'a> Run<'a, '_> {
    fn solve(
        &mut self,
        limits: FrictionLimits,
        (first, alpha): (Projected, Vec<f64>),
        judge: &mut dyn AcceptanceTest,
    ) -> Result<Verdict> {
        let g = self.gradient(&first.point)?;
        self.measure(&g, limits.tolerance)?;
        let laws = Laws { cones: self.problem.cones, rho: RHO };
        self.allow_for_balance(laws, &first.point)?;
        let start = self.begin(laws, &first.point, &g, &alpha)?;
        self.last.clone_from(&start);
        if !(start.merit.is_finite() && self.small.is_finite()) {
            return Ok(Verdict::Stalled);
        }
        let mut now = self.newton(laws, start.clone())?;
        for refusals in 0.. {
            if !self.is_met(&now) && now.merit <= NEAR * self.scale {
                // rounding may be all that is left
                let near = self.finished(now.clone())?;
                if judge.accepts(&near.x, &near.alpha)? {
                    self.last = near;
                    break;
                }
            }
            if !self.is_met(&now) {
                now = self.otherwise(limits.direct, &start, now)?;
            }
            if !self.is_met(&now) {
                let over = self.counts.products >= self.limit;
                return Ok(if over { Verdict::StepLimit } else { Verdict::Stalled });
            }
            now = self.finished(now)?;
            self.last.clone_from(&now);
            if judge.accepts(&now.x, &now.alpha)? {
                break;
            }
            if refusals == REFUSALS {
                return Ok(Verdict::Inaccurate);
            }
            self.small *= TIGHTER;
            now = self.newton(laws, now)?;
        }
        Ok(Verdict::Solved)
    }

    /// Where Newton's method has not ended well: other rho, the smoothed laws, other starts, dense systems; until one does.
    fn otherwise(&mut self, direct: Option<Direct>, start: &Point, stalled: Point) -> Result<Point> {
        let mut now = stalled;
        for (count, multiple) in MULTIPLES.into_iter().enumerate() {
            let far = now.merit > FAR * self.scale;
            for by_path in [far, !far] {
                match PATHS.get(count).filter(|_| by_path) {
                    Some(&way) => {
                        self.tried.paths += 1;
                        now = self.along_path(start, RHO, way)?;
                    }
                    None if by_path => {}
                    None => {
                        self.tried.restarts += 1;
                        now = self.again(start, now, multiple * RHO)?;
                    }
                }
                if self.is_over(&now) {
                    return Ok(now);
                }
            }
        }
        for second in [Self::without_friction, Self::sticking] {
            if let Some(second) = second(self, start)? {
                now = self.newton(Laws { cones: self.problem.cones, rho: RHO }, second)?;
            }
            if self.is_over(&now) {
                return Ok(now);
            }
        }
        let dense = direct.map(|direct| Dense::new(&self.problem, direct)).transpose();
        let dense = dense.or_else(|error| if error.kind == Kind::Memory { Ok(None) } else { Err(error) })?;
        if let Some(dense) = dense.flatten() {
            for (rho, relaxed) in DENSE {
                self.tried.dense_paths += 1;
                now =
                    self.along_path(start, rho, Way { relaxed, last: LAST, solves: Solves::Dense(&dense) })?;
                if self.is_over(&now) {
                    break;
                }
            }
        }
        Ok(now)
    }

    fn is_over(&self, now: &Point) -> bool {
        self.is_met(now) || self.counts.products >= self.limit
    }

    /// With another rho, from where it stands or, if that is far from an answer, from the start.
    fn again(&mut self, start: &Point, now: Point, rho: f64) -> Result<Point> {
        let laws = Laws { cones: self.problem.cones, rho };
        let near = now.merit <= FAR * self.scale;
        let from = if near { &now } else { start };
        let begun = self.begin(laws, &from.x, &from.g, &from.alpha)?;
        self.newton(laws, begun)
    }

    /// Newton's method from the end of a path that begins at the start.
    fn along_path(&mut self, start: &Point, rho: f64, way: Way) -> Result<Point> {
        let laws = Laws { cones: self.problem.cones, rho };
        let begun = self.point(laws, start.x.clone(), start.g.clone(), start.alpha.clone())?;
        let end = self.path(laws, begun, way)?;
        if self.is_met(&end) {
            return Ok(end);
        }
        self.newton(laws, end)
    }

    /// The start that the answer without friction is, where there is one.
    fn without_friction(&mut self, start: &Point) -> Result<Option<Point>> {
        self.tried.frictionless = true;
        let cones = self.problem.cones.frictionless();
        let first = project(&self.problem, &cones, self.motions.as_ref(), &start.x)?;
        if !first.met {
            return Ok(None);
        }
        let laws = Laws { cones: &cones, rho: RHO };
        let g = self.gradient(&first.point)?;
        let begun = self.begin(laws, &first.point, &g, &start.alpha)?;
        let found = self.newton(laws, begun)?;
        self.within(&found)
    }

    /// The start that the answer is where all nodes that the start has closed stick.
    fn sticking(&mut self, start: &Point) -> Result<Option<Point>> {
        self.tried.sticking = true;
        let mut face = Face::at(self.problem.cones, &start.x, &start.r, RHO);
        let sticks = Law::Free { damping: 0.0, shift: 0.0 };
        let mut k = 0;
        for (i, node) in self.problem.cones.nodes().iter().enumerate() {
            k += usize::from(node.normal.is_some());
            let carries = face.closed[i] || face.states[i] != State::Open;
            for at in &mut face.coordinates[k..k + node.tangents().len()] {
                at.coupling = None;
                at.law = if carries { sticks } else { Law::Held { value: 0.0 } };
            }
            k += node.tangents().len();
        }
        let model = self.model(face)?;
        let step = self.enough(&model, start)?;
        let (mut x, mut g) = (start.x.clone(), start.g.clone());
        axpy(1.0, &step.dx, &mut x);
        axpy(1.0, &step.dg, &mut g);
        let alpha = self.turned(&model, &x, &g, &start.alpha)?;
        let laws = Laws { cones: self.problem.cones, rho: RHO };
        let found = self.point(laws, x, g, alpha)?;
        self.within(&found)
    }

    /// The nearest point within the cones, with its product.
    fn within(&mut self, found: &Point) -> Result<Option<Point>> {
        let laws = Laws { cones: self.problem.cones, rho: RHO };
        let inside = project(&self.problem, laws.cones, self.motions.as_ref(), &found.x)?;
        if !inside.met {
            return Ok(None);
        }
        let g = self.gradient(&inside.point)?;
        self.begin(laws, &inside.point, &g, &found.alpha).map(Some)
    }

    /// The answer: exact zeros, forces exactly within the cones, gaps by a product of their own.
    fn finished(&mut self, now: Point) -> Result<Point> {
        let laws = Laws { cones: self.problem.cones, rho: RHO };
        let mut y = now.x.clone();
        // open nodes by their gaps: exactly 0 in the end
        for row in laws.cones.nodes().iter().filter_map(|node| node.normal) {
            let trial = now.x[row] - RHO * now.r[row];
            y[row] = if trial <= 0.0 { trial.min(y[row]) } else { y[row] };
        }
        let inside = project(&self.problem, laws.cones, self.motions.as_ref(), &y)?;
        let x = if inside.met { inside.point } else { now.x };
        let g = self.gradient(&x)?;
        let model = self.model(Face::at(laws.cones, &x, &self.gaps(&g, &now.alpha), RHO))?;
        let turned = self.turned(&model, &x, &g, &now.alpha)?;
        let (as_is, turned) =
            (self.point(laws, x.clone(), g.clone(), now.alpha)?, self.point(laws, x, g, turned)?);
        Ok(if turned.merit < as_is.merit { turned } else { as_is })
    }

    fn solution(self, verdict: Verdict) -> FrictionSolution {
        let Point { x, alpha, r, merit, .. } = self.last;
        let cones: &'a Cones = self.problem.cones;
        let states = if r.len() == x.len() { Face::at(cones, &x, &r, RHO).states } else { Vec::new() };
        let merit = ratio(merit, self.scale);
        FrictionSolution {
            x,
            alpha,
            states,
            scale: self.scale,
            merit,
            verdict,
            counts: self.counts,
            tried: self.tried,
            pairs: self.pairs,
        }
    }
}
