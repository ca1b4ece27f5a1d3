//! When a call has to end: the host cancels it, or its time limit is reached.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use crate::error::Result;
use crate::numbers::setup::NEXT_MESSAGE;
use crate::platform::interrupt::{Clock, Interrupt};

/// Conditions that end a call, and the time since it began.
#[derive(Clone)]
pub struct Stops {
    /// The interrupt of the tasks of the call: it ends them when a thread sets it or the limit is reached.
    pub interrupt: Interrupt,
    clock: Clock,
}

impl Stops {
    /// For a call that ends after `limit` seconds by `clock`.
    pub fn new(cancelled: Arc<AtomicBool>, limit: f64, clock: Clock) -> Self {
        Self { interrupt: Interrupt::new(cancelled).after(limit, Arc::clone(&clock)), clock }
    }

    /// For tests: never ends.
    #[cfg(test)]
    pub fn never() -> Self {
        Self::new(Arc::default(), f64::INFINITY, from_now())
    }

    /// The interrupt of the tasks of the call, with progress lines of loops to `say`: one per second at most, and at
    /// intervals of at least a tenth of the time so far.
    pub fn heard(&self, say: impl Fn(String) -> Result<()> + Send + Sync + 'static) -> Interrupt {
        let (clock, last) = (Arc::clone(&self.clock), Mutex::new(self.seconds()));
        let hearer = move |part: &'static str, what: &'static str, count: usize| {
            let now = clock();
            let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
            if now - *last < f64::max(1.0, NEXT_MESSAGE * now) {
                return Ok(());
            }
            *last = now;
            say(format!("{part}: {count} {what} after {now:.0} seconds"))
        };
        self.interrupt.clone().heard_by(Arc::new(hearer))
    }

    /// Ends all running tasks.
    pub fn cancel(&self) {
        self.interrupt.set();
    }

    pub fn check(&self) -> Result<()> {
        self.interrupt.check()
    }

    pub fn seconds(&self) -> f64 {
        (self.clock)()
    }
}

/// Wall time from now on.
pub fn from_now() -> Clock {
    let begun = Instant::now();
    Arc::new(move || begun.elapsed().as_secs_f64())
}
