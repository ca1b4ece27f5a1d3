//! When F_p of a body is assembled whose K+ is a function of the host. The library does not know what a call of it costs, and a
//! choice by the clock would change bits; so it counts columns of K+, a column alone as [`ALONE`] columns of a block. Let m be the
//! number of columns that F_p takes.
//!
//! ```text
//! at once               m columns are one call, or the previous F_p has been used as much as m columns
//! during a solve        products have cost as much as m columns: together no more than twice the better of both forms
//! at the next solve     what has been used once, LASTING times more will be: with one K the host goes through a load
//! ```
//!
//! An F_p begins with its K+, or when most of its rows are new.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

use crate::body::TOGETHER;
use crate::dual::reuse::Kept;
use crate::linalg::Csr;
use crate::numbers::dual::{ALONE, LASTING};

/// What F_p of one body is used for, in columns of a block. Products with one F_p do not overlap.
#[derive(Debug, Default)]
pub struct Ledger {
    /// What products with the present F_p have cost, or would have cost if it were not assembled.
    spent: AtomicUsize,
    /// The same of the previous F_p, complete.
    before: AtomicUsize,
    /// The next product assembles F_p.
    due: AtomicBool,
    /// Columns of all F_p that were assembled during solves.
    pub assembled: AtomicUsize,
}

impl Ledger {
    /// Begins a new F_p unless most of its rows are those of `kept`; whether `kept` is assembled and goes on.
    pub(super) fn opened(&self, kept: Option<&Kept>, rows: &Csr) -> bool {
        let same = kept.filter(|kept| kept.has_most(rows));
        if same.is_none() {
            self.close();
        }
        same.is_some_and(Kept::is_assembled)
    }

    /// One that was never used tells nothing.
    fn close(&self) {
        let spent = self.spent.swap(0, Relaxed);
        if spent > 0 {
            self.before.store(spent, Relaxed);
        }
        self.due.store(false, Relaxed);
    }

    /// Whether F_p, which takes `columns`, is expected to be used for more than they cost.
    pub(super) fn expects(&self, columns: usize) -> bool {
        let (spent, before) = (self.spent.load(Relaxed), self.before.load(Relaxed));
        let more = if spent < before { before - spent } else { LASTING * spent };
        columns <= more.max(TOGETHER)
    }

    /// A solve begins with F_p, which takes `columns`, not assembled.
    pub(super) fn begin(&self, columns: usize) {
        self.due.store(self.expects(columns), Relaxed);
    }

    /// A product with F_p, by one column of K+; whether F_p, which takes `columns`, is to be assembled first.
    pub(super) fn multiplies(&self, columns: usize) -> bool {
        self.spends(ALONE, columns)
    }

    /// As `multiplies`, for `count` columns of K+ in blocks.
    pub(super) fn spends(&self, count: usize, columns: usize) -> bool {
        let spent = self.spent.fetch_add(count, Relaxed);
        self.due.load(Relaxed) || spent + count >= columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Products that a body with F_p of `columns` makes through K+ until F_p is assembled, at most `most`.
    fn products(ledger: &Ledger, columns: usize, most: usize) -> usize {
        ledger.begin(columns);
        (0..most).take_while(|_| !ledger.multiplies(columns)).count()
    }

    #[test]
    fn one_call_is_made_at_once_and_more_than_it_when_as_much_is_spent() {
        assert_eq!(products(&Ledger::default(), TOGETHER, 1), 0);
        for columns in [TOGETHER + 1, 100, 1001] {
            assert_eq!(products(&Ledger::default(), columns, columns), columns.div_ceil(ALONE) - 1);
        }
    }

    #[test]
    fn a_second_solve_assembles_if_the_first_has_used_its_share() {
        for (first, assembles) in [(10, true), (9, false)] {
            let ledger = Ledger::default();
            assert_eq!(products(&ledger, 10 * ALONE * LASTING, first), first);
            assert_eq!(products(&ledger, 10 * ALONE * LASTING, 1) == 0, assembles);
        }
    }

    #[test]
    fn the_previous_operator_says_how_much_the_next_is_used() {
        let ledger = Ledger::default();
        assert_eq!(products(&ledger, 1000, 100), 100);
        (0..2).for_each(|_| ledger.close());
        assert!(ledger.expects(100 * ALONE) && !ledger.expects(100 * ALONE + 1));
        // half of it is used: the other half is not worth more
        assert_eq!(products(&ledger, 1000, 50), 50);
        assert!(ledger.expects(50 * ALONE) && !ledger.expects(50 * ALONE + 1));
    }
}
