//! Who watches a setup or a solve: the host's function after every step, its wish to cancel, the time limit.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
use std::time::Instant;

use crate::dual::Dual;
use crate::error::{Error, Kind, Result};
use crate::linalg::Operator;
use crate::qp::{self, Counts, Observer, StepKind};
use crate::solver::findings::Findings;
use crate::solver::problem::Problem;
use crate::solver::setup::Ready;

/// What the host hears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// The step of the dual method that has just been done; none: a part of the setup, with counts of 0 and
    /// figures that are not numbers.
    pub step: Option<StepKind>,
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
}

impl Problem {
    /// The function that hears of every part of a setup and every step of a solve from now on.
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
        let listener = self.host.listener.take();
        let (before, last) = (Counts::default(), Counts::default());
        let mut watch = Watch { stops, listener, unit: 1.0, bounded: 0, before, last };
        let outcome = work(self, &mut watch);
        self.host.listener = watch.listener;
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
    pub fn check_cancelled(&self) -> Result<()> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(cancelled());
        }
        Ok(())
    }

    fn check(&self) -> Result<()> {
        self.check_cancelled()?;
        if self.seconds() > self.limit {
            return Err(Error::new(Kind::TimeOver, "the time is over").limit(self.limit));
        }
        Ok(())
    }

    fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }
}

fn cancelled() -> Error {
    Error::new(Kind::Cancelled, "cancelled by the host")
}

/// One call under watch.
pub(super) struct Watch {
    pub stops: Stops,
    listener: Option<Listener>,
    /// 2^p: what forces are divided by.
    unit: f64,
    /// Number of multipliers >= 0.
    bounded: usize,
    /// Work of the methods that gave up, and of the present one up to its last step.
    before: Counts,
    last: Counts,
}

impl Watch {
    /// F under watch; forces inside are in units of 2^p, multipliers of `bounded` groups are >= 0.
    pub fn operator<'a>(&mut self, ready: &'a Ready, bounded: &[bool]) -> Interruptible<'a> {
        self.unit = ready.unit;
        self.bounded = bounded.iter().filter(|bounded| **bounded).count();
        Interruptible { operator: &ready.dual, stops: self.stops.clone(), begun: AtomicBool::new(false) }
    }

    /// Tells the host that a part of the setup is done.
    pub fn part_done(&mut self) -> Result<()> {
        self.tell(&Progress {
            step: None,
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

impl Observer for Watch {
    fn step(&mut self, now: &qp::Progress) -> Result<()> {
        if now.counts.steps() < self.last.steps() || now.counts.products < self.last.products {
            self.before = self.before + self.last;
        }
        self.last = *now.counts;
        let all = self.before + self.last;
        let against_stop = |size: f64| size / now.small;
        let told = Progress {
            step: Some(now.kind),
            steps: all.steps(),
            products: all.products,
            active: self.bounded - now.active.iter().filter(|at_bound| **at_bound).count(),
            residual: against_stop(now.residual),
            free: against_stop(now.free),
            chopped: against_stop(now.chopped),
            theta: self.unit * now.theta,
            seconds: self.stops.seconds(),
        };
        self.tell(&told)?;
        self.stops.check()
    }
}

/// F, which refuses products once the host has cancelled or the time is over. The time is not asked for before
/// the first one: without it there is no answer at all.
pub(super) struct Interruptible<'a> {
    operator: &'a Dual,
    stops: Stops,
    begun: AtomicBool,
}

impl Operator for Interruptible<'_> {
    fn order(&self) -> usize {
        self.operator.order()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.operator.apply(x, y);
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        if self.begun.swap(true, Ordering::Relaxed) {
            self.stops.check()?;
        } else {
            self.stops.check_cancelled()?;
        }
        self.operator.try_apply(x, y)
    }
}
