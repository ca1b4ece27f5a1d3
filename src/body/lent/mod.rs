//! Bodies lent to other ranks: rank 0 sends their plans (`Lending`), the other ranks make and keep K+ (`Bodies`) and tell what rank 0
//! has to know of it (`Made`).

mod asked;
mod kept;
mod made;
mod member;

pub use asked::{asked, Answering};
pub use kept::Bodies;
pub use made::Made;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Arc;

use crate::body::elsewhere::{ask, Asking, Elsewhere, Name, Owed};
use crate::body::plan::Plan;
use crate::error::Result;
use crate::ranks::{wire_struct, Ranks, Token, Traffic};

/// The question for a K+ by this plan: with the factor of the K+ `of` if given; otherwise with one of its own, which may be `rounded` to
/// single precision.
struct Factorise {
    kplus: u64,
    of: Option<u64>,
    rounded: bool,
    plan: Arc<Plan>,
}

wire_struct!(Factorise { kplus, of, rounded, plan });

/// The ranks to which bodies may be lent.
pub struct Lending {
    ranks: Arc<Ranks>,
    /// Bodies are dealt out in turn, whatever they cost: for tests.
    pub all: bool,
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
        Self { ranks, all, dealt: Default::default(), told: None }
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

    /// The question for a K+ by this plan, and its name: with the factor of `of` if given; otherwise with one of its own, which may be
    /// `rounded`.
    pub fn factorising(
        &self,
        rank: usize,
        plan: &Arc<Plan>,
        of: Option<&Elsewhere>,
        rounded: bool,
    ) -> (Asking, Arc<Token>) {
        let token = Arc::new(self.ranks.token(rank));
        let (kplus, of, plan) = (token.number, of.map(Elsewhere::name), Arc::clone(plan));
        (Asking::new(rank, Name::Factorise, Factorise { kplus, of, rounded, plan }), token)
    }
}
