//! The dual problem of an island, solved in rounds: each runs the method with some rows left out and with amplitudes assumed for
//! the motions of negative stiffness. Rows that the answer reaches join first, then the amplitudes follow.

use crate::error::Result;
use crate::progress::Steps;
use crate::qp::{
    AcceptanceTest, Counts, DirectOnRows, Effort, Judged as OnRows, Mended, Qp, Restricted, Rung, Solution,
    Verdict,
};
use crate::solve::case::Case;
use crate::solve::certifier::{Assumed, Certifier, Judged};
use crate::solve::fallback::{solve_dual, Found, MethodOptions};
use crate::solve::feedback::NegativeMotions;
use crate::solve::friction::solve_with_friction;
use crate::solve::near::{self, Near};
use crate::solve::negative::{Known, Next, Search, Step};
use crate::solve::recovery::Recovery;

/// Solves the dual of (10)-(11); the forces of the rows left out are 0.
pub fn solve_in_rounds<'a>(
    case: Case<'a>,
    means: &MethodOptions<'a>,
    qp: Qp<'a>,
    start: &[f64],
    judge: &mut Certifier<'a>,
    steps: &mut Steps,
) -> Result<Solution> {
    let negative = NegativeMotions::of(case.ready);
    let rounds = Rounds { case, means, qp, negative: &negative };
    let (mut near, mut known) = (Near::new(case, judge.recovery.scaled), Known::default());
    let (mut step, mut counts, mut last) =
        (Step::first(&negative, start.to_vec()), Counts::default(), None::<Solution>);
    loop {
        judge.judged = Judged::default();
        judge.assumed = Assumed {
            far: near.far.clone(),
            amplitudes: negative.amplitudes(&step.b),
            is_strict: known.is_strict(),
        };
        let e = negative.resultants(qp.e, &step.b);
        let found = run(case, means, Qp { e: &e, ..qp }, &near.rows(), &step.x, judge, steps);
        if found.as_ref().is_err_and(|error| near.may_stop(error)) {
            continue;
        }
        let Found { mut solution, held } = or_last(found, last.take())?;
        counts = counts + solution.counts;
        solution.counts = counts;
        if solution.verdict.is_stop() {
            return Ok(solution);
        }
        let solution = match near.after(solution, &judge.judged, step.b.iter().any(|b| *b != 0.0))? {
            near::Next::Ended(solution) => Solution { counts, ..solution },
            near::Next::Run(reached) => {
                reached.iter().for_each(|solution| step.x.clone_from(&solution.x));
                last = reached;
                continue;
            }
        };
        if negative.modes.is_empty() {
            return Ok(solution);
        }
        let unsettled = judge.judged == Judged::AmplitudesMoved;
        let next = match &solution.verdict {
            Verdict::Solved => {
                rounds.search(&judge.recovery).after(&mut known, &step, (&solution, held), unsettled)
            }
            _ => rounds.search(&judge.recovery).without_answer(&mut known, &step, &solution),
        };
        step = match next {
            Ok(Next::Step(next)) => next,
            Ok(Next::Mend(next)) if !Rung::Mend.is_tried() => next,
            Ok(Next::Mend(next)) => {
                let mended = judge.mended(&solution, Effort::All).and_then(|found| match found {
                    Mended::Accepted(mended) => {
                        Ok(rounds.search(&judge.recovery).is_minimum(&step, &mended)?.then_some(mended))
                    }
                    _ => Ok(None),
                });
                match mended {
                    Ok(Some(mended)) => return Ok(mended),
                    Ok(None) => next,
                    Err(error) => return Ok(Solution { verdict: Verdict::of_refusal(error)?, ..solution }),
                }
            }
            Ok(Next::End(verdict)) => return Ok(Solution { verdict, ..solution }),
            Err(error) => return Ok(Solution { verdict: Verdict::of_refusal(error)?, ..solution }),
        };
        near.forget();
        last = Some(solution);
    }
}

/// What all rounds have in common.
struct Rounds<'a, 'b> {
    case: Case<'a>,
    means: &'b MethodOptions<'a>,
    qp: Qp<'a>,
    negative: &'b NegativeMotions,
}

impl<'a> Rounds<'a, '_> {
    fn search<'c>(&'c self, recovery: &'c Recovery<'a>) -> Search<'a, 'c> {
        let Self { case, means, qp, negative } = *self;
        Search { case, means, qp, negative, recovery }
    }
}

/// One run of the method on these rows.
fn run(
    case: Case,
    means: &MethodOptions,
    qp: Qp,
    rows: &[usize],
    start: &[f64],
    judge: &mut Certifier,
    steps: &mut Steps,
) -> Result<Found> {
    if !case.has_friction() && rows.len() == qp.b.len() {
        steps.set_bounded(qp.bounded);
        let solution = solve_dual(means, qp, start, judge, steps)?;
        return Ok(Found { held: qp.at_bound(&solution.x), solution });
    }
    let near = Restricted::new(qp, rows);
    steps.set_bounded(near.bounded());
    let block = DirectOnRows { whole: means.direct, rows };
    let means = MethodOptions { direct: block.direct(), ..*means };
    let gaps = &judge.recovery.scaled.gaps;
    let mut judged = OnRows { whole: judge, on: &near };
    if case.has_friction() {
        return solve_with_friction(case, &means, (&qp, gaps), (&near, rows), start, &mut judged, steps);
    }
    let solution = near.whole(solve_dual(&means, near.qp(), &near.start(start), &mut judged, steps)?);
    Ok(Found { held: qp.at_bound(&solution.x), solution })
}

/// The new solution or, if the host or the time limit has stopped it, the solution of the previous round: its work is
/// already counted.
fn or_last(found: Result<Found>, last: Option<Solution>) -> Result<Found> {
    match (found, last) {
        (Err(error), Some(last)) => {
            let verdict = Verdict::of_refusal(error)?;
            let solution = Solution { verdict, counts: Counts::default(), ..last };
            Ok(Found { solution, held: Vec::new() })
        }
        (found, _) => found,
    }
}
