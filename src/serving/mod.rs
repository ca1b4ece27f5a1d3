//! What a rank other than 0 does: it keeps what rank 0 has sent, and answers.

#[cfg(feature = "loopback")]
pub mod loopback;
mod questions;

pub use questions::taken;

use std::collections::BTreeMap;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::body::{Bodies, ABOUT_BODIES};
use crate::error::{Error, Kind, Result};
use crate::platform::interrupt::Interrupt;
use crate::platform::shortage::RunningCall;
use crate::platform::threads;
use crate::ranks::{message, Incoming, Ranks, Wire, END};

/// The first request of a call that all ranks make; it begins with the number of the problem. A rank that serves answers None.
pub const BEGIN: u32 = 2;

/// This rank on a stream of messages, and what it keeps for rank 0.
pub struct Rank {
    pub ranks: Arc<Ranks>,
    pub bodies: Bodies,
    /// The problems to which it has given bodies: their numbers here, and on rank 0 once it has asked.
    problems: Mutex<BTreeMap<u64, Option<u64>>>,
}

impl Rank {
    pub fn new(ranks: Arc<Ranks>) -> Arc<Self> {
        Arc::new(Self { ranks, bodies: Bodies::new(taken), problems: Mutex::default() })
    }

    /// A problem here, with its number on rank 0.
    pub fn set_problem(&self, number: u64, there: Option<u64>) {
        self.problems().insert(number, there);
    }

    pub fn drop_problem(&self, number: u64) {
        self.problems().remove(&number);
    }

    /// Whether it serves a problem of rank 0, to which it has given nothing.
    fn serves(&self, problem: u64) -> Result<()> {
        if self.problems().values().all(|there| there.is_some_and(|there| there != problem)) {
            return Ok(());
        }
        let rank = self.ranks.rank;
        let what = format!("rank {rank} is in feti_serve, and has a part of a problem");
        Err(Error::new(Kind::State, what))
    }

    fn problems(&self) -> MutexGuard<'_, BTreeMap<u64, Option<u64>>> {
        self.problems.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// On ranks other than 0: answers rank 0, for all its problems, until rank 0 calls it too. `threads`: as option `threads`.
pub fn serve(rank: &Rank, threads: i64) -> Result<()> {
    if rank.ranks.rank == 0 {
        return rank.ranks.end();
    }
    let threads = threads::count(threads, usize::MAX);
    answer_all(&rank.ranks, &rank.bodies, &mut |incoming, bodies| match incoming.question {
        BEGIN => {
            rank.serves(u64::take(&mut &incoming.message[..])?)?;
            Ok(message(&None::<()>))
        }
        _ => answer(bodies, incoming, threads),
    })
}

/// Answers by this function until rank 0 ends it. A panic is an error of the request.
pub fn answer_all(
    ranks: &Ranks,
    bodies: &Bodies,
    answer: &mut dyn FnMut(&Incoming, &Bodies) -> Result<Vec<u8>>,
) -> Result<()> {
    loop {
        let incoming = ranks.next()?;
        bodies.forget(&incoming.dropped);
        if incoming.question == END {
            return ranks.reply(&incoming, Ok(Vec::new()));
        }
        let answered = catch_unwind(AssertUnwindSafe(|| answer(&incoming, bodies)));
        let panicked = |_| Err(Error::new(Kind::Internal, "a rank that serves has panicked"));
        ranks.reply(&incoming, answered.unwrap_or_else(panicked))?;
    }
}

/// The answer to a request, within the time that rank 0 has left.
pub fn answer(bodies: &Bodies, incoming: &Incoming, threads: usize) -> Result<Vec<u8>> {
    // memory that is short is short for one request
    let _running = RunningCall::begin();
    let (begun, limit) = (Instant::now(), incoming.seconds_left);
    let interrupt = match limit {
        f64::INFINITY => Interrupt::default(),
        limit => Interrupt::default().after(limit, Arc::new(move || begun.elapsed().as_secs_f64())),
    };
    match incoming.question {
        ABOUT_BODIES => interrupt.during(|| bodies.answer(&incoming.message, threads)),
        _ => Err(Error::new(Kind::Internal, "a question that a rank does not know")),
    }
}
