//! A solve from the call to the answer: set up, solve every island, put their answers together, report.

use std::cmp::Reverse;
use std::time::{Duration, Instant};

use crate::error::{Error, Kind, Result};
use crate::platform::threads::{self, Heard, Tasks};
use crate::solver::findings::Findings;
use crate::solver::phases::{Phase, Phases};
use crate::solver::problem::Problem;
use crate::solver::report::Report;
use crate::solver::results::{Answer, Asked};
use crate::solver::solve::Solved;
use crate::solver::state::Start;
use crate::solver::steps::{Told, Voice};
use crate::solver::watch::Watch;

/// How every island ended: with an answer, or with the named reason why it has none.
pub(super) type Ends = Vec<std::result::Result<Solved, Error>>;

impl Problem {
    /// Solves (10)-(11) for the present loads and gaps. An answer is kept even when it is incomplete; the
    /// report says how good it is. Where a group of bodies has none, the error says why and those of the others are kept.
    pub fn solve(&mut self) -> Result<Report> {
        self.watched(|problem, watch| {
            watch.log.begin(problem, "solve")?;
            let done = problem.solve_watched(watch);
            problem.logged("solve", done, watch)
        })
    }

    fn solve_watched(&mut self, watch: &mut Watch) -> Result<Report> {
        let started = Instant::now();
        self.answer = None;
        self.asked = Asked::default();
        let start = self.take_start();
        self.phases = Phases::default();
        self.set_up(watch)?;
        self.set_up_preconditioner(watch)?;
        watch.log.phases(&self.phases(), Phase::DualSolve as usize)?;
        self.log_method(&mut watch.log, start.name())?;
        let solving = Instant::now();
        let ends = self.solve_islands(&start, watch)?;
        let sum = |time: fn(&Solved) -> Duration| ends.iter().flatten().map(time).sum::<Duration>();
        let (judging, recovering) = (sum(|end| end.judging), sum(|end| end.recovering));
        let failure = ends.iter().find_map(|end| end.as_ref().err().cloned());
        self.phases.add(Phase::DualSolve, solving.elapsed());
        self.phases.move_time(Phase::DualSolve, Phase::Recovery, judging + recovering);
        if let Some(mut answer) = Answer::new(self, ends)? {
            answer.report.seconds_setup = (solving - started).as_secs_f64();
            answer.report.seconds_solve = solving.elapsed().as_secs_f64();
            answer.report.phases = self.phases();
            self.keep(answer);
        }
        match (failure, self.report()) {
            (None, Some(report)) => {
                let report = report.clone();
                watch.log.phases(&report.phases, usize::MAX)?;
                watch.log.result(&report)?;
                self.findings = Some(Findings::of_report(self, &report));
                Ok(report)
            }
            (failure, _) => {
                Err(failure.unwrap_or_else(|| Error::new(Kind::Internal, "a solve left nothing")))
            }
        }
    }

    /// Every island by itself: several at a time where there are threads, each with the bits it has alone.
    fn solve_islands(&self, start: &Start, watch: &mut Watch) -> Result<Ends> {
        let islands = &self.ready()?.islands;
        let (stops, threads) = (watch.stops.clone(), self.threads());
        if islands.len() == 1 || threads == 1 {
            return (0..islands.len())
                .map(|k| of_itself(self.solve_island(k, start, &stops, watch)))
                .collect();
        }
        let bodies = |k: usize| islands[k].island.bodies.iter().map(|&p| &self.bodies[p].body);
        let on_caller = |k: usize| bodies(k).any(|body| body.k().is_some_and(|k| k.on_caller()));
        let mut order: Vec<usize> = (0..islands.len()).collect();
        order.sort_by_key(|&k| Reverse(islands[k].dual.product_work()));
        let mut ends: Vec<Option<_>> = islands.iter().map(|_| None).collect();
        let mut told = Ok(());
        let solve =
            |k: usize, say: &dyn Fn(Message)| Ok(self.solve_island(k, start, &stops, &mut Apart { say }));
        let tasks = Tasks { threads, order: &order, on_caller: &on_caller };
        threads::run_telling(tasks, solve, &mut |heard| match heard {
            Heard::Done(k, end) => ends[k] = Some(end),
            Heard::Said(message) if told.is_ok() => {
                told = message.pass_on(watch);
                if told.is_err() {
                    stops.cancel();
                }
            }
            _ => {}
        })?;
        if let Err(error) = told {
            if error.kind != Kind::Cancelled {
                return Err(error);
            }
        }
        ends.into_iter().flatten().map(of_itself).collect()
    }
}

/// A reason why one island has no answer leaves the others theirs; any other failure is one of the whole call.
fn of_itself(end: Result<Solved>) -> Result<std::result::Result<Solved, Error>> {
    match end {
        Err(error) if !matches!(error.kind, Kind::LoadNotHeld | Kind::GapsContradict | Kind::Cancelled) => {
            Err(error)
        }
        end => Ok(end),
    }
}

/// What an island says to the thread that listens to all.
enum Message {
    Step(Told),
    Line(String),
}

impl Message {
    fn pass_on(self, voice: &mut dyn Voice) -> Result<()> {
        match self {
            Self::Step(told) => voice.step(told),
            Self::Line(text) => voice.line(text),
        }
    }
}

/// The voice of an island on a thread of its own: the host's answer comes by way of `Stops`.
struct Apart<'a> {
    say: &'a dyn Fn(Message),
}

impl Voice for Apart<'_> {
    fn step(&mut self, told: Told) -> Result<()> {
        (self.say)(Message::Step(told));
        Ok(())
    }

    fn line(&mut self, text: String) -> Result<()> {
        (self.say)(Message::Line(text));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::solver::{Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

    /// Two springs pushed against walls, each with nothing to do with the other; the second is stopped by its limit of steps.
    #[test]
    fn the_group_that_ended_worst_is_named_where_there_are_several() {
        for bodies in [1, 2] {
            let mut problem = Problem::new();
            for p in 0..bodies {
                let body = problem.add_body(2).unwrap();
                let k = SparseInput {
                    ptr: &[0, 1, 3],
                    col: &[0, 0, 1],
                    val: &[2.0, -1.0, 2.0],
                    storage: Storage::Lower,
                };
                problem.set_stiffness(body, k).unwrap();
                problem.set_null_space(body, 2, 0, &[], 2, Modes::Exact).unwrap();
                problem.set_load(body, &[3.0, if p + 1 < bodies { -5.0 } else { 4.0 }]).unwrap();
                let first = 2 * p as i64;
                let dof = [first, first + 1];
                let walls = RowsInput {
                    ptr: &[0, 1, 2],
                    body: None,
                    dof: &dof,
                    val: &[1.0, 1.5],
                    rhs: Some(&[1.0, 0.7]),
                };
                problem.add_rows(RowKind::Inequality, walls).unwrap();
            }
            problem.set_i64("max_steps", 1).unwrap();
            problem.set_i64("direct_limit", 0).unwrap();
            let report = problem.solve().unwrap();
            assert_eq!(report.outcome, Outcome::Iterations);
            assert_eq!(report.body, (bodies == 2).then_some(1));
            assert_eq!(problem.findings().unwrap().place.body, report.body);
        }
    }
}
