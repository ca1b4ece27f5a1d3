//! The method from start to verdict, and the linear problem with which it is compared.

use crate::error::Result;
use crate::linalg::vector::{norm, ratio};
use crate::numbers::friction::{FINE, NEAR, RHO};
use crate::numbers::qp::TIGHTER;
use crate::qp::friction::cones::Cones;
use crate::qp::friction::face::Face;
use crate::qp::friction::nearest::Projected;
use crate::qp::friction::newton::{Point, Run};
use crate::qp::friction::{FrictionLimits, FrictionProblem, FrictionSolution, FrictionStart};
use crate::qp::{AcceptanceTest, Counts, Effort, Mended, Observer, Rung, Solution, Verdict};

/// ... at most this many times, in addition to the steps from a looser tolerance to the present one.
const REFUSALS: usize = 3;

/// An answer for the laws of friction, or the reason why there is none.
pub fn friction(
    problem: FrictionProblem,
    limits: FrictionLimits,
    start: FrictionStart,
    judge: &mut dyn AcceptanceTest,
    observer: &mut dyn Observer,
) -> Result<FrictionSolution> {
    let alpha = start.alpha.map_or_else(|| vec![0.0; problem.qp.e.len()], <[f64]>::to_vec);
    let (mut run, first) = Run::new(problem, limits, start, observer)?;
    run.last =
        Point { x: first.point.clone(), alpha: alpha.clone(), merit: f64::INFINITY, ..Point::default() };
    if !first.met {
        let margin = ratio(norm(&first.left), norm(problem.qp.e));
        return Ok(run.solution(Verdict::Infeasible { direction: first.left, margin }));
    }
    let verdict = match run.solve(limits, (first, alpha), judge) {
        Ok(verdict) => verdict,
        Err(error) => Verdict::of_refusal(error)?,
    };
    Ok(run.solution(verdict))
}

/// Products in the linear problem in which the states of an answer (x, alpha), its slip directions and slips are known:
/// the reference for the cost of friction.
pub fn known_face(
    problem: FrictionProblem,
    limits: FrictionLimits,
    (x, alpha): (&[f64], &[f64]),
    observer: &mut dyn Observer,
) -> Result<usize> {
    let (mut run, first) = Run::new(problem, limits, FrictionStart::default(), observer)?;
    let g = run.gradient(x)?;
    let r = run.gaps(&g, alpha);
    run.counts.products = 0;
    let mut model = run.model(Face::at(problem.cones, x, &r, RHO))?;
    let (x, mut g) = (first.point, run.gradient(&vec![0.0; r.len()])?);
    run.measure(&g, limits.tolerance)?;
    g = run.gradient(&x)?;
    let alpha = run.turned(&model, &x, &g, &vec![0.0; problem.qp.e.len()])?;
    let start = run.point(x, g, alpha)?;
    let size = norm(&model.reduced(model.face.residual(&start.x, &start.r))?);
    run.enough(&mut model, &start, (run.small / size, usize::MAX))?;
    Ok(run.counts.products + 1)
}

impl<'a> Run<'a, '_> {
    fn solve(
        &mut self,
        limits: FrictionLimits,
        (first, alpha): (Projected, Vec<f64>),
        judge: &mut dyn AcceptanceTest,
    ) -> Result<Verdict> {
        let start = self.begun(limits.tolerance, &first, &alpha)?;
        self.last.clone_from(&start);
        if !(start.merit.is_finite() && self.small.is_finite()) {
            return Ok(Verdict::Stalled);
        }
        let mut now = self.newton(start.clone())?;
        let looser = (limits.tolerance / FINE).log10().ceil().max(0.0);
        let refusals = REFUSALS + looser as usize;
        for refusal in 0..=refusals {
            // only rounding may be left
            let (near, met) = (now.merit <= NEAR * self.scale, self.is_met(&now));
            if near || met {
                let answer = self.finished(&now)?;
                let corrects = (!met || refusal == refusals) && limits.direct.is_some();
                if self.accepted(&answer, corrects, judge)? {
                    return Ok(Verdict::Solved);
                }
                // g has the rounding of earlier, far larger steps; the last product has not
                if met && refusal == refusals {
                    break;
                }
                if met && Rung::Tighter.is_tried() {
                    self.small *= TIGHTER;
                    now = self.newton(answer)?;
                    continue;
                }
            }
            now = self.otherwise(limits, &start, now)?;
            self.reached(&now);
            if !self.is_met(&now) {
                return self.best(limits, judge);
            }
        }
        Ok(Verdict::Inaccurate)
    }

    /// The end without a point that meets the laws: the best point may be as accurate as rounding allows.
    fn best(&mut self, limits: FrictionLimits, judge: &mut dyn AcceptanceTest) -> Result<Verdict> {
        let (last, corrects) = (self.last.clone(), limits.direct.is_some());
        let solved = match last.merit <= NEAR * self.scale {
            true => {
                let answer = self.finished(&last)?;
                self.accepted(&answer, corrects, judge)?
            }
            false => corrects && Rung::Corrected.is_tried() && self.corrected(&last, judge)?,
        };
        if solved {
            return Ok(Verdict::Solved);
        }
        let over = self.counts.products >= self.limit;
        Ok(if over { Verdict::StepLimit } else { Verdict::Stalled })
    }

    /// Whether the answer passes, as it is or, if `corrects`, corrected by better data; then it is kept.
    fn accepted(&mut self, answer: &Point, corrects: bool, judge: &mut dyn AcceptanceTest) -> Result<bool> {
        if judge.accepts(&answer.x, &answer.alpha)? {
            self.last.clone_from(answer);
            return Ok(true);
        }
        Ok(corrects && Rung::Corrected.is_tried() && self.corrected(answer, judge)?)
    }

    /// Whether the point corrected by better data passes; then it is kept.
    fn corrected(&mut self, answer: &Point, judge: &mut dyn AcceptanceTest) -> Result<bool> {
        let (x, alpha, counts) = (answer.x.clone(), answer.alpha.clone(), Counts::default());
        let refused =
            Solution { x, alpha, undetermined: 0, scale: self.scale, verdict: Verdict::Inaccurate, counts };
        let Mended::Accepted(Solution { x, alpha, counts, .. }) = judge.mended(&refused, Effort::AllSets)?
        else {
            return Ok(false);
        };
        self.counts = self.counts + counts;
        let g = self.gradient(&x)?;
        self.last = self.point(x, g, alpha)?;
        Ok(true)
    }

    /// The answer: exact zeros, forces exactly within the cones, gaps from a separate product.
    fn finished(&mut self, now: &Point) -> Result<Point> {
        let mut y = now.x.clone();
        // open nodes, by their gaps, and forces that are rounding: finally exactly 0, unless balance needs them
        let none = RHO * self.small;
        for row in self.problem.cones.nodes().iter().filter_map(|node| node.normal) {
            let trial = now.x[row] - RHO * now.r[row];
            y[row] = if trial <= none { trial.min(y[row]) - none } else { y[row] };
        }
        let inside = self.projected(&y)?;
        let x = if inside.met { inside.point } else { now.x.clone() };
        let g = self.gradient(&x)?;
        let model = self.model(Face::at(self.problem.cones, &x, &self.gaps(&g, &now.alpha), RHO))?;
        let turned = self.turned(&model, &x, &g, &now.alpha)?;
        let (as_is, turned) =
            (self.point(x.clone(), g.clone(), now.alpha.clone())?, self.point(x, g, turned)?);
        Ok(if turned.merit < as_is.merit && Rung::Turned.is_tried() { turned } else { as_is })
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
            slide: self.slide,
            pairs: self.pairs,
        }
    }
}
