//! When a call has to end: the host cancels it, or its time limit is reached.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use crate::error::Result;
use crate::platform::interrupt::{Clock, Interrupt};

/// When to end, and the time so far.
#[derive(Clone)]
pub struct Stops {
    /// What the tasks of the call run under: set by any thread, or after the limit, it ends them.
    pub interrupt: Interrupt,
    clock: Clock,
}

impl Stops {
    /// Of a call that ends after `limit` seconds by `clock`.
    pub fn new(cancelled: Arc<AtomicBool>, limit: f64, clock: Clock) -> Self {
        Self { interrupt: Interrupt::new(cancelled).after(limit, Arc::clone(&clock)), clock }
    }

    /// Of nobody.
    #[cfg(test)]
    pub fn never() -> Self {
        Self::new(Arc::default(), f64::INFINITY, from_now())
    }

    /// What the tasks of the call run under where `say` gets lines on how far their loops are: one after a second at most, and after
    /// a tenth of the time so far.
    pub fn heard(&self, say: impl Fn(String) -> Result<()> + Send + Sync + 'static) -> Interrupt {
        let (clock, last) = (Arc::clone(&self.clock), Mutex::new(self.seconds()));
        let hearer = move |part: &'static str, what: &'static str, count: usize| {
            let now = clock();
            let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
            if now - *last < f64::max(1.0, 0.1 * now) {
                return Ok(());
            }
            *last = now;
            say(format!("{part}: {count} {what} after {now:.0} seconds"))
        };
        self.interrupt.clone().heard_by(Arc::new(hearer))
    }

    /// Ends whatever runs.
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

/// Wall time since now.
pub fn from_now() -> Clock {
    let begun = Instant::now();
    Arc::new(move || begun.elapsed().as_secs_f64())
}
