//! Products with F, which end where the host wants to.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::dual::Dual;
use crate::error::Result;
use crate::linalg::Operator;
use crate::platform::threads;
use crate::progress::Stops;

/// F, which refuses products once the host has cancelled or the time is over. The time is not asked for before
/// the first one: without it there is no answer at all.
pub struct Interruptible<'a> {
    operator: &'a Dual,
    stops: Stops,
    begun: AtomicBool,
    threads: usize,
}

impl<'a> Interruptible<'a> {
    /// The products of the bodies on so many threads.
    pub fn new(operator: &'a Dual, stops: Stops, threads: usize) -> Self {
        Self { operator, stops, begun: AtomicBool::new(false), threads }
    }
}

impl Operator for Interruptible<'_> {
    fn order(&self) -> usize {
        self.operator.order()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.operator.apply(x, y);
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        if self.begun.swap(true, Ordering::Relaxed) {
            self.stops.check()?;
        } else {
            self.stops.check_cancelled()?;
        }
        let on_caller = |p: usize| self.operator.multiplies_on_caller(p);
        let in_parallel = |count, task: &(dyn Fn(usize) -> _ + Sync)| {
            threads::run_apart(self.threads, count, on_caller, task)
        };
        self.operator.product(x, y, &in_parallel)
    }
}
