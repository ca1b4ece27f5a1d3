//! Proportioning on the dual polyhedron: Algorithm 1 on the true feasible set of (12), without an augmented Lagrangian.
//! No penalty, no estimate of a norm, no parameter with a unit. docs/method.md describes the steps; comments here and in
//! `steps` name its tags.
//!
//! | module | does |
//! |---|---|
//! | `iterate` | point, gradient, face |
//! | `drift` | when the gradient is recomputed, if products are approximate |
//! | `steps` | conjugate gradients, expansion, proportioning step |
//! | `stop` | when the residual is small enough |

mod drift;
mod iterate;
mod steps;
mod stop;

use crate::error::Result;
use crate::linalg::vector::{dot, norm, norm_max, ratio, NOISE};
use crate::numbers::qp::NO_FORCE;
use crate::numbers::rounding;
use crate::platform::interrupt;
use crate::qp::between_solves::BetweenSolves;
use crate::qp::coarse::Coarse;
use crate::qp::friction::{unheld, Cones};
use crate::qp::projection::project;
use crate::qp::{
    AcceptanceTest, Counts, Effort, Limits, Mended, Observer, Qp, Rung, Solution, StepKind, StepReport,
    Verdict,
};
use iterate::Iterate;
use steps::Step;

use stop::Stop;

/// Name of S6 in the log.
const FIRST_POINT: &str = "first feasible point";

pub fn minimise(
    qp: Qp,
    start: &[f64],
    limits: Limits,
    judge: &mut dyn AcceptanceTest,
    observer: &mut dyn Observer,
) -> Result<Solution> {
    let is_warm = start.iter().any(|x| *x != 0.0);
    // a cold start gives equal bits independently of earlier solves
    let directions = qp.kept.and_then(BetweenSolves::take_directions).filter(|_| is_warm);
    let mut coarse = Coarse::of(&qp)?;
    let scaled = is_warm.then(|| in_size(&qp, &coarse, start));
    let start = scaled.as_deref().unwrap_or(start);
    let first = match interrupt::part(FIRST_POINT, || first_point(&qp, &mut coarse, start))? {
        Some(first) => first,
        // S6.2
        None => {
            let (cones, alike) = (Cones::half_lines(qp.bounded)?, vec![1.0; qp.e.len()]);
            let (x, direction) = interrupt::part(FIRST_POINT, || unheld(&qp, &cones, &alike))?;
            let margin = ratio(norm(&direction), norm(qp.e));
            // a smaller residual is rounding of e
            if margin > rounding::METHOD {
                return Ok(infeasible(x, Verdict::Infeasible { direction, margin }, &coarse));
            }
            x
        }
    };
    // S6.3
    let mut it = Iterate::new(qp, coarse, first)?;
    if is_warm && qp.e.is_empty() {
        it.scale()?;
    }
    directions.map_or(Ok(()), |directions| it.go_on_with(directions))?;
    proportioning(it, limits, judge, observer)
}

fn infeasible(x: Vec<f64>, verdict: Verdict, coarse: &Coarse) -> Solution {
    let (coarse_solves, coarse_factorisations) = (coarse.solves, coarse.factorisations);
    let counts = Counts { coarse_solves, coarse_factorisations, ..Counts::default() };
    Solution { x, alpha: vec![0.0; coarse.dimension()], undetermined: 0, scale: 0.0, verdict, counts }
}

/// S6.1: a start, of which rows with resultants keep the part that comes closest to balancing e, so that forces of larger loads do
/// not leave their rounding.
fn in_size(qp: &Qp, coarse: &Coarse, start: &[f64]) -> Vec<f64> {
    let held = coarse.image(start);
    let size = norm(&held);
    let t = dot(qp.e, &held) / size / size;
    let is_larger = size > NOISE * norm(&coarse.terms(start)) && (0.0..1.0).contains(&t);
    let part = |i: usize| if is_larger && qp.g_transposed.row(i).next().is_some() { t } else { 1.0 };
    start.iter().enumerate().map(|(i, x)| part(i) * x).collect()
}

/// S6.1: the feasible point nearest to `start`, on the face of the zeros of `start` (its active set) if this face has
/// one.
fn first_point(qp: &Qp, coarse: &mut Coarse, start: &[f64]) -> Result<Option<Vec<f64>>> {
    if start.iter().any(|x| *x != 0.0) && Rung::Start.is_tried() {
        let zeros = qp.at_bound(start);
        if let Some(first) = project(qp, coarse, start, &zeros)? {
            return Ok(Some(first.point));
        }
    }
    let none = vec![false; start.len()];
    Ok(project(qp, coarse, start, &none)?.map(|first| first.point))
}

fn proportioning(
    mut it: Iterate,
    limits: Limits,
    judge: &mut dyn AcceptanceTest,
    observer: &mut dyn Observer,
) -> Result<Solution> {
    // S7
    let scale = judge.scale(&it.x, &it.alpha)?;
    let stop = Stop::new(limits.tolerance * scale, judge.share_of_energy());
    let verdict = run(&mut it, stop, limits, judge, observer).or_else(Verdict::of_refusal)?;
    it.counts.coarse_solves = it.coarse.solves;
    it.counts.coarse_factorisations = it.coarse.factorisations;
    let none = NO_FORCE * norm_max(&it.x);
    let held: Vec<bool> = it.x.iter().zip(it.qp.bounded).map(|(x, bounded)| *bounded && *x <= none).collect();
    let open = it.coarse.on(&held).map(|face| face.deficiency());
    let (undetermined, verdict) = verdict.with(open, 0)?;
    it.qp.kept.iter().for_each(|kept| kept.keep_directions(std::mem::take(&mut it.kept)));
    Ok(Solution { undetermined, scale, x: it.x, alpha: it.alpha, verdict, counts: it.counts })
}

fn run(
    it: &mut Iterate,
    mut stop: Stop,
    limits: Limits,
    judge: &mut dyn AcceptanceTest,
    observer: &mut dyn Observer,
) -> Result<Verdict> {
    let mut efforts: &[Effort] = &[Effort::FewSets, Effort::Interior];
    loop {
        // P1 of docs/method.md: the stop
        let small = stop.small(it);
        it.refresh_if_stale(small)?;
        if it.split.norm() <= small || stop.plateau(it) {
            it.rebalance()?;
            if judge.accepts(&it.x, &it.alpha)? {
                return Ok(Verdict::Solved);
            }
            let missed = judge.missed();
            if stop.stays(missed) && judge.has_better_data() {
                return Ok(Verdict::Inaccurate);
            }
            if stop.tighten_by(missed, it) {
                continue;
            }
            it.refresh()?;
            if it.split.norm() <= small || stop.plateau(it) {
                match stop.tighten(judge.accepts(&it.x, &it.alpha)?) {
                    Some(verdict) => return Ok(verdict),
                    None => continue,
                }
            }
        }
        // P2: the face is explored (P3 to P8), or rows leave the active set, the proportioning step (P9 to P11)
        let step = if it.split.is_proportional(limits.gamma) { it.explore()? } else { it.proportion(small)? };
        // P12, and P10 at a degenerate vertex
        let kind = match step {
            Step::Vertex { alpha } => {
                if let Some(verdict) = stop.tighten(judge.accepts(&it.x, &alpha)?) {
                    it.alpha = alpha;
                    return Ok(verdict);
                }
                StepKind::Proportioning
            }
            Step::Unbounded { .. } | Step::Stuck if judge.accepts(&it.x, &it.alpha)? => {
                return Ok(Verdict::Solved);
            }
            Step::Unbounded { p } => return Ok(Verdict::Unbounded { p }),
            Step::Stuck => return Ok(Verdict::Stalled),
            Step::ConjugateGradient => StepKind::ConjugateGradient,
            Step::Expansion => StepKind::Expansion,
            Step::Proportioning => StepKind::Proportioning,
        };
        observer.step(&it.progress(kind, small))?;
        if it.is_mended(&mut efforts, judge)? {
            return Ok(Verdict::Solved);
        }
        if it.counts.steps() >= limits.steps {
            return Ok(Verdict::StepLimit);
        }
    }
}

#[cfg(test)]
mod tests;

impl Iterate<'_> {
    /// P12: whether better data have an answer, which then is the present point; the next effort is made once steps have cost as much.
    fn is_mended(&mut self, efforts: &mut &[Effort], judge: &mut dyn AcceptanceTest) -> Result<bool> {
        let Some((&effort, further)) = efforts.split_first() else { return Ok(false) };
        if judge.pays_after(effort).is_none_or(|pays| pays > self.counts.steps()) {
            return Ok(false);
        }
        let (x, alpha, counts, verdict) =
            (self.x.clone(), self.alpha.clone(), self.counts, Verdict::StepLimit);
        match judge.mended(&Solution { x, alpha, undetermined: 0, scale: 0.0, verdict, counts }, effort)? {
            Mended::Accepted(found) => {
                (self.x, self.alpha, self.counts.direct) = (found.x, found.alpha, found.counts.direct);
                return Ok(true);
            }
            Mended::Dear => {}
            Mended::Near(_) | Mended::Failed => *efforts = further,
        }
        Ok(false)
    }

    fn progress(&self, kind: StepKind, small: f64) -> StepReport<'_> {
        StepReport::new(kind, &self.counts, &self.split, self.theta(), small)
    }
}
