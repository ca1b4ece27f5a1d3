//! One call under observation: reports every body of a setup and every step to the host, which may end the call.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use crate::error::{Error, Kind, Result};
use crate::platform::interrupt::{self, cancelled, Clock};
use crate::platform::threads::{self, TaskEvent, Tasks};
use crate::progress::listener::{Listener, Progress, Reply};
use crate::progress::log::{Log, LogLevel};
use crate::progress::phases::Phases;
use crate::progress::steps::{Told, Voice};
use crate::progress::stops::{from_now, Stops};
use crate::qp::Counts;

/// The host's functions and its wish to cancel, kept between calls.
#[derive(Default)]
pub struct Host {
    cancelled: Arc<AtomicBool>,
    pub listener: Option<Listener>,
    pub log: Log,
    /// What shows the seconds of a call; none: wall time from its beginning.
    pub clock: Option<Clock>,
}

impl Host {
    /// Set to true by any thread, it ends the setup or the solve that runs; the next one begins by clearing it.
    pub fn canceller(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.cancelled)
    }

    /// Begins a call, which ends after `limit` seconds; `phases` are those of the calls before.
    pub fn watch(&mut self, limit: f64, phases: Phases) -> Watch {
        self.cancelled.store(false, Ordering::Relaxed);
        let clock = self.clock.clone().unwrap_or_else(from_now);
        let stops = Stops::new(self.canceller(), limit, clock);
        let (listener, log) = (self.listener.take(), std::mem::take(&mut self.log));
        Watch { stops, listener, log, phases, fraction: 0.0, islands: Vec::new() }
    }

    /// The call has ended: takes back what it was watched with, and gives its phases.
    pub fn ended(&mut self, watch: Watch) -> Phases {
        (self.listener, self.log) = (watch.listener, watch.log);
        watch.phases
    }
}

/// A part of the setup that has a task for every body.
pub struct SetupPart {
    pub threads: usize,
    /// Work of each body, in any unit, > 0.
    pub weights: Vec<f64>,
    /// Fraction of the whole setup at its end.
    pub until: f64,
    /// Tasks that must run on the thread that calls the library.
    pub on_caller: Vec<bool>,
}

impl SetupPart {
    /// Tasks that may run on any thread.
    pub fn of(threads: usize, weights: Vec<f64>, until: f64) -> Self {
        Self { threads, weights, until, on_caller: Vec::new() }
    }
}

/// One call under watch.
pub struct Watch {
    pub stops: Stops,
    listener: Option<Listener>,
    pub log: Log,
    pub phases: Phases,
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
        part: &SetupPart,
        task: impl Fn(usize) -> Result<T> + Sync,
        mut keep: impl FnMut(usize, T),
    ) -> Result<()> {
        let stops = self.stops.clone();
        let guarded = |k| stops.check().and_then(|()| stops.interrupt.during(|| task(k)));
        let (begun, all) = (self.fraction, part.weights.iter().sum::<f64>());
        let (mut done, mut told) = (0.0, Ok(()));
        let mut order: Vec<usize> = (0..part.weights.len()).collect();
        order.sort_by(|&a, &b| part.weights[b].total_cmp(&part.weights[a]));
        let on_caller = |k: usize| part.on_caller.get(k) == Some(&true);
        let tasks = Tasks { threads: part.threads, order: &order, on_caller: &on_caller };
        let ended = threads::run_heard(tasks, guarded, &mut |heard| {
            if let TaskEvent::Done(k, result) = heard {
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
        self.stops.check()
    }

    fn tell(&mut self, now: &Progress) -> Result<()> {
        let Some(listener) = &mut self.listener else { return Ok(()) };
        match interrupt::never(|| listener(now)) {
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
    use std::sync::atomic::AtomicUsize;

    /// One task after the other; the first one is where another thread cancels.
    #[test]
    fn no_body_is_begun_after_a_cancel() {
        let (begun, mut watch) = (AtomicUsize::new(0), Host::default().watch(1e300, Phases::default()));
        let stops = watch.stops.clone();
        let task = |_| {
            begun.fetch_add(1, Ordering::Relaxed);
            stops.cancel();
            Ok(())
        };
        let ended = watch.every_body(&SetupPart::of(1, vec![1.0; 4], 1.0), task, |_, ()| {});
        assert_eq!(ended.unwrap_err().kind, Kind::Cancelled);
        assert_eq!(begun.into_inner(), 1);
    }
}
