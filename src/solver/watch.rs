//! Who watches a setup or a solve: the host's function after every step, its wish to cancel, the time limit.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
use std::time::Instant;

use crate::error::{Error, Kind, Result};
use crate::platform::threads::{self, Heard, Tasks};
use crate::platform::Interrupt;
use crate::qp::{Counts, StepKind};
use crate::solver::findings::Findings;
use crate::solver::log::{Log, LogLevel};
use crate::solver::problem::Problem;
use crate::solver::steps::{Told, Voice};

/// What the host hears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// The step of the dual method that has just been done; none: a part of the setup, with counts of 0 and
    /// figures that are not numbers.
    pub step: Option<StepKind>,
    /// Part of the work of a setup that is done, an estimate that never falls; not a number in steps of the method.
    pub fraction: f64,
    pub steps: usize,
    /// Products with F.
    pub products: usize,
    /// Contact rows with a force; parallel rows count once.
    pub active: usize,
    /// Norm of the projected gradient against the one that stops the solve, and the same of its parts: on the
    /// rows with a force (22), and of the rows that want one (23).
    pub residual: f64,
    pub free: f64,
    pub chopped: f64,
    /// `1/2 l'F l - l'd`, force x length.
    pub theta: f64,
    /// Since the call began.
    pub seconds: f64,
}

/// What the host answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reply {
    Continue,
    /// End with the answer of the last step.
    Cancel,
    /// The host's function has failed, with this number.
    Failed(i32),
}

pub type Listener = Box<dyn FnMut(&Progress) -> Reply + Send + Sync>;

/// The host's function and its wish to cancel, kept between calls.
#[derive(Default)]
pub(super) struct Host {
    cancelled: Arc<AtomicBool>,
    listener: Option<Listener>,
    pub log: Log,
}

impl Problem {
    /// The function that hears of every body in every part of a setup and of every step of a solve from now on.
    pub fn on_progress(&mut self, listener: Option<Listener>) {
        self.host.listener = listener;
    }

    /// Set to true by any thread, it ends the setup or the solve that runs; the next one begins by clearing it.
    pub fn canceller(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.host.cancelled)
    }

    /// Runs `work` under watch.
    pub(super) fn watched<T>(&mut self, work: impl FnOnce(&mut Self, &mut Watch) -> Result<T>) -> Result<T> {
        let cancelled = self.canceller();
        cancelled.store(false, Ordering::Relaxed);
        let stops = Stops { cancelled, started: Instant::now(), limit: self.settings.time_limit };
        let (listener, log) = (self.host.listener.take(), std::mem::take(&mut self.host.log));
        let mut watch = Watch { stops, listener, log, fraction: 0.0, islands: Vec::new() };
        let outcome = work(self, &mut watch);
        (self.host.listener, self.host.log) = (watch.listener, watch.log);
        if let Err(error) = &outcome {
            self.findings = Some(Findings::of_error(self, error));
        }
        outcome
    }
}

/// When to end; asked before every body of a setup and every product of a solve.
#[derive(Clone)]
pub(super) struct Stops {
    cancelled: Arc<AtomicBool>,
    started: Instant,
    /// Seconds.
    limit: f64,
}

impl Stops {
    /// Of nobody.
    #[cfg(test)]
    pub fn never() -> Self {
        Self { cancelled: Arc::default(), started: Instant::now(), limit: f64::INFINITY }
    }

    /// Ends whatever runs.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    pub fn check_cancelled(&self) -> Result<()> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(cancelled());
        }
        Ok(())
    }

    pub fn check(&self) -> Result<()> {
        self.check_cancelled()?;
        if self.seconds() > self.limit {
            return Err(Error::new(Kind::TimeOver, "the time is over").limit(self.limit));
        }
        Ok(())
    }

    pub fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }
}

fn cancelled() -> Error {
    Error::new(Kind::Cancelled, "cancelled by the host")
}

/// A part of the setup that has a task for every body.
pub(super) struct Part {
    pub threads: usize,
    /// Work of each body, in any unit, > 0.
    pub weights: Vec<f64>,
    /// Fraction of the whole setup at its end.
    pub until: f64,
    /// Tasks that must run on the thread that calls the library.
    pub on_caller: Vec<bool>,
}

impl Part {
    /// Tasks that may run on any thread.
    pub fn of(threads: usize, weights: Vec<f64>, until: f64) -> Self {
        Self { threads, weights, until, on_caller: Vec::new() }
    }
}

/// One call under watch.
pub(super) struct Watch {
    pub stops: Stops,
    listener: Option<Listener>,
    pub log: Log,
    /// Of the setup.
    fraction: f64,
    /// Work of every island so far, and its rows with a force.
    islands: Vec<(Counts, usize)>,
}

impl Voice for Watch {
    fn step(&mut self, told: Told) -> Result<()> {
        if self.islands.len() <= told.island {
            self.islands.resize(told.island + 1, Default::default());
        }
        self.islands[told.island] = (told.counts, told.progress.active);
        let mut now = Progress { steps: 0, products: 0, active: 0, ..told.progress };
        for (counts, active) in &self.islands {
            now.steps += counts.steps();
            now.products += counts.products;
            now.active += active;
        }
        self.tell(&now)?;
        self.log.step(&now)
    }

    fn line(&mut self, text: String) -> Result<()> {
        self.log.say(LogLevel::Phase, || text)
    }
}

impl Watch {
    /// Runs a task for every body of a part of the setup; `keep` gets the results as they come, on this thread, which
    /// tells the host of each. The body with most work comes first: what it needs besides its result is gone when the
    /// results of the others are there. Once the host wants to end, tasks that have begun end where they can.
    pub fn every_body<T: Send>(
        &mut self,
        part: &Part,
        task: impl Fn(usize) -> Result<T> + Sync,
        mut keep: impl FnMut(usize, T),
    ) -> Result<()> {
        let (stops, interrupt) = (self.stops.clone(), Interrupt::new(Arc::clone(&self.stops.cancelled)));
        let guarded = |k| stops.check_cancelled().and_then(|()| interrupt.during(|| task(k)));
        let (begun, all) = (self.fraction, part.weights.iter().sum::<f64>());
        let (mut done, mut told) = (0.0, Ok(()));
        let mut order: Vec<usize> = (0..part.weights.len()).collect();
        order.sort_by(|&a, &b| part.weights[b].total_cmp(&part.weights[a]));
        let on_caller = |k: usize| part.on_caller.get(k) == Some(&true);
        let tasks = Tasks { threads: part.threads, order: &order, on_caller: &on_caller };
        let ended = threads::run_heard(tasks, guarded, &mut |heard| {
            if let Heard::Done(k, result) = heard {
                keep(k, result);
                done += part.weights[k];
                self.fraction = begun + (part.until - begun).max(0.0) * (done / all).min(1.0);
            }
            if told.is_ok() {
                told = self.part_done();
                if told.is_err() {
                    stops.cancel();
                }
            }
        });
        self.fraction = self.fraction.max(part.until);
        told.and(ended)
    }

    /// Tells the host that all of the setup is done.
    pub fn setup_done(&mut self) -> Result<()> {
        self.fraction = 1.0;
        self.part_done()
    }

    /// Tells the host how much of the setup is done.
    fn part_done(&mut self) -> Result<()> {
        self.tell(&Progress {
            step: None,
            fraction: self.fraction,
            steps: 0,
            products: 0,
            active: 0,
            residual: f64::NAN,
            free: f64::NAN,
            chopped: f64::NAN,
            theta: f64::NAN,
            seconds: self.stops.seconds(),
        })?;
        self.stops.check_cancelled()
    }

    fn tell(&mut self, now: &Progress) -> Result<()> {
        let Some(listener) = &mut self.listener else { return Ok(()) };
        match listener(now) {
            Reply::Continue => Ok(()),
            Reply::Cancel => Err(cancelled()),
            Reply::Failed(number) => {
                let what = format!("the progress function of the host returned {number}");
                Err(Error::new(Kind::Callback, what).value(f64::from(number)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{Modes, RowKind, RowsInput, SparseInput, Storage};
    use std::sync::Mutex;
    use std::thread::{self, ThreadId};

    const BODIES: usize = 4;
    const DOFS: usize = 600;

    /// Chains of springs, held at one end and pushed against a wall at the other: enough for several threads.
    fn chains(threads: i64) -> Problem {
        let ptr: Vec<usize> = (0..=DOFS).map(|i| (2 * i).saturating_sub(1)).collect();
        let col: Vec<i64> = (0..DOFS as i64).flat_map(|i| [i - 1, i]).skip(1).collect();
        let val: Vec<f64> = (0..DOFS).flat_map(|_| [-1.0, 2.0]).skip(1).collect();
        let mut problem = Problem::new();
        for body in 0..BODIES {
            problem.add_body(DOFS).unwrap();
            let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
            problem.set_stiffness(body, k).unwrap();
            problem.set_null_space(body, DOFS, 0, &[], 1, Modes::Exact).unwrap();
            problem.set_load(body, &[1.0; DOFS]).unwrap();
            // by their keys no two are alike: each has a part of its own in everything
            problem.bodies[body].keys = Some([body as u64; 2]);
        }
        let last: Vec<i64> = (1..=BODIES).map(|p| (p * DOFS - 1) as i64).collect();
        let ptr: Vec<usize> = (0..=BODIES).collect();
        let rows =
            RowsInput { ptr: &ptr, body: None, dof: &last, val: &[1.0; BODIES], rhs: Some(&[1.0; BODIES]) };
        problem.add_rows(RowKind::Inequality, rows).unwrap();
        problem.set_i64("threads", threads).unwrap();
        problem
    }

    type Heard = Arc<Mutex<Vec<(ThreadId, Progress)>>>;

    /// Keeps what is heard, and cancels at call `when`.
    fn listen(problem: &mut Problem, when: usize) -> Heard {
        let heard = Heard::default();
        let book = Arc::clone(&heard);
        problem.on_progress(Some(Box::new(move |now| {
            let mut book = book.lock().unwrap();
            book.push((thread::current().id(), *now));
            if book.len() == when + 1 {
                Reply::Cancel
            } else {
                Reply::Continue
            }
        })));
        heard
    }

    #[test]
    fn the_calling_thread_hears_of_every_body_with_a_fraction_that_never_falls() {
        for threads in [1, 2, 4] {
            let mut problem = chains(threads);
            problem.set_str("preconditioner", "lumped").unwrap();
            let heard = listen(&mut problem, usize::MAX);
            problem.solve().unwrap();
            let heard = heard.lock().unwrap();
            assert!(heard.iter().all(|(thread, _)| *thread == thread::current().id()));
            let setup = heard.iter().take_while(|(_, now)| now.step.is_none());
            let mut fractions: Vec<f64> = setup.map(|(_, now)| now.fraction).collect();
            assert!(fractions.windows(2).all(|pair| pair[0] <= pair[1]), "{fractions:?}");
            fractions.dedup();
            assert_eq!(fractions.len(), 4 * BODIES + 1, "{fractions:?}");
            assert!(fractions[0] > 0.0 && fractions.last() == Some(&1.0));
            assert!(heard
                .iter()
                .skip_while(|(_, now)| now.step.is_none())
                .all(|(_, now)| now.fraction.is_nan()));
        }
    }

    #[test]
    fn what_a_cancelled_setup_has_factorised_is_kept() {
        for threads in [1, 2, 4] {
            let mut problem = chains(threads);
            for when in 0..4 * BODIES {
                let heard = listen(&mut problem, when);
                problem.forget_dual();
                let ended = problem.setup();
                let calls = heard.lock().unwrap().len();
                if calls <= when {
                    break; // fewer parts are left than that
                }
                assert_eq!((ended.unwrap_err().kind, calls), (Kind::Cancelled, when + 1));
            }
            problem.on_progress(None);
            problem.solve().unwrap();
            assert_eq!(problem.work.factorisations, BODIES);
        }
    }
}
