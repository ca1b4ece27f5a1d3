//! What a rank other than 0 does: it keeps what rank 0 has sent, and answers.

#[cfg(feature = "loopback")]
pub mod loopback;
mod questions;

pub use questions::taken;

use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Arc;
use std::time::Instant;

use crate::body::{Bodies, ABOUT_BODIES};
use crate::error::{Error, Kind, Result};
use crate::platform::interrupt::Interrupt;
use crate::platform::shortage::RunningCall;
use crate::platform::threads;
use crate::ranks::{message, Incoming, Ranks, END};

/// The first request of a call that all ranks make.
pub const BEGIN: u32 = 2;

/// A rank other than 0 on a stream, and what it keeps for rank 0.
#[derive(Clone)]
pub struct Rank {
    pub ranks: Arc<Ranks>,
    pub bodies: Arc<Bodies>,
}

impl Rank {
    pub fn new(ranks: Arc<Ranks>) -> Self {
        Self { ranks, bodies: Arc::new(Bodies::new(taken)) }
    }
}

/// On ranks other than 0: answers rank 0, for all its problems, until rank 0 calls it too. `threads`: as option `threads`.
pub fn serve(ranks: &Arc<Ranks>, threads: i64) -> Result<()> {
    if ranks.rank == 0 {
        return ranks.end();
    }
    let (threads, bodies) = (threads::count(threads, usize::MAX), Bodies::new(taken));
    answer_all(ranks, &bodies, &mut |incoming, bodies| answer(bodies, incoming, threads))
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
        // this rank serves
        BEGIN => Ok(message(&None::<()>)),
        _ => Err(Error::new(Kind::Internal, "a question that a rank does not know")),
    }
}
