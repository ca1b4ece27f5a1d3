//! Which bodies get an explicit dual operator, and whether factors and operators fit into memory.

use std::ops::Range;

use crate::dual::{all_bytes, implicit_bodies, Size};
use crate::error::{Error, Kind, Result};
use crate::linalg::memory::available;
use crate::linalg::Csr;
use crate::solver::problem::Problem;
use crate::solver::rows::DualRows;
use crate::solver::setup::Ready;

/// Multiplications of a product with F, a tenth of a millisecond, from which on several threads save time.
const PARALLEL_PAYS: usize = 1 << 18;

/// The local dual operators as they are to be made.
pub(super) struct Operators {
    pub sizes: Vec<Size>,
    pub implicit: Vec<bool>,
}

impl Operators {
    fn bytes(&self) -> usize {
        all_bytes(&self.sizes, &self.implicit)
    }

    /// Work of the assembly of each, in operations.
    pub fn weights(&self) -> Vec<f64> {
        let sizes = self.sizes.iter().zip(&self.implicit);
        sizes.map(|(size, implicit)| 1.0 + if *implicit { 0.0 } else { size.assembly() }).collect()
    }

    /// Bytes of all factors.
    pub fn factor_bytes(&self) -> usize {
        self.sizes.iter().map(|size| size.entries * size_of::<f64>()).sum()
    }
}

impl Problem {
    /// Operators for these rows where the factors of the bodies take so many bytes; refused where they do not fit.
    /// `more`: bytes of the factors that are not there yet.
    pub(super) fn operators(&self, rows: &DualRows, factors: &[usize], more: usize) -> Result<Operators> {
        let ranges = self.ranges();
        let touching = touching(&ranges, &rows.matrix);
        let size = |p: usize| Size {
            rows: touching[p],
            unknowns: ranges[p].len(),
            entries: factors[p] / size_of::<f64>(),
        };
        let sizes: Vec<Size> = (0..ranges.len()).map(size).collect();
        let operators = Operators { implicit: self.implicit(&sizes), sizes };
        let kept = factors.iter().sum::<usize>().saturating_sub(more);
        self.check_memory(kept, more.saturating_add(operators.bytes()))?;
        Ok(operators)
    }

    /// True where the options want the operator of a body to be implicit.
    fn implicit(&self, sizes: &[Size]) -> Vec<bool> {
        match self.settings.dual_operator.to_bytes() {
            b"explicit" => vec![false; sizes.len()],
            b"implicit" => vec![true; sizes.len()],
            _ => {
                let factors = sizes.iter().map(|size| size.entries * size_of::<f64>()).sum();
                implicit_bodies(sizes, self.memory_limit().map(|limit| limit.saturating_sub(factors)))
            }
        }
    }

    /// True where the options would have the operators as they are.
    pub(super) fn wants(&self, operators: &Operators) -> bool {
        self.implicit(&operators.sizes) == operators.implicit
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
    pub(super) fn check_more(&self, ready: &Ready, more: usize) -> Result<()> {
        self.check_memory(ready.operators.factor_bytes().saturating_add(ready.operators.bytes()), more)
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

/// How many rows of B touch each of the ranges, which follow each other.
fn touching(ranges: &[Range<usize>], matrix: &Csr) -> Vec<usize> {
    let mut count = vec![0; ranges.len()];
    let mut last = vec![usize::MAX; ranges.len()];
    for i in 0..matrix.rows() {
        for (j, _) in matrix.row(i) {
            let p = ranges.partition_point(|range| range.end <= j);
            if last[p] != i {
                last[p] = i;
                count[p] += 1;
            }
        }
    }
    count
}
