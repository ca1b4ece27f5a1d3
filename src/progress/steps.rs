//! Reports the steps of one island.

use crate::error::Result;
use crate::progress::listener::Progress;
use crate::progress::stops::Stops;
use crate::qp::{self, Counts, Observer};

/// A step in one island.
#[derive(Clone, Copy)]
pub struct Told {
    pub island: usize,
    pub counts: Counts,
    /// Progress of this island only.
    pub progress: Progress,
}

/// Receives steps and log lines of the solution of an island: the host, or the thread that collects those of many
/// islands.
pub trait Voice {
    fn step(&mut self, told: Told) -> Result<()>;
    /// Receives a log line at level `LogLevel::Phase`.
    fn line(&mut self, text: String) -> Result<()>;
}

/// One island under watch.
pub struct Steps<'a> {
    island: usize,
    stops: Stops,
    voice: &'a mut dyn Voice,
    /// 2^p: forces are divided by it.
    unit: f64,
    /// Number of multipliers >= 0.
    bounded: usize,
    /// Work of methods that gave up, and of the present method up to its last step.
    before: Counts,
    last: Counts,
}

impl<'a> Steps<'a> {
    /// For island number `island`; forces are in units of 2^p = `unit`, multipliers of `bounded` groups are >= 0.
    pub fn new(island: usize, unit: f64, bounded: &[bool], stops: Stops, voice: &'a mut dyn Voice) -> Self {
        let bounded = bounded.iter().filter(|bounded| **bounded).count();
        let (before, last) = (Counts::default(), Counts::default());
        Self { island, stops, voice, unit, bounded, before, last }
    }

    /// Sets which multipliers are bounded from now on.
    pub fn set_bounded(&mut self, bounded: &[bool]) {
        self.bounded = bounded.iter().filter(|bounded| **bounded).count();
    }

    pub fn line(&mut self, text: String) -> Result<()> {
        self.voice.line(text)
    }
}

impl Steps<'_> {
    /// The work so far, including that of previous methods.
    fn counted(&mut self, now: Counts) -> Counts {
        if now.steps() < self.last.steps() || now.products < self.last.products {
            self.before = self.before + self.last;
        }
        self.last = now;
        self.before + self.last
    }

    fn tell(&mut self, counts: Counts, progress: Progress) -> Result<()> {
        self.voice.step(Told { island: self.island, counts, progress })?;
        self.stops.check()
    }
}

impl Observer for Steps<'_> {
    fn step(&mut self, now: &qp::StepReport) -> Result<()> {
        let counts = self.counted(*now.counts);
        let against_stop = |size: f64| size / now.small;
        let progress = Progress {
            step: Some(now.kind),
            fraction: f64::NAN,
            steps: counts.steps(),
            products: counts.products,
            active: self.bounded - now.active.iter().filter(|at_bound| **at_bound).count(),
            residual: against_stop(now.residual),
            free: against_stop(now.free),
            chopped: against_stop(now.chopped),
            theta: self.unit * now.theta,
            seconds: self.stops.seconds(),
        };
        self.tell(counts, progress)
    }
}
