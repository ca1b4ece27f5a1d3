//! An island with friction: its dual is solved by the Newton method of `qp::friction`, on the rows that matter.

mod laws;

use crate::error::Result;
use crate::progress::Steps;
use crate::qp::friction::{
    friction, unheld, Cones, FacePreconditioner, FrictionLimits, FrictionProblem, FrictionSolution,
    FrictionStart, Tried,
};
use crate::qp::{AnswerFace, Counts, DirectOnRows, Judged, Qp, Restricted, Solution, Verdict};
use crate::setup::Ready;
use crate::solve::certifier::Certifier;
use crate::solve::fallback::MethodOptions;
use crate::solve::friction::laws::{cones, OfBodies};
use crate::solve::gaps::Gaps;
use crate::solve::near::take_in_nearest;
use crate::solve::scaled::Scaled;

/// Solves the dual with the laws of friction for the rows that matter; the forces of the others are 0.
pub fn solve_with_friction(
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
        let found = on_rows(means, (&near, &rows), &start, judge, steps)?;
        let counts = before + counts(&found);
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

/// The forces of rows that are not `far`, within their cones, that leave least of the load, `|D R c|_{D^-1}`, and `e - G x`.
pub fn nearest_forces(ready: &Ready, scaled: &Scaled, far: &[bool]) -> Result<(Vec<f64>, Vec<f64>)> {
    let rows: Vec<usize> = (0..far.len()).filter(|&i| !far[i]).collect();
    let near = Restricted::new(scaled.qp(ready, &ready.dual), &rows);
    let cones = cones(ready, &scaled.gaps, &rows)?;
    let (x, rest) = unheld(&friction_problem(near.qp(), &cones, None), &ready.dual.sizes_of_modes())?;
    Ok((near.spread(&x), rest))
}

fn friction_problem<'a>(
    qp: Qp<'a>,
    cones: &'a Cones,
    preconditioner: Option<&'a dyn FacePreconditioner>,
) -> FrictionProblem<'a> {
    let Qp { a, b, g_transposed, blocks, rounding, e, .. } = qp;
    FrictionProblem { a, b, g_transposed, blocks, rounding, e, cones, preconditioner }
}

/// The method on some of the rows. Pairs of earlier solves serve where the start is not 0.
fn on_rows(
    means: &MethodOptions,
    (near, rows): (&Restricted, &[usize]),
    start: &[f64],
    judge: &mut Certifier,
    steps: &mut Steps,
) -> Result<FrictionSolution> {
    let (ready, gaps) = (judge.recovery.ready, &judge.recovery.scaled.gaps);
    let cones: Cones = cones(ready, gaps, rows)?;
    let preconditioner = ready.preconditioner.as_ref().map(|(_, of)| OfBodies { of, rows });
    let problem = friction_problem(near.qp(), &cones, preconditioner.as_ref().map(|of| of as _));
    let block = DirectOnRows { whole: means.direct, rows };
    let most = usize::try_from(means.settings.max_steps).unwrap_or(usize::MAX);
    let limits = FrictionLimits {
        tolerance: means.settings.tolerance,
        products: most,
        direct: (means.direct.limit > 0).then(|| block.direct()),
    };
    let start = near.start(start);
    let kept = ready.kept.take_pairs(rows);
    let is_warm = start.iter().any(|x| *x != 0.0);
    let start = FrictionStart {
        x: is_warm.then_some(&start[..]),
        alpha: None,
        pairs: kept.filter(|_| is_warm).unwrap_or_default(),
    };
    let mut judged = Judged { whole: judge, on: near };
    let mut found = friction(problem, limits, start, &mut judged, steps)?;
    ready.kept.keep_pairs(rows, std::mem::take(&mut found.pairs));
    Ok(found)
}

fn counts(found: &FrictionSolution) -> Counts {
    let Tried { newton, restarts, paths, dense_paths, frictionless, sticking } = found.tried;
    let others = restarts + paths + dense_paths + usize::from(frictionless) + usize::from(sticking);
    Counts { newton, starts: 1 + others, ..found.counts }
}

/// The same as the solution of any method; motions that neither closed rows nor nodes with a bound resist are undetermined.
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
