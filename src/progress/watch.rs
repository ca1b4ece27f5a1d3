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

/// The host's functions and its request to cancel, kept between calls.
#[derive(Default)]
pub struct Host {
    cancelled: Arc<AtomicBool>,
    pub listener: Option<Listener>,
    pub log: Log,
    /// The clock of a call, in seconds; none: wall time since its beginning.
    pub clock: Option<Clock>,
}

impl Host {
    /// If any thread sets it to true, the running setup or solve ends; the next call clears it first.
    pub fn canceller(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.cancelled)
    }

    /// Begins a call, which ends after `limit` seconds; `phases` are those of previous calls.
    pub fn watch(&mut self, limit: f64, phases: Phases) -> Watch {
        self.cancelled.store(false, Ordering::Relaxed);
        let clock = self.clock.clone().unwrap_or_else(from_now);
        let stops = Stops::new(self.canceller(), limit, clock);
        let (listener, log) = (self.listener.take(), std::mem::take(&mut self.log));
        Watch { stops, listener, log, phases, fraction: 0.0, islands: Vec::new(), all: [0; 3] }
    }

    /// Ends the call: takes back its listeners and returns its phases.
    pub fn ended(&mut self, watch: Watch) -> Phases {
        (self.listener, self.log) = (watch.listener, watch.log);
        watch.phases
    }
}

/// A part of the setup with one task per body.
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
    /// Completed part of the setup.
    fraction: f64,
    /// Steps, products and rows with a force of every island so far, and of all together.
    islands: Vec<[usize; 3]>,
    all: [usize; 3],
}

impl Voice for Watch {
    fn step(&mut self, told: Told) -> Result<()> {
        if self.islands.len() <= told.island {
            self.islands.resize(told.island + 1, Default::default());
        }
        let now = [told.counts.steps(), told.counts.products, told.progress.active];
        let before = std::mem::replace(&mut self.islands[told.island], now);
        self.all = std::array::from_fn(|k| self.all[k] + now[k] - before[k]);
        let [steps, products, active] = self.all;
        let now = Progress { steps, products, active, ..told.progress };
        self.tell(&now)?;
        self.log.step(&now)
    }

    fn line(&mut self, text: String) -> Result<()> {
        self.log.say(LogLevel::Phase, || text)
    }
}

impl Watch {
    /// Runs a task for every body in a part of the setup; `keep` receives the results in any order on this thread, which
    /// reports each to the host. The body with most work comes first, so that its temporary memory is freed before all
    /// results are stored. If the host wants to end, tasks that have begun end as soon as possible.
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

    /// Reports to the host that the setup is complete.
    pub fn setup_done(&mut self) -> Result<()> {
        self.fraction = 1.0;
        self.part_done()
    }

    /// Reports to the host the completed part of the setup.
    pub fn part_done(&mut self) -> Result<()> {
        self.tell(&Progress::of_setup(self.fraction, self.stops.seconds()))?;
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
    use crate::qp::Counts;
    use std::sync::atomic::AtomicUsize;

    /// One task after the other; the first is running when another thread cancels.
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

    #[test]
    fn a_report_counts_the_products_and_forces_of_all_islands_up_to_their_last_step() {
        let mut watch = Host::default().watch(1e300, Phases::default());
        for (island, products, active) in [(3, 5, 2), (0, 7, 4), (3, 9, 1)] {
            let counts = Counts { products, ..Counts::default() };
            watch
                .step(Told { island, counts, progress: Progress { active, ..Progress::of_setup(1.0, 0.0) } })
                .unwrap();
        }
        assert_eq!(watch.all, [0, 16, 5]);
    }
}
