//! One contact problem: the input of the host, what has been computed from it, and what is kept between calls.

use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::sync::Arc;
use std::time::Instant;

use crate::body::Lending;
use crate::decomposition::{Connected, Decomposition};
use crate::error::{Error, Kind, Result};
use crate::model::{HostModel, LogTo, Parts, Settings, SolvedModel, StartFrom};
#[cfg(test)]
use crate::platform::interrupt::Clock;
use crate::platform::memory::Headroom;
use crate::platform::stopwatch;
use crate::progress::{Host, Listener, LogLevel, LogListener, Phase, PhaseReport, Phases, Watch};
use crate::ranks::Traffic;
use crate::setup::{Duals, Prepared, Work};
use crate::solve::{solve_islands, Answer, DualMethod, Report, Stays};
use crate::solver::decomposed::{answer_of_host, findings_of_host, of_host, same_bodies, solved};
use crate::solver::findings::{redundant, Findings};
use crate::solver::history::{Current, History};
use crate::solver::joined::Joined;
use crate::solver::noticed;
use crate::solver::told::{begin, method, result};

/// Bodies, rows and options of one contact problem, its factors, and the answer of its last solve.
#[derive(Default)]
pub struct Problem {
    pub(super) model: HostModel,
    /// The problem solved in place of the host's if bodies have several parts or are glued by joints.
    pub(super) decomposition: Option<Decomposition>,
    /// The connected components of the host's matrices.
    connected: Connected,
    pub(super) prepared: Prepared,
    pub(super) history: History,
    pub(super) findings: Option<Findings>,
    pub(super) method: Option<&'static dyn DualMethod>,
    pub(super) host: Host,
    phases: Phases,
    /// Processor seconds of the last setup or solve that the thread of the call has led; none without other ranks.
    leading: Option<f64>,
    /// Displacements of the last answer that other ranks have.
    pub(super) stays: Stays,
    /// What this rank keeps of a problem to which several have given bodies, and, on rank 0, the problem of all.
    pub(super) joined: Option<Box<Joined>>,
    pub(super) all: Option<Box<Problem>>,
}

impl Problem {
    pub fn new() -> Self {
        #[cfg_attr(not(feature = "loopback"), allow(unused_mut))]
        let mut problem = Self::default();
        #[cfg(feature = "loopback")]
        {
            use crate::serving::loopback::{by_environment, log};
            problem.prepared.lending = by_environment().map(|ranks| {
                let mut lending = Lending::new(ranks, true);
                lending.told = Some(|[bodies, lent]| log(&format!("bodies {bodies} lent {lent}")));
                lending
            });
        }
        problem
    }

    /// Makes null spaces, factors and dual operators that are missing or out of date.
    pub fn setup(&mut self) -> Result<()> {
        noticed::grown(&self.host.log, &mut self.model);
        if self.set_up_together()? {
            return Ok(());
        }
        // the memory limit includes a solve, which may follow
        self.watched("setup", f64::INFINITY, |problem, watch| {
            problem.decompose()?;
            if !problem.prepared.is_up_to_date(problem.solved()) {
                watch.phases = Phases::default();
                begin(&watch.log, &problem.model, "setup")?;
            }
            problem.set_up(watch)
        })
    }

    /// Of parts that other ranks have, nothing is kept here.
    fn set_up(&mut self, watch: &mut Watch) -> Result<()> {
        let Self { model, decomposition, prepared, .. } = self;
        let given = prepared.give(solved(model, decomposition), watch);
        given.map_err(|e| of_host(model, decomposition, e))?;
        if let Some(of) = decomposition.as_mut().filter(|of| of.has_matrices) {
            of.let_go(prepared.gone(&of.model)?);
        }
        let ended = prepared.set_up(solved(model, decomposition), watch);
        ended.map_err(|e| of_host(model, decomposition, e))
    }

    /// Solves (10)-(11) for the present loads and gaps. An incomplete answer is kept; the report says how good it is. If
    /// a group of bodies has no answer, the error says why, and the answers of the other groups are kept.
    pub fn solve(&mut self) -> Result<Report> {
        noticed::grown(&self.host.log, &mut self.model);
        if let Some(report) = self.solve_together()? {
            return Ok(report);
        }
        self.watched("solve", self.model.settings.time_limit, |problem, watch| {
            begin(&watch.log, &problem.model, "solve")?;
            noticed::data(&watch.log, &problem.model)?;
            problem.solve_watched(watch)
        })
    }

    fn solve_watched(&mut self, watch: &mut Watch) -> Result<Report> {
        let started = Instant::now();
        self.history.current = None;
        let previous = self.model.settings.start == StartFrom::Previous;
        let start = self.history().take_start(previous);
        watch.phases = Phases::default();
        self.decompose()?;
        noticed::loose(&watch.log, &self.model, self.parts())?;
        self.set_up(watch)?;
        let Self { model, decomposition, prepared, history, method: other, .. } = self;
        let (host, model) = (&*model, solved(model, decomposition));
        let told = |error| of_host(host, decomposition, error);
        prepared.set_up_preconditioner(model, watch).map_err(told)?;
        watch.log.phases(&prepared.phases(model, &watch.phases), Phase::DualSolve as usize)?;
        method(&watch.log, model, prepared, start.name())?;
        noticed::repeated(&watch.log, host, || Ok(redundant(model, prepared.done(model)?)))?;
        let solving = Instant::now();
        let ends = solve_islands(model, prepared, *other, &start, watch).map_err(told)?;
        let failure = ends.failure.clone().map(told);
        watch.phases.add(Phase::DualSolve, solving.elapsed());
        watch.phases.move_time(Phase::DualSolve, Phase::Recovery, ends.recovery);
        if let Some((answer, mut stays)) = ends.answer().map_err(told)? {
            let mut answer = answer_of_host(host, model, prepared, answer, &mut stays)?;
            self.stays = stays;
            answer.report.seconds_setup = (solving - started).as_secs_f64();
            answer.report.seconds_solve = solving.elapsed().as_secs_f64();
            answer.report.phases = prepared.phases(model, &watch.phases);
            answer.report.take_operators(prepared, prepared.done(model)?);
            answer.without = bodies_without(&answer, host, model, prepared.done(model)?);
            history.keep(answer, prepared.made);
        }
        match (failure, self.report()) {
            (None, Some(report)) => {
                let report = report.clone();
                watch.log.phases(&report.phases, usize::MAX)?;
                result(&watch.log, &self.model, &report)?;
                self.findings = Some(self.found(Findings::of_report(
                    &self.model,
                    self.solved(),
                    &self.prepared,
                    &report,
                )));
                Ok(report)
            }
            (failure, _) => {
                Err(failure.unwrap_or_else(|| Error::new(Kind::Internal, "a solve left nothing")))
            }
        }
    }

    /// The answer of the last solve, if it is valid for the present data.
    pub(super) fn current(&self) -> Option<&Current> {
        if self.is_answered_together() {
            return self.history.current.as_ref();
        }
        let is_set_up = self.prepared.duals(&self.model).is_some();
        self.history.current.as_ref().filter(|current| is_set_up && current.made == self.prepared.made)
    }

    pub(super) fn history(&mut self) -> &mut History {
        self.history.of(self.model.revisions.rows)
    }

    /// Runs `work` under watch, for at most `limit` seconds. Reports the remaining phases, or the failure, which is also
    /// kept.
    pub(super) fn watched<T>(
        &mut self,
        call: &str,
        limit: f64,
        work: impl FnOnce(&mut Self, &mut Watch) -> Result<T>,
    ) -> Result<T> {
        let mut watch = self.host.watch(limit, self.phases);
        let lends = self.prepared.lending.is_some() || cfg!(feature = "loopback");
        let (ended, leading) = match lends {
            true => {
                let (ended, seconds) = stopwatch::leading(|| work(self, &mut watch));
                (ended, Some(seconds))
            }
            false => (work(self, &mut watch), None),
        };
        let ended = ended.map_err(|mut error| {
            self.model.set_rank(&mut error.place);
            self.with_pair(error)
        });
        let outcome = ended.and_then(|done| {
            watch.log.phases(&self.prepared.phases(&self.model, &watch.phases), usize::MAX)?;
            Ok(done)
        });
        if let Err(error) = &outcome {
            watch.log.failure(call, error, self.model.settings.index_base);
            self.findings =
                Some(self.found(Findings::of_error(&self.model, self.solved(), &self.prepared, error)));
        }
        (self.phases, self.leading) = (self.host.ended(watch), leading);
        outcome
    }

    /// The method that solves take where option `method` is not `proportioning`; without one they are refused.
    pub fn offer_method(&mut self, method: &'static dyn DualMethod) {
        self.method = Some(method);
    }

    /// Processor seconds of the last setup or solve in which the thread of the call did neither work of bodies here nor wait; none without
    /// other ranks.
    pub fn seconds_leading(&self) -> Option<f64> {
        self.of_all().leading
    }

    /// What has been exchanged with other ranks, by all problems that share their stream of messages.
    pub fn traffic(&self) -> Traffic {
        let joined = self.joined.as_ref().map(|joined| joined.rank.ranks.traffic());
        joined.or_else(|| self.prepared.lending.as_ref().map(Lending::traffic)).unwrap_or_default()
    }

    /// The function that receives the progress of setups and solves from now on.
    pub fn on_progress(&mut self, listener: Option<Listener>) {
        self.host.listener = listener;
    }

    /// The clock of the following calls.
    #[cfg(test)]
    pub(super) fn set_clock(&mut self, clock: Option<Clock>) {
        self.host.clock = clock;
    }

    /// The function that receives log lines up to a level from now on.
    pub fn on_log(&mut self, listener: Option<(LogLevel, LogListener)>) {
        self.host.log.tell_host(listener);
    }

    /// Changes options; if the file of the log cannot be opened, none.
    pub(super) fn set_options(
        &mut self,
        argument: &'static str,
        set: impl FnOnce(&mut HostModel) -> Result<()>,
    ) -> Result<()> {
        let before = self.model.settings.clone();
        set(&mut self.model)?;
        let Settings { log_file, log_level, .. } = &self.model.settings;
        if (log_file, *log_level) == (&before.log_file, before.log_level) {
            return Ok(());
        }
        let most = match log_level {
            LogTo::Result => LogLevel::Result,
            LogTo::Phase => LogLevel::Phase,
            LogTo::Step => LogLevel::Step,
        };
        self.host.log.tell_file(log_file, most).map_err(|error| {
            self.model.settings = before;
            Error::argument(argument, format!("option \"log_file\": {}", error.what))
        })
    }

    /// If any thread sets it to true, the running setup or solve ends; the next call clears it first.
    pub fn canceller(&self) -> Arc<AtomicBool> {
        self.host.canceller()
    }

    /// Time and memory of the phases of the last setup or solve, also if it failed.
    pub fn phases(&self) -> Vec<PhaseReport> {
        if let Some(report) = self.report().filter(|_| self.is_answered_together()) {
            return report.phases.clone();
        }
        let of = self.of_all();
        of.prepared.phases(&of.model, &of.phases)
    }

    /// Work of all setups so far; on rank 0 of those of all ranks.
    pub fn work(&self) -> Work {
        self.of_all().prepared.work()
    }

    /// Reserves memory for setup, solve and check while the result is kept; data out of date are dropped first.
    pub fn working_headroom(&mut self) -> Result<Headroom> {
        if self.is_of_several() {
            return self.prepared.working_headroom(&self.model);
        }
        self.follow();
        self.prepared.working_headroom(solved(&self.model, &self.decomposition))
    }

    /// As `working_headroom`, for a call that only needs the setup; none if the setup exists.
    pub fn setup_headroom(&mut self) -> Result<Option<Headroom>> {
        if self.is_of_several() {
            return Ok(None);
        }
        self.follow();
        self.prepared.setup_headroom(solved(&self.model, &self.decomposition))
    }

    /// Drops data that are out of date. The call that needs missing input reports it.
    fn follow(&mut self) {
        drop(self.decompose());
        self.prepared.follow(solved(&self.model, &self.decomposition));
    }
}

/// Translation between the bodies of the host and their parts.
impl Problem {
    /// The bodies have other numbers than before.
    pub(super) fn forget_bodies(&mut self) {
        self.prepared.forget();
        (self.decomposition, self.connected) = (None, Connected::default());
    }

    /// The model that is solved: that of the host, or that of the pieces at the last call that used them.
    pub(super) fn solved(&self) -> &SolvedModel {
        solved(&self.model, &self.decomposition)
    }

    /// The parts of the bodies, if some body has several.
    pub(super) fn parts(&self) -> Option<&Parts> {
        self.decomposition.as_ref().and_then(|of| of.model.parts.as_deref())
    }

    /// The bodies that are solved for a body of the host.
    pub(super) fn parts_of(&self, body: usize) -> Range<usize> {
        self.parts().map_or(body..body + 1, |parts| parts.of(body))
    }

    /// Updates parts, rows, loads and options to those of the host.
    pub(super) fn decompose(&mut self) -> Result<()> {
        self.model.check_complete()?;
        self.model.check_named()?;
        self.connected.follow(&self.model)?;
        // of bodies on other ranks the model that is solved has no matrices
        let lends = self.prepared.lending.as_ref().is_some_and(|lending| !lending.is_over());
        let serves = |known: &Decomposition| known.is_of(&self.model) && (known.has_matrices || lends);
        let is_due = lends || Decomposition::is_due(&self.model, &self.connected);
        match &mut self.decomposition {
            Some(known) if serves(known) => known.refresh(&self.model),
            None if !is_due => Ok(()),
            _ => {
                let made = is_due.then(|| Decomposition::of(&self.model, &self.connected)).transpose()?;
                if !same_bodies(&made, &self.decomposition) {
                    self.prepared.forget();
                }
                self.decomposition = made;
                Ok(())
            }
        }
    }

    /// Converts findings about parts to findings about bodies.
    pub(super) fn found(&self, findings: Findings) -> Findings {
        match self.parts() {
            Some(_) => findings_of_host(&self.model, self.solved(), findings),
            None => findings,
        }
    }

    /// Refuses a body that is cut: it has no factor of its own.
    pub(super) fn check_whole_body(&self, body: usize) -> Result<()> {
        if self.model.given(body)?.body.assembled().is_none() {
            return Ok(());
        }
        let what = "the body is cut into pieces and has no K+ of its own: option pieces = 1, set before its elements, leaves it whole";
        Err(Error::new(Kind::State, what).body(body))
    }
}

/// Which bodies of the host have no answer.
fn bodies_without(answer: &Answer, host: &HostModel, model: &SolvedModel, duals: &Duals) -> Vec<bool> {
    let parts = |body: usize| model.parts.as_ref().map_or(body..body + 1, |parts| parts.of(body));
    let fails = |body: usize| parts(body).any(|part| answer.failed[duals.island_of[part]]);
    (0..host.bodies.len()).map(fails).collect()
}
