//! Rows whose gaps are far larger than all motions caused by loads and rows are left out of the dual problem. They join it only if bodies
//! travel that far: if nothing else holds a load, if the answer without these rows violates them, or if there is no answer
//! without them.

use crate::error::Result;
use crate::progress::Steps;
use crate::qp::{Counts, DirectOnRows, Judged, Qp, Restricted, Solution, Verdict};
use crate::solve::certifier::Certifier;
use crate::solve::diagnosis::Unheld;
use crate::solve::fallback::{gave_up, solve_dual, MethodOptions};
use crate::solve::presolve::FAR;

/// Solves the dual for the rows that matter; the forces of the rows left out are 0.
pub fn solve_near(
    means: &MethodOptions,
    qp: Qp,
    start: &[f64],
    judge: &mut Certifier,
    steps: &mut Steps,
) -> Result<Solution> {
    let (ready, scaled) = (judge.recovery.ready, judge.recovery.scaled);
    let (gaps, mut far) = (&scaled.gaps.value, scaled.gaps.far.clone());
    let (mut start, mut before, mut given_up, mut last) = (start.to_vec(), Counts::default(), None, None);
    let comes_in = |far: &[bool]| (0..far.len()).any(|i| far[i] && gaps[i] < f64::INFINITY);
    while far.contains(&true) {
        let is_last = !comes_in(&far);
        let rows: Vec<usize> = (0..far.len()).filter(|&i| !far[i]).collect();
        let (near, block) = (Restricted::new(qp, &rows), DirectOnRows { whole: means.direct, rows: &rows });
        steps.set_bounded(near.bounded());
        judge.far.clone_from(&far);
        judge.reached.clear();
        let means = MethodOptions { direct: block.direct(), ..*means };
        let mut judged = Judged { whole: judge, on: &near };
        let found = solve_dual(&means, near.qp(), &near.start(&start), &mut judged, steps);
        let solution = or_last(found.map(|solution| near.whole(solution)), last.take())?;
        before = before + solution.counts;
        match &solution.verdict {
            _ if is_last => {
                let solution = given_up.filter(|_| gave_up(&solution)).unwrap_or(solution);
                return Ok(Solution { counts: before, ..solution });
            }
            Verdict::Infeasible { .. }
                if Unheld::least(&judge.recovery.data, ready, scaled, &far)?.is_little() =>
            {
                return Ok(Solution { counts: before, ..solution });
            }
            Verdict::Infeasible { .. } | Verdict::Unbounded { .. } => take_in_nearest(&mut far, gaps),
            _ if judge.reached.is_empty() && gave_up(&solution) => {
                take_in_nearest(&mut far, gaps);
                given_up.get_or_insert(solution);
            }
            _ if judge.reached.is_empty() => return Ok(Solution { counts: before, ..solution }),
            _ => {
                judge.reached.iter().for_each(|&i| far[i] = false);
                start.clone_from(&solution.x);
                last = Some(solution);
            }
        }
    }
    steps.set_bounded(qp.bounded);
    judge.far.clear();
    judge.reached.clear();
    let solution = or_last(solve_dual(means, qp, &start, judge, steps), last)?;
    let counts = before + solution.counts;
    let solution = given_up.filter(|_| gave_up(&solution)).unwrap_or(solution);
    Ok(Solution { counts, ..solution })
}

/// The new solution or, if the host or the time limit has stopped it, the solution of the previous round: its work is
/// already counted.
pub fn or_last(found: Result<Solution>, last: Option<Solution>) -> Result<Solution> {
    match last {
        Some(last) => Solution { counts: Counts::default(), ..last }.unless(found),
        None => found,
    }
}

/// Takes in the nearest far row and all rows up to `FAR` times as far; rows with infinite gaps stay out.
pub fn take_in_nearest(far: &mut [bool], gaps: &[f64]) {
    let nearest = (0..far.len()).filter(|&i| far[i]).map(|i| gaps[i]).fold(f64::INFINITY, f64::min);
    far.iter_mut().zip(gaps).for_each(|(far, gap)| *far &= !(*gap <= FAR * nearest && *gap < f64::INFINITY));
}
