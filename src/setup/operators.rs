//! Which bodies get an assembled (explicit) dual operator.

use crate::dual::{all_bytes, implicit_bodies, Size};
use crate::error::{Error, Result};
use crate::model::{OperatorForm, Settings};
use crate::setup::memory_limit::{check_memory, memory_limit};

/// The choice of the local dual operators.
pub struct Operators {
    /// Options by which they were chosen.
    options: Options,
    pub sizes: Vec<Size>,
    pub implicit: Vec<bool>,
    /// Bytes of all operators.
    pub bytes: usize,
    /// Bytes of all factors, shared factors counted once, plus the largest work arrays of their computation.
    pub factor_bytes: usize,
}

/// Option dual_operator and the memory limit.
type Options = (OperatorForm, Option<usize>);

impl Operators {
    /// The choice by the options and the memory left by factors of this size.
    pub fn new(settings: &Settings, sizes: Vec<Size>, factor_bytes: usize) -> Self {
        let implicit = implicit(settings, &sizes, factor_bytes);
        let bytes = all_bytes(&sizes, &implicit);
        Self { options: options(settings), sizes, implicit, bytes, factor_bytes }
    }

    /// Whether an operator whose K+ is a function of the host is assembled when use shows that it pays.
    pub fn may_wait(&self) -> bool {
        may_wait(self.options)
    }

    /// Work of the assembly of each, in operations.
    pub fn weights(&self) -> Vec<f64> {
        let sizes = self.sizes.iter().zip(&self.implicit);
        sizes.map(|(size, implicit)| 1.0 + if *implicit { 0.0 } else { size.assembly() }).collect()
    }

    /// Bytes of those on ranks other than 0.
    pub fn bytes_on_others(&self, ranks: &[usize]) -> usize {
        let of = |p: usize| self.sizes[p].bytes(self.implicit[p]);
        (0..ranks.len()).filter(|p| ranks[*p] > 0).map(of).sum()
    }

    /// Whether these options lead to the present choice.
    pub fn suit(&self, settings: &Settings) -> bool {
        let of_host = || self.sizes.iter().any(Size::is_of_host);
        options(settings) == self.options
            || implicit(settings, &self.sizes, self.factor_bytes) == self.implicit
                && (may_wait(options(settings)) == self.may_wait() || !of_host())
    }

    /// Extends the error of insufficient memory by the body that takes most.
    pub fn named(&self, mut error: Error) -> Error {
        let bytes =
            |p: usize| self.sizes[p].entries * size_of::<f64>() + self.sizes[p].bytes(self.implicit[p]);
        let largest = (0..self.sizes.len()).fold(0, |most, p| if bytes(p) > bytes(most) { p } else { most });
        error.what += "; those of this body take most";
        error.body(largest)
    }

    /// Checks `more` bytes, in addition to factors and operators, against the limit of the host.
    pub fn check_more(&self, settings: &Settings, more: usize) -> Result<()> {
        let kept = self.factor_bytes.saturating_add(self.bytes);
        check_memory(settings, kept, more, 0).map_err(|e| self.named(e))
    }
}

/// Whether the options lead to a matrix-free (implicit) operator, for each body.
fn implicit(settings: &Settings, sizes: &[Size], factor_bytes: usize) -> Vec<bool> {
    match settings.dual_operator {
        OperatorForm::Explicit => vec![false; sizes.len()],
        OperatorForm::Implicit => vec![true; sizes.len()],
        OperatorForm::Automatic => {
            implicit_bodies(sizes, memory_limit(settings).map(|limit| limit.saturating_sub(factor_bytes)))
        }
    }
}

fn may_wait((form, _): Options) -> bool {
    form == OperatorForm::Automatic
}

fn options(settings: &Settings) -> Options {
    (settings.dual_operator, memory_limit(settings))
}
