//! The wish of another thread that a long computation ends: set for a task, looked at inside its loops.

use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use crate::error::{Error, Kind, Result};

thread_local! {
    static PRESENT: RefCell<Interrupt> = const { RefCell::new(Interrupt(None)) };
}

/// Ends the computations that look at it once its flag is true; without a flag none. A computation that goes on on
/// several threads takes the one of the thread it began on with it.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Option<Arc<AtomicBool>>);

impl Interrupt {
    pub fn new(flag: Arc<AtomicBool>) -> Self {
        Self(Some(flag))
    }

    /// That of the task on this thread.
    pub fn present() -> Self {
        PRESENT.with_borrow(Self::clone)
    }

    /// Runs `work` on this thread under this interrupt.
    pub fn during<T>(&self, work: impl FnOnce() -> T) -> T {
        let _before = Restore(PRESENT.replace(self.clone()));
        work()
    }

    /// Ends what looks at it from now on.
    pub fn set(&self) {
        self.0.iter().for_each(|flag| flag.store(true, Ordering::Relaxed));
    }

    pub fn check(&self) -> Result<()> {
        match &self.0 {
            Some(flag) if flag.load(Ordering::Relaxed) => Err(cancelled()),
            _ => Ok(()),
        }
    }
}

pub fn cancelled() -> Error {
    Error::new(Kind::Cancelled, "cancelled by the host")
}

/// Sets the interrupt that was there before, also when the work panics.
struct Restore(Interrupt);

impl Drop for Restore {
    fn drop(&mut self) {
        PRESENT.set(std::mem::take(&mut self.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_sees_its_own_interrupt_and_the_one_before_comes_back() {
        let (outer, inner) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(true)));
        Interrupt::new(Arc::clone(&outer)).during(|| {
            let ended = Interrupt::new(inner).during(|| Interrupt::present().check());
            assert_eq!(ended.unwrap_err().kind, Kind::Cancelled);
            assert!(Interrupt::present().check().is_ok());
            outer.store(true, Ordering::Relaxed);
            assert!(Interrupt::present().check().is_err());
        });
        assert!(Interrupt::present().check().is_ok());
    }
}
