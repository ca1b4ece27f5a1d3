//! One island: solve the dual, recover the displacements, certify.

use std::time::{Duration, Instant};

use crate::error::{Error, Kind, Result};
use crate::linalg::Operator;
use crate::qp::paper::Units;
use crate::qp::{Direct, Solution, Verdict};
use crate::solver::certifier::{Certifier, Ending, Faces};
use crate::solver::diagnosis::{Contradictions, Unheld, MARGINAL, ROUNDING};
use crate::solver::fallback::Means;
use crate::solver::finish::finish;
use crate::solver::near::solve_near;
use crate::solver::paper::{parameters, HostUnits};
use crate::solver::problem::Problem;
use crate::solver::report::Outcome;
use crate::solver::scaled::Scaled;
use crate::solver::setup::{Ready, Setup};
use crate::solver::state::Start;
use crate::solver::steps::{Interruptible, Steps, Voice};
use crate::solver::watch::Stops;

/// How the solution of one island ended.
pub(super) struct Solved {
    pub ending: Ending,
    pub outcome: Outcome,
    /// The direct finish has replaced the answer.
    pub finished: bool,
    /// The largest share of the load of bodies that move together which nothing holds.
    pub unheld: f64,
    /// Time for answers recovered and certified, and for the recovery of the last.
    pub judging: Duration,
    pub recovering: Duration,
}

/// One try at an island.
enum Attempt {
    Ended(Box<Solved>),
    /// No forces were found that hold the load, but for rows that are too far off to hold so little.
    NotHeld {
        far: Vec<bool>,
    },
}

impl Problem {
    /// Solves (10)-(11) on one island: the dual, the displacements, the certificate. The named reason why there is no
    /// answer is an error. What rounding has made of a load that nothing holds is taken from it.
    pub(super) fn solve_island(
        &self,
        number: usize,
        start: &Start,
        stops: &Stops,
        voice: &mut dyn Voice,
    ) -> Result<Solved> {
        let setup = self.ready()?;
        let ready = &setup.islands[number];
        let mut dual = Scaled::new(self, ready, stops)?;
        let mut start = start.scaled(ready)?;
        loop {
            match self.attempt(number, &dual, &start, stops, voice)? {
                Attempt::Ended(solved) => return Ok(*solved),
                Attempt::NotHeld { far } => {
                    let data = self.data(&ready.island)?;
                    let least = Unheld::least(&data, ready, &dual, &far)?;
                    if let Some(error) = least.proof(self, ready, &dual)? {
                        return Err(error);
                    }
                    let share = least.share;
                    let relative = Unheld::relative(&data, ready, &dual, &far)?.filter(Unheld::is_little);
                    let left = relative.unwrap_or(least);
                    dual.take(self, ready, &left, share)?;
                    start = left.x;
                }
            }
        }
    }

    fn attempt(
        &self,
        number: usize,
        dual: &Scaled,
        start: &[f64],
        stops: &Stops,
        voice: &mut dyn Voice,
    ) -> Result<Attempt> {
        let setup = self.ready()?;
        let ready = &setup.islands[number];
        let f = Interruptible::new(&ready.dual, stops.clone(), self.product_threads(ready));
        let qp = dual.qp(ready, &f);
        let direct = self.direct(setup, ready);
        let mut judge = Certifier::new(self, ready, dual, Faces { qp, direct, stops })?;
        let steps = &mut Steps::new(number, ready.island.unit, &dual.gaps.bounded, stops.clone(), voice);
        let solution = match parameters(&self.settings) {
            Some(given) if given.units == Units::Printed => {
                HostUnits::new(self, ready, &dual.gaps, given)?.solve(qp, start, &mut judge, steps)?
            }
            _ => solve_near(&Means { settings: &self.settings, direct }, qp, start, &mut judge, steps)?,
        };
        let solution = match solution {
            Solution { verdict: Verdict::Infeasible { .. }, .. } if dual.unheld.is_none() => {
                return Ok(Attempt::NotHeld { far: judge.far });
            }
            solution => solution,
        };
        let (judging, recovering) = (judge.spent, Instant::now());
        let mut ending = judge.ending(solution)?;
        judge.bring_to_rest(&mut ending, false)?;
        let is_solved = ending.solution.verdict == Verdict::Solved;
        let finished = is_solved && self.is_to_finish(&judge, &ending) && finish(&judge, &mut ending)?;
        let mut outcome = self.outcome(ready, dual, &ending.solution)?;
        if outcome == Outcome::Solved && !ending.judgement.certificate.passed() {
            outcome = Outcome::Inaccurate;
        }
        if let Some(taken) = dual.unheld.as_ref().filter(|taken| taken.load.is_some()) {
            // what the host is told is about its own load
            ending.judgement = judge.judged_on(&self.data(&ready.island)?, &ending.recovered)?;
            let is_marginal = taken.share > ROUNDING || !ending.judgement.certificate.passed();
            outcome = match outcome {
                Outcome::Solved if taken.share > MARGINAL => Outcome::Inaccurate,
                Outcome::Solved if is_marginal => Outcome::Marginal,
                outcome => outcome,
            };
        }
        let unheld = dual.unheld.as_ref().map_or(0.0, |taken| taken.share);
        let recovering = recovering.elapsed();
        Ok(Attempt::Ended(Box::new(Solved { ending, outcome, finished, unheld, judging, recovering })))
    }

    pub(super) fn ready(&self) -> Result<&Setup> {
        self.ready.as_ref().ok_or_else(|| Error::new(Kind::Internal, "the setup left nothing"))
    }

    /// F for the direct method, which stays within the memory limit.
    pub(super) fn direct<'a>(&self, setup: &Setup, ready: &'a Ready) -> Direct<'a> {
        let asked = usize::try_from(self.settings.direct_limit).unwrap_or(usize::MAX);
        let most = asked.min(ready.dual.order() + ready.dual.modes());
        let limit = if self.check_more(&setup.operators, Direct::bytes(most)).is_ok() { most } else { 0 };
        Direct { entries: &ready.dual, limit }
    }

    /// How the solution ended, or the named reason why there is none.
    fn outcome(&self, ready: &Ready, dual: &Scaled, solution: &Solution) -> Result<Outcome> {
        match &solution.verdict {
            Verdict::Solved => Ok(Outcome::Solved),
            Verdict::StepLimit => Ok(Outcome::Iterations),
            Verdict::TimeLimit => Ok(Outcome::Time),
            Verdict::Cancelled => Ok(Outcome::Cancelled),
            Verdict::Stalled | Verdict::Infeasible { .. } => Ok(Outcome::Stalled),
            Verdict::Inaccurate => Ok(Outcome::Inaccurate),
            Verdict::Unbounded { p } => {
                let w: Vec<f64> = p.iter().map(|p| -p).collect();
                let w = ready.rows.decoupling.solve_transposed(w);
                let proved = Contradictions::new(self, ready, &dual.gaps).proved(&w)?;
                proved.map_or(Ok(Outcome::Stalled), Err)
            }
        }
    }
}
