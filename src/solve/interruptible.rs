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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Kind;
    use crate::solve::certifier::tests::two_springs;

    #[test]
    fn no_product_is_begun_after_a_cancel() {
        for begun in [false, true] {
            two_springs(0.0, |judge, solved| {
                let stops = judge.recovery.faces.stops;
                let f = Interruptible::new(&judge.recovery.ready.dual, stops.clone(), 1);
                let mut image = vec![0.0; 2];
                if begun {
                    f.try_apply(&solved.x, &mut image).unwrap();
                }
                stops.cancel();
                assert_eq!(f.try_apply(&solved.x, &mut image).unwrap_err().kind, Kind::Cancelled);
            });
        }
    }
}
