//! An island with friction: its dual is solved by the Newton method of `qp::friction`, on the rows that matter.

mod known;
mod laws;
mod slides;

use crate::error::Result;
use crate::progress::Steps;
use crate::qp::friction::{
    friction, unheld, Cones, DualAnswer, FrictionLimits, FrictionSolution, FrictionStart,
};
use crate::qp::{AnswerFace, Counts, DirectOnRows, Judged, Qp, Restricted, Solution, Verdict};
use crate::setup::Ready;
use crate::solve::case::Case;
use crate::solve::certifier::Certifier;
use crate::solve::fallback::MethodOptions;
use crate::solve::friction::laws::{cones, problem, OfBodies};
use crate::solve::friction::slides::named;
use crate::solve::gaps::Gaps;
use crate::solve::near::take_in_nearest;
use crate::solve::scaled::Scaled;

pub use known::on_known_states;

/// Solves the dual with the laws of friction for the rows that matter; the forces of the rows left out are 0.
pub fn solve_with_friction(
    case: Case,
    means: &MethodOptions,
    qp: Qp,
    start: &[f64],
    judge: &mut Certifier,
    steps: &mut Steps,
) -> Result<Solution> {
    let (ready, gaps) = (judge.recovery.ready, &judge.recovery.scaled.gaps);
    let (mut far, mut start, mut before) = (gaps.far.clone(), start.to_vec(), Counts::default());
    loop {
        let rows: Vec<usize> = (0..far.len()).filter(|&i| !far[i]).collect();
        let near = Restricted::new(qp, &rows);
        steps.set_bounded(near.bounded());
        judge.far.clone_from(&far);
        judge.reached.clear();
        let (found, counts) = on_rows(case, means, (&near, &rows), &start, judge, steps)?;
        let counts = before + counts;
        let solution = solution(ready, &qp, gaps, near.spread(&found.x), found, counts)?;
        let is_left_out = (0..far.len()).any(|i| far[i] && gaps.value[i] < f64::INFINITY);
        match &solution.verdict {
            Verdict::Infeasible { .. } if is_left_out => take_in_nearest(&mut far, &gaps.value),
            _ if judge.reached.is_empty() => return Ok(solution),
            _ => {
                judge.reached.iter().for_each(|&i| far[i] = false);
                start.clone_from(&solution.x);
            }
        }
        before = solution.counts;
    }
}

/// The forces within their cones, on rows that are not `far`, that leave the least of the load, `|D R c|_{D^-1}`; and `e
/// - G x`.
pub fn nearest_forces(ready: &Ready, scaled: &Scaled, far: &[bool]) -> Result<(Vec<f64>, Vec<f64>)> {
    let rows: Vec<usize> = (0..far.len()).filter(|&i| !far[i]).collect();
    let near = Restricted::new(scaled.qp(ready, &ready.dual), &rows);
    let cones = cones(ready, &scaled.gaps, &rows)?;
    let (x, rest) = unheld(&problem(near.qp(), &cones, None), &ready.dual.sizes_of_modes())?;
    Ok((near.spread(&x), rest))
}

/// The method on a subset of the rows. It reuses the pairs of earlier solves if the start is not 0.
fn on_rows(
    case: Case,
    means: &MethodOptions,
    (near, rows): (&Restricted, &[usize]),
    start: &[f64],
    judge: &mut Certifier,
    steps: &mut Steps,
) -> Result<(FrictionSolution, Counts)> {
    let (ready, gaps) = (judge.recovery.ready, &judge.recovery.scaled.gaps);
    let cones: Cones = cones(ready, gaps, rows)?;
    let preconditioner = ready.preconditioner.as_ref().map(|(_, of)| OfBodies { of, rows });
    let problem = problem(near.qp(), &cones, preconditioner.as_ref());
    let block = DirectOnRows { whole: means.direct, rows };
    let most = usize::try_from(means.settings.max_steps).unwrap_or(usize::MAX);
    let limits = FrictionLimits {
        tolerance: means.settings.tolerance,
        products: most,
        direct: (means.direct.limit > 0).then(|| block.direct()),
    };
    let start = near.start(start);
    let kept = ready.pairs.take(rows);
    let is_warm = start.iter().any(|x| *x != 0.0);
    let start = FrictionStart {
        x: is_warm.then_some(&start[..]),
        alpha: None,
        pairs: kept.filter(|_| is_warm).unwrap_or_default(),
    };
    let mut judged = Judged { whole: judge, on: near };
    let mut found = friction(problem, limits, start, &mut judged, steps)?;
    let counts = found.counts;
    if let (Verdict::Stalled, Some(slide)) = (&found.verdict, &found.slide) {
        return Err(named(case, slide, found.counts.starts)?);
    }
    ready.pairs.keep(rows, std::mem::take(&mut found.pairs), ready.dual.product_work());
    ready.pairs.keep_answer(DualAnswer {
        rows: rows.to_vec(),
        x: found.x.clone(),
        alpha: found.alpha.clone(),
    });
    Ok((found, counts))
}

/// Converts the result to a `Solution`; motions that neither closed rows nor nodes with a friction bound resist are
/// undetermined.
fn solution(
    ready: &Ready,
    qp: &Qp,
    gaps: &Gaps,
    x: Vec<f64>,
    found: FrictionSolution,
    counts: Counts,
) -> Result<Solution> {
    let FrictionSolution { alpha, scale, verdict, .. } = found;
    let mut held = qp.at_bound(&x);
    for row in laws::open_rows(ready, gaps, &x) {
        held[row] = true;
    }
    let undetermined = match verdict {
        Verdict::Solved => AnswerFace::of(qp, &held)?.undetermined()?.cols,
        _ => 0,
    };
    Ok(Solution { x, alpha, undetermined, scale, verdict, counts })
}
