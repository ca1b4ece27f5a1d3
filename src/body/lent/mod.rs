//! Bodies lent to other ranks: rank 0 sends them (`Lending`), the other ranks plan, make and keep K+ (`Bodies`) and tell what rank 0 has to
//! know of it (`Planned`, `Analysis`, `Made`).

mod asked;
mod kept;
mod made;
mod member;
mod planned;

pub use asked::{asked, Answering};
pub use kept::Bodies;
pub use made::Made;
pub use planned::{Analysis, NewKplus, PlanAway, Planned};

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Arc;

use crate::body::elsewhere::{ask, Asking, BodyElsewhere, Facts, Give, Name, Owed};
use crate::body::Body;
use crate::error::Result;
use crate::ranks::{Ranks, Traffic};

/// The ranks to which bodies may be lent.
pub struct Lending {
    ranks: Arc<Ranks>,
    /// Bodies are dealt out in turn, whatever they cost: for tests.
    pub all: bool,
    /// Ranks that serve, and rank 0; the others have only the bodies that the host has given there.
    pub serve: Box<[bool]>,
    /// Bodies that have been given a rank, and those of them that were lent.
    dealt: [AtomicUsize; 2],
    /// Hears of these at the end.
    pub told: Option<fn([usize; 2])>,
}

impl Drop for Lending {
    fn drop(&mut self) {
        self.told
            .iter()
            .for_each(|told| told(self.dealt.each_ref().map(|dealt| dealt.load(Ordering::Relaxed))));
    }
}

impl Lending {
    pub fn new(ranks: Arc<Ranks>, all: bool) -> Self {
        let serve = vec![true; ranks.size].into();
        Self { ranks, all, serve, dealt: Default::default(), told: None }
    }

    /// Number of ranks, with rank 0.
    pub fn size(&self) -> usize {
        self.ranks.size
    }

    /// The other ranks serve no longer.
    pub fn is_over(&self) -> bool {
        self.ranks.is_closed()
    }

    /// Counts bodies that are given a rank, and those of them that are lent.
    pub fn count(&self, bodies: usize, lent: usize) {
        [bodies, lent].into_iter().zip(&self.dealt).for_each(|(n, dealt)| {
            dealt.fetch_add(n, Ordering::Relaxed);
        });
    }

    pub fn traffic(&self) -> Traffic {
        self.ranks.traffic()
    }

    /// Asks these questions about these bodies, one request to each rank.
    pub fn ask(&self, questions: Vec<(usize, Asking)>) -> Result<Owed> {
        ask(&self.ranks, questions)
    }

    /// The question that gives a body to a rank, and what stands for it here.
    pub fn giving(&self, rank: usize, body: &Body, facts: Facts) -> (Asking, BodyElsewhere) {
        let name = self.ranks.token(rank);
        let of = Give { name: name.number, body: body.without_load() };
        (Asking::new(rank, Name::Give, of), BodyElsewhere { name, facts })
    }
}
