//! The method that the options ask for and, if it gives up, other methods before the answer counts as incomplete.

use crate::error::Result;
use crate::model::{Method, Settings};
use crate::progress::Steps;
use crate::qp::paper::algorithm_3;
use crate::qp::{
    active_set, minimise, not_held, proximal, smalbe, AcceptanceTest, Direct, Limits, Qp, Solution, Verdict,
};
use crate::solve::paper;

/// How the dual is solved.
#[derive(Clone, Copy)]
pub struct MethodOptions<'a> {
    pub settings: &'a Settings,
    pub direct: Direct<'a>,
}

/// The forces of a run, and the rows whose forces do not respond to motions: open ones, and tangential ones that slip.
pub struct Found {
    pub solution: Solution,
    pub held: Vec<bool>,
}

/// S10 of docs/method.md: solves the dual. After proportioning follow proportioning without preconditioner and SMALBE-M,
/// each from the end point of the first run and each followed by the direct method; if there are few rows, a finite
/// method is last.
pub fn solve_dual(
    means: &MethodOptions,
    qp: Qp,
    start: &[f64],
    judge: &mut dyn AcceptanceTest,
    steps: &mut Steps,
) -> Result<Solution> {
    let settings = means.settings;
    let most = usize::try_from(settings.max_steps).unwrap_or(usize::MAX);
    let limits = Limits { tolerance: settings.tolerance, gamma: settings.gamma, steps: most };
    if let Some(parameters) = paper::parameters(settings) {
        return algorithm_3(Qp { preconditioner: None, ..qp }, start, &parameters, judge, steps);
    }
    if settings.method == Method::Smalbe {
        return not_held(&qp, start)?.map_or_else(|| smalbe(qp, start, limits, judge, steps), Ok);
    }
    let first = minimise(qp, start, limits, judge, steps)?;
    let mut best = or_directly(first, qp, means.direct, judge, steps)?;
    let plain = Qp { preconditioner: None, ..qp };
    if gave_up(&best) && qp.preconditioner.is_some() {
        follows(&best, "proportioning without preconditioner", steps)?;
        let next = minimise(plain, &best.x.clone(), limits, judge, steps);
        let next = next.and_then(|next| or_directly(next, plain, means.direct, judge, steps));
        best = better(best, next)?;
    }
    if gave_up(&best) {
        follows(&best, "smalbe", steps)?;
        let next = smalbe(plain, &best.x.clone(), limits, judge, steps);
        let next = next.and_then(|next| or_directly(next, plain, means.direct, judge, steps));
        best = better(best, next)?;
    }
    if is_incomplete(&best) && means.direct.limit > 0 {
        if let Some(found) = proximal(plain, means.direct, &best).transpose() {
            follows(&best, "nearest points of polyhedra", steps)?;
            let next = found.and_then(|found| or_directly(found, plain, means.direct, judge, steps));
            best = better(best, next)?;
        }
    }
    Ok(best)
}

/// Logs that another method follows.
fn follows(ended: &Solution, next: &str, steps: &mut Steps) -> Result<()> {
    let why = match ended.verdict {
        Verdict::StepLimit => "the limit of steps is reached",
        Verdict::Inaccurate => "the dual is solved, the certificate does not pass",
        Verdict::Unbounded { .. } => "theta seems to fall without end",
        _ => "steps no longer reduce the error",
    };
    steps.line(format!("fallback after {} steps: {why}; {next} follows", ended.counts.steps()))
}

/// The given solution; if it is incomplete, that of the direct method with F, then that with the data of the host.
fn or_directly(
    solution: Solution,
    qp: Qp,
    direct: Direct,
    judge: &mut dyn AcceptanceTest,
    steps: &mut Steps,
) -> Result<Solution> {
    if !is_incomplete(&solution) {
        return Ok(solution);
    }
    if direct.limit > 0 {
        follows(&solution, "direct solution on active sets", steps)?;
    }
    let next = active_set(qp, direct, &solution, judge);
    let best = better(solution, next)?;
    if is_incomplete(&best) && direct.limit > 0 {
        let mended = judge.mended(&best).map(|mended| mended.unwrap_or_else(|| best.clone()));
        return best.unless(mended);
    }
    Ok(best)
}

fn is_incomplete(solution: &Solution) -> bool {
    gave_up(solution) || solution.verdict == Verdict::StepLimit
}

/// Contradictory rows were excluded before the dual is solved: a direction along which theta seems to fall without end is
/// usually rounding.
pub fn gave_up(solution: &Solution) -> bool {
    matches!(solution.verdict, Verdict::Stalled | Verdict::Inaccurate | Verdict::Unbounded { .. })
}

/// The accepted solution of the two, with the work of both; the first if the host or the time limit ended the second.
fn better(first: Solution, second: Result<Solution>) -> Result<Solution> {
    let second = match second {
        Ok(second) => second,
        refused => return first.unless(refused),
    };
    let counts = first.counts + second.counts;
    Ok(match second.verdict {
        Verdict::Solved => Solution { counts, ..second },
        Verdict::Cancelled | Verdict::TimeLimit => Solution { counts, verdict: second.verdict, ..first },
        _ => Solution { counts, ..first },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Error, Kind};
    use crate::progress::{Stops, Told, Voice};
    use crate::qp::Counts;
    use crate::solve::certifier::tests::two_springs;

    fn ended(verdict: Verdict, products: usize) -> Solution {
        let counts = Counts { products, ..Counts::default() };
        Solution { x: vec![], alpha: vec![], undetermined: 0, scale: 0.0, verdict, counts }
    }

    #[test]
    fn an_accepted_answer_replaces_one_that_is_not_and_the_work_of_both_counts() {
        let better = |first, second| better(first, Ok(second)).unwrap();
        let solution = better(ended(Verdict::Stalled, 5), ended(Verdict::Solved, 7));
        assert_eq!((solution.verdict, solution.counts.products), (Verdict::Solved, 12));
        let solution = better(ended(Verdict::Inaccurate, 5), ended(Verdict::StepLimit, 7));
        assert_eq!((solution.verdict, solution.counts.products), (Verdict::Inaccurate, 12));
    }

    #[test]
    fn a_cancelled_second_try_leaves_the_first_answer_and_says_so() {
        let stalled = Solution { x: vec![1.0], ..ended(Verdict::Stalled, 5) };
        let solution = better(stalled.clone(), Ok(ended(Verdict::Cancelled, 7))).unwrap();
        assert_eq!(
            (solution.verdict, solution.x, solution.counts.products),
            (Verdict::Cancelled, vec![1.0], 12)
        );
        let refused = |kind| better(stalled.clone(), Err(Error::new(kind, "refused")));
        let solution = refused(Kind::TimeOver).unwrap();
        assert_eq!((solution.verdict, solution.x), (Verdict::TimeLimit, vec![1.0]));
        assert_eq!(refused(Kind::Callback).unwrap_err().kind, Kind::Callback);
    }

    /// Keeps the lines.
    #[derive(Default)]
    struct Lines(Vec<String>);

    impl Voice for Lines {
        fn step(&mut self, _: Told) -> Result<()> {
            Ok(())
        }

        fn line(&mut self, text: String) -> Result<()> {
            self.0.push(text);
            Ok(())
        }
    }

    #[test]
    fn a_run_that_met_its_limit_of_steps_is_completed_directly_and_told_so_unless_that_is_switched_off() {
        for (limit, verdict) in [(1000, Verdict::Solved), (0, Verdict::StepLimit)] {
            two_springs(0.1, |judge, rough| {
                let (qp, direct) = (judge.recovery.faces.qp, judge.recovery.faces.direct);
                let mut lines = Lines::default();
                let stops = Stops::never();
                let mut steps = Steps::new(0, 1.0, qp.bounded, stops, &mut lines);
                let ended = Solution { verdict: Verdict::StepLimit, ..rough.clone() };
                let done = or_directly(ended, qp, Direct { limit, ..direct }, judge, &mut steps);
                let done = done.unwrap();
                assert_eq!(done.verdict, verdict);
                assert_eq!(done.x[0] == 2.0, verdict == Verdict::Solved);
                let line = "fallback after 0 steps: the limit of steps is reached; direct solution on active sets follows";
                assert_eq!(lines.0, [line].repeat(usize::from(limit > 0)));
            });
        }
    }
}
