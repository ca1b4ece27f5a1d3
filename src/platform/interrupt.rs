//! Ends a long computation if another thread requests it or its time is over. An interrupt is set for a task and checked in its loops.

use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use crate::error::{Error, Kind, Result};

thread_local! {
    static PRESENT: RefCell<Interrupt> = const { RefCell::new(Interrupt { flag: None, time: None, hearer: None }) };
    static PART: Cell<&'static str> = const { Cell::new("") };
}

/// Seconds since a call has begun.
pub type Clock = Arc<dyn Fn() -> f64 + Send + Sync>;

/// Hears how far a loop is: the part of the call that it belongs to, what it counts, and how many of those are done.
pub type Hearer = Arc<dyn Fn(&'static str, &'static str, usize) -> Result<()> + Send + Sync>;

/// Ends the computations that look at it once its flag is true or its clock shows more than its limit; without either
/// none. A computation that goes on on several threads takes the one of the thread it began on with it.
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

    /// The same, which also ends what looks at it after `limit` seconds.
    pub fn after(self, limit: f64, clock: Clock) -> Self {
        Self { time: Some((clock, limit)), ..self }
    }

    /// The same, with somebody who hears how far the loops are; an error of his ends them.
    pub fn heard_by(self, hearer: Hearer) -> Self {
        Self { hearer: Some(hearer), ..self }
    }

    /// The same for other threads, where nobody hears how far the loops are.
    pub fn unheard(self) -> Self {
        Self { hearer: None, ..self }
    }

    /// That of the task on this thread.
    pub fn present() -> Self {
        PRESENT.with_borrow(Self::clone)
    }

    /// Runs `work` on this thread under this interrupt.
    pub fn during<T>(&self, work: impl FnOnce() -> T) -> T {
        let _before = self.enter();
        work()
    }

    /// That of the task on this thread from now on, until what is returned is dropped.
    pub fn enter(&self) -> Entered {
        Entered(PRESENT.replace(self.clone()))
    }

    /// Ends what looks at it from now on.
    pub fn set(&self) {
        self.flag.iter().for_each(|flag| flag.store(true, Ordering::Relaxed));
    }

    pub fn check(&self) -> Result<()> {
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

/// Refuses what the task on this thread is about to do, once it has to end. Asked before every costly part of a loop: a product, a
/// factorisation, a system solved with its factor.
pub fn check() -> Result<()> {
    PRESENT.with_borrow(Interrupt::check)
}

/// The same in a loop that may take long: it says that `count` of `what` are done.
pub fn reached(what: &'static str, count: usize) -> Result<()> {
    check()?;
    // who hears it may run other tasks on this thread
    let hearer = PRESENT.with_borrow(|present| present.hearer.clone());
    hearer.map_or(Ok(()), |hearer| hearer(PART.get(), what, count))
}

/// Runs `work` as the part of the call that `name` names.
pub fn part<T>(name: &'static str, work: impl FnOnce() -> T) -> T {
    let _before = RestorePart(PART.replace(name));
    work()
}

/// Runs what is done also where there is no time for more: what an answer is told by, and functions of the host, which may use other
/// problems.
pub fn never<T>(work: impl FnOnce() -> T) -> T {
    Interrupt::default().during(work)
}

pub fn cancelled() -> Error {
    Error::new(Kind::Cancelled, "cancelled by the host")
}

/// Of one that is present: dropped, also by a panic, it sets the interrupt that was there before.
pub struct Entered(Interrupt);

impl Drop for Entered {
    fn drop(&mut self) {
        PRESENT.set(std::mem::take(&mut self.0));
    }
}

/// The same for the part.
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
