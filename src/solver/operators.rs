//! Which bodies get an explicit dual operator, and whether factors and operators fit into memory.

use crate::dual::{all_bytes, implicit_bodies, Kept, Size};
use crate::error::{Error, Kind, Result};
use crate::platform::memory::available;
use crate::solver::problem::{BodySlot, Problem};
use crate::solver::setup::Ready;
use crate::solver::words::OperatorForm;

/// Multiplications of a product with F, a tenth of a millisecond, from which on several threads save time.
const PARALLEL_PAYS: usize = 1 << 18;

/// The local dual operators as they are to be made.
pub(super) struct Operators {
    /// Options they were chosen by.
    options: Options,
    pub sizes: Vec<Size>,
    pub implicit: Vec<bool>,
    /// Bytes of all factors, those that bodies share once, and at most of the work arrays of their computation.
    pub factor_bytes: usize,
}

/// Option dual_operator and the limit of memory.
type Options = (OperatorForm, Option<usize>);

impl Operators {
    fn bytes(&self) -> usize {
        all_bytes(&self.sizes, &self.implicit)
    }

    /// Work of the assembly of each, in operations.
    pub fn weights(&self) -> Vec<f64> {
        let sizes = self.sizes.iter().zip(&self.implicit);
        sizes.map(|(size, implicit)| 1.0 + if *implicit { 0.0 } else { size.assembly() }).collect()
    }
}

impl Problem {
    /// Operators for so many distinct rows on each body where the factors of the bodies have so many entries; refused where they do not fit.
    /// Operators kept from the rows before are dropped if that helps. `more`: bytes of the factors that are not there yet.
    pub(super) fn operators(&mut self, rows: &[usize], entries: &[usize], more: usize) -> Result<Operators> {
        let there = self.bytes_of_factors();
        let size = |((&rows, slot), &entries): ((&usize, &BodySlot), &usize)| Size {
            rows,
            unknowns: slot.body.order,
            entries,
        };
        let sizes: Vec<Size> = rows.iter().zip(&self.bodies).zip(entries).map(size).collect();
        let factor_bytes = there.saturating_add(more);
        let (options, implicit) = (self.options(), self.implicit(&sizes, factor_bytes));
        let operators = Operators { options, sizes, implicit, factor_bytes };
        let more = more.saturating_add(operators.bytes());
        let inverses = self.bodies.iter().filter_map(|slot| slot.inverse.as_ref());
        let kept: usize = inverses.filter_map(|inverse| inverse.operator.as_ref()).map(Kept::bytes).sum();
        if kept > 0 && self.check_memory(there, more.saturating_add(kept)).is_err() {
            self.bodies.iter_mut().filter_map(|slot| slot.inverse.as_mut()).for_each(|of| of.operator = None);
        }
        self.check_memory(there, more)?;
        Ok(operators)
    }

    /// True where the options want the operator of a body to be implicit.
    fn implicit(&self, sizes: &[Size], factor_bytes: usize) -> Vec<bool> {
        match self.settings.dual_operator {
            OperatorForm::Explicit => vec![false; sizes.len()],
            OperatorForm::Implicit => vec![true; sizes.len()],
            OperatorForm::Automatic => {
                implicit_bodies(sizes, self.memory_limit().map(|limit| limit.saturating_sub(factor_bytes)))
            }
        }
    }

    /// True where the options would have the operators as they are.
    pub(super) fn wants(&self, operators: &Operators) -> bool {
        self.options() == operators.options
            || self.implicit(&operators.sizes, operators.factor_bytes) == operators.implicit
    }

    fn options(&self) -> Options {
        (self.settings.dual_operator, self.memory_limit())
    }

    /// Threads for the products of the bodies with F: those of the setup where they cost more than waking them.
    pub(super) fn product_threads(&self, ready: &Ready) -> usize {
        if ready.dual.product_work() < PARALLEL_PAYS {
            1
        } else {
            self.threads()
        }
    }

    fn memory_limit(&self) -> Option<usize> {
        usize::try_from(self.settings.memory_limit).ok().filter(|limit| *limit > 0)
    }

    /// `more` bytes besides factors and operators that are there, against the limit of the host.
    pub(super) fn check_more(&self, operators: &Operators, more: usize) -> Result<()> {
        self.check_memory(operators.factor_bytes.saturating_add(operators.bytes()), more)
    }

    /// Bytes that are there and more against the limit of the host, and those to come against what the system would
    /// give.
    fn check_memory(&self, kept: usize, more: usize) -> Result<()> {
        let needed = kept.saturating_add(more);
        if let Some(limit) = self.memory_limit().filter(|limit| needed > *limit) {
            let what = format!("factors and dual operators take {needed} bytes, memory_limit is {limit}");
            return Err(Error::new(Kind::Memory, what).value(needed as f64).limit(limit as f64));
        }
        available(more, "factors and dual operators")
    }
}
