//! When a call has to end: the host's wish to cancel it, its time limit.

use std::sync::atomic::AtomicBool;
use std::sync::Arc;
use std::time::Instant;

use crate::error::{Error, Kind, Result};
use crate::platform::Interrupt;

/// When to end; asked before every body of a setup and every product of a solve.
#[derive(Clone)]
pub struct Stops {
    /// Set by any thread, it ends whatever runs.
    pub interrupt: Interrupt,
    started: Instant,
    /// Seconds.
    limit: f64,
}

impl Stops {
    /// Of a call that begins now and ends after `limit` seconds.
    pub fn new(cancelled: Arc<AtomicBool>, limit: f64) -> Self {
        Self { interrupt: Interrupt::new(cancelled), started: Instant::now(), limit }
    }

    /// Of nobody.
    #[cfg(test)]
    pub fn never() -> Self {
        Self::new(Arc::default(), f64::INFINITY)
    }

    /// Ends whatever runs.
    pub fn cancel(&self) {
        self.interrupt.set();
    }

    pub fn check_cancelled(&self) -> Result<()> {
        self.interrupt.check()
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
