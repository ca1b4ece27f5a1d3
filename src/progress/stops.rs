//! When a call has to end: the host's wish to cancel it, its time limit.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
use std::time::Instant;

use crate::error::{Error, Kind, Result};

/// When to end; asked before every body of a setup and every product of a solve.
#[derive(Clone)]
pub struct Stops {
    cancelled: Arc<AtomicBool>,
    started: Instant,
    /// Seconds.
    limit: f64,
}

impl Stops {
    /// Of a call that begins now and ends after `limit` seconds.
    pub fn new(cancelled: Arc<AtomicBool>, limit: f64) -> Self {
        Self { cancelled, started: Instant::now(), limit }
    }

    /// Of nobody.
    #[cfg(test)]
    pub fn never() -> Self {
        Self::new(Arc::default(), f64::INFINITY)
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

    /// Set by any thread, it ends whatever runs.
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.cancelled)
    }

    pub fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }
}

pub fn cancelled() -> Error {
    Error::new(Kind::Cancelled, "cancelled by the host")
}
