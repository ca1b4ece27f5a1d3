//! The method that the options ask for and, if it gives up, faces by the data of the host and a second start before the answer
//! counts as incomplete.

use crate::error::Result;
use crate::model::Settings;
use crate::progress::Steps;
use crate::qp::{minimise, AcceptanceTest, Direct, Effort, Limits, Mended, Qp, Rung, Solution, Verdict};
use crate::solve::method::DualMethod;

/// How the dual is solved.
#[derive(Clone, Copy)]
pub struct MethodOptions<'a> {
    pub settings: &'a Settings,
    /// In place of proportioning.
    pub other: Option<&'a dyn DualMethod>,
    pub direct: Direct<'a>,
}

/// The forces of a run, and the rows whose forces do not respond to motions: open ones, and tangential ones that slip.
pub struct Found {
    pub solution: Solution,
    pub held: Vec<bool>,
}

/// S10 of docs/method.md: solves the dual by proportioning, which tries faces by the data of the host once its steps have cost as much,
/// and where it gives up, on such faces at any cost; where these have no answer, by proportioning from an interior point.
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
    if let Some(other) = means.other {
        return other.solve(settings, qp, None, start, judge, steps);
    }
    let mut solution = minimise(qp, start, limits, judge, steps)?;
    if solution.counts.direct > 0 {
        let after = solution.counts.steps();
        steps.line(format!("after {after} steps a direct solution on active sets cost no more than they"))?;
    }
    let inside = on_faces(&mut solution, means.direct, judge, steps, Effort::All)?;
    if let Some(x) = inside.filter(|_| Rung::Again.is_tried()) {
        steps.line("the method starts again from the forces of an interior point".to_owned())?;
        let again = minimise(qp, &x, limits, judge, steps).and_then(|mut again| {
            on_faces(&mut again, means.direct, judge, steps, Effort::AllSets)?;
            Ok(again)
        });
        return better(solution, again);
    }
    Ok(solution)
}

/// Corrects an incomplete solution on faces by the data of the host; if none of them has an answer, forces close to one, if the effort
/// includes them.
fn on_faces(
    solution: &mut Solution,
    direct: Direct,
    judge: &mut dyn AcceptanceTest,
    steps: &mut Steps,
    effort: Effort,
) -> Result<Option<Vec<f64>>> {
    let is_incomplete = gave_up(solution) || solution.verdict == Verdict::StepLimit;
    if !is_incomplete || direct.limit == 0 || !Rung::Faces.is_tried() {
        return Ok(None);
    }
    let why = match solution.verdict {
        Verdict::StepLimit => "the limit of steps is reached",
        Verdict::Inaccurate => "the dual is solved, the certificate does not pass",
        Verdict::Unbounded { .. } => "theta seems to fall without end",
        _ => "steps no longer reduce the error",
    };
    let after = solution.counts.steps();
    steps.line(format!("after {after} steps {why}: direct solution on active sets follows"))?;
    match judge.mended(solution, effort) {
        Ok(Mended::Accepted(mended)) => *solution = mended,
        Ok(Mended::Near(x)) => return Ok(Some(x)),
        Ok(Mended::Dear | Mended::Failed) => {}
        Err(error) => solution.verdict = Verdict::of_refusal(error)?,
    }
    Ok(None)
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

/// Contradictory rows were excluded before the dual is solved: a direction along which theta seems to fall without end is
/// usually rounding.
pub fn gave_up(solution: &Solution) -> bool {
    matches!(solution.verdict, Verdict::Stalled | Verdict::Inaccurate | Verdict::Unbounded { .. })
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
                let mut done = Solution { verdict: Verdict::StepLimit, ..rough.clone() };
                let near = on_faces(&mut done, Direct { limit, ..direct }, judge, &mut steps, Effort::All);
                assert!(near.unwrap().is_none());
                assert_eq!(done.verdict, verdict);
                assert_eq!(done.x[0] == 2.0, verdict == Verdict::Solved);
                let line =
                    "after 0 steps the limit of steps is reached: direct solution on active sets follows";
                assert_eq!(lines.0, [line].repeat(usize::from(limit > 0)));
            });
        }
    }
}
