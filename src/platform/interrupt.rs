//! Ends a long computation if another thread requests it or its time is over. An interrupt is set for a task and checked
//! in its loops.

use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use crate::error::{Error, Kind, Result};
use crate::platform::shortage::is_short;

thread_local! {
    static PRESENT: RefCell<Interrupt> = const { RefCell::new(Interrupt { flag: None, time: None, hearer: None }) };
    static PART: Cell<&'static str> = const { Cell::new("") };
}

/// Seconds since a call began.
pub type Clock = Arc<dyn Fn() -> f64 + Send + Sync>;

/// Receives the progress of a loop: the part of the call, what the loop counts, and how many are done.
pub type Hearer = Arc<dyn Fn(&'static str, &'static str, usize) -> Result<()> + Send + Sync>;

/// Ends the computations that check it when its flag is true or its clock is past its limit; without flag and clock it
/// ends none. A computation on several threads passes it on from the thread on which it began.
#[derive(Clone, Default)]
pub struct Interrupt {
    flag: Option<Arc<AtomicBool>>,
    /// The limit in seconds.
    time: Option<(Clock, f64)>,
    hearer: Option<Hearer>,
}

impl Interrupt {
    pub fn new(flag: Arc<AtomicBool>) -> Self {
        Self { flag: Some(flag), ..Self::default() }
    }

    /// Adds a limit: it also ends computations after `limit` seconds.
    pub fn after(self, limit: f64, clock: Clock) -> Self {
        Self { time: Some((clock, limit)), ..self }
    }

    /// Adds a function that receives the progress of loops; an error of this function ends them.
    pub fn heard_by(self, hearer: Hearer) -> Self {
        Self { hearer: Some(hearer), ..self }
    }

    /// A copy for other threads, without progress of loops.
    pub fn unheard(self) -> Self {
        Self { hearer: None, ..self }
    }

    /// The interrupt of the task on this thread.
    pub fn present() -> Self {
        PRESENT.with_borrow(Self::clone)
    }

    /// Runs `work` on this thread under this interrupt.
    pub fn during<T>(&self, work: impl FnOnce() -> T) -> T {
        let _before = self.enter();
        work()
    }

    /// Sets it as the interrupt of this thread until the result is dropped.
    pub fn enter(&self) -> Entered {
        Entered(PRESENT.replace(self.clone()))
    }

    /// Ends all computations that check it from now on.
    pub fn set(&self) {
        self.flag.iter().for_each(|flag| flag.store(true, Ordering::Relaxed));
    }

    /// Seconds until its limit; infinite without one.
    pub fn seconds_left(&self) -> f64 {
        self.time.as_ref().map_or(f64::INFINITY, |(clock, limit)| limit - clock())
    }

    pub fn check(&self) -> Result<()> {
        if is_short() {
            return Err(Error::new(Kind::Memory, "memory for a small block could not be reserved"));
        }
        if self.flag.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            return Err(cancelled());
        }
        match &self.time {
            Some((clock, limit)) if clock() > *limit => {
                Err(Error::new(Kind::TimeOver, "the time is over").limit(*limit))
            }
            _ => Ok(()),
        }
    }
}

/// Returns an error if the task on this thread has to end. Called before every expensive part of a loop: a product, a
/// factorisation, a solve with a factor.
pub fn check() -> Result<()> {
    PRESENT.with_borrow(Interrupt::check)
}

/// As `check`, in a loop that may take long: also reports that `count` of `what` are done.
pub fn reached(what: &'static str, count: usize) -> Result<()> {
    check()?;
    // the function may run other tasks on this thread
    let hearer = PRESENT.with_borrow(|present| present.hearer.clone());
    hearer.map_or(Ok(()), |hearer| hearer(PART.get(), what, count))
}

/// Runs `work` as the part `name` of the call.
pub fn part<T>(name: &'static str, work: impl FnOnce() -> T) -> T {
    let _before = RestorePart(PART.replace(name));
    work()
}

/// Runs `work` without interrupt: the output of an answer after the time limit, and functions of the host, which may use
/// other problems.
pub fn never<T>(work: impl FnOnce() -> T) -> T {
    Interrupt::default().during(work)
}

pub fn cancelled() -> Error {
    Error::new(Kind::Cancelled, "cancelled by the host")
}

/// When dropped, also after a panic, it restores the previous interrupt.
pub struct Entered(Interrupt);

impl Drop for Entered {
    fn drop(&mut self) {
        PRESENT.set(std::mem::take(&mut self.0));
    }
}

/// Restores the previous part.
struct RestorePart(&'static str);

impl Drop for RestorePart {
    fn drop(&mut self) {
        PART.set(self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_sees_its_own_interrupt_and_the_one_before_comes_back() {
        let (outer, inner) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(true)));
        Interrupt::new(Arc::clone(&outer)).during(|| {
            let ended = Interrupt::new(inner).during(check);
            assert_eq!(ended.unwrap_err().kind, Kind::Cancelled);
            assert!(check().is_ok());
            outer.store(true, Ordering::Relaxed);
            assert!(check().is_err());
            assert!(never(check).is_ok());
        });
        assert!(check().is_ok());
    }

    #[test]
    fn a_loop_says_how_far_it_is_in_its_part() {
        let hearer: Hearer = Arc::new(|part, what, count| {
            assert_eq!((part, what), (if count < 3 { "inner" } else { "outer" }, "rounds"));
            if count < 4 {
                Ok(())
            } else {
                Err(Error::new(Kind::Callback, "enough"))
            }
        });
        Interrupt::default().heard_by(hearer).during(|| {
            part("outer", || {
                part("inner", || reached("rounds", 2)).unwrap();
                reached("rounds", 3).unwrap();
                assert_eq!(reached("rounds", 4).unwrap_err().kind, Kind::Callback);
            });
        });
    }

    #[test]
    fn a_task_ends_after_its_limit_and_not_at_it() {
        for (seconds, ends) in [(0.0, false), (2.0, false), (2.5, true)] {
            let clock: Clock = Arc::new(move || seconds);
            let ended = Interrupt::default().after(2.0, clock).during(check);
            assert_eq!(ended.err().map(|error| error.kind), ends.then_some(Kind::TimeOver), "{seconds}");
        }
    }
}
