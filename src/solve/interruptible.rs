//! Products with F, which stop when the host cancels the call.

use crate::dual::Dual;
use crate::error::Result;
use crate::linalg::Operator;
use crate::platform::{interrupt, threads};

/// F, which refuses products after the host has cancelled or the time is over.
pub struct Interruptible<'a> {
    operator: &'a Dual,
    threads: usize,
}

impl<'a> Interruptible<'a> {
    /// F with the products of the bodies on `threads` threads.
    pub fn new(operator: &'a Dual, threads: usize) -> Self {
        Self { operator, threads }
    }

    fn product(&self, x: &[f64], y: &mut [f64], share: Option<f64>) -> Result<()> {
        interrupt::check()?;
        let on_caller = |p: usize| self.operator.multiplies_on_caller(p);
        let in_parallel = |count, task: &(dyn Fn(usize) -> _ + Sync)| {
            threads::run_apart(self.threads, count, on_caller, task)
        };
        self.operator.product(x, y, share, &in_parallel)
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
        self.product(x, y, Some(1.0))
    }

    fn apply_to_share(&self, share: f64, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, Some(share))
    }

    fn approximate(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, None)
    }

    fn has_approximation(&self) -> bool {
        self.operator.has_approximation()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Kind;
    use crate::progress::Stops;
    use crate::solve::certifier::tests::two_springs;

    #[test]
    fn no_product_is_begun_after_a_cancel() {
        two_springs(0.0, |judge, solved| {
            let (f, stops) = (Interruptible::new(&judge.recovery.ready.dual, 1), Stops::never());
            let mut image = vec![0.0; 2];
            let ended = stops.interrupt.during(|| {
                f.try_apply(&solved.x, &mut image).unwrap();
                stops.cancel();
                f.try_apply(&solved.x, &mut image)
            });
            assert_eq!(ended.unwrap_err().kind, Kind::Cancelled);
        });
    }
}
