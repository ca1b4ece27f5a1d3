//! Rank 0 in a call that all ranks make.

use std::sync::Arc;

use crate::error::{Error, Kind, Result};
use crate::ranks::{value, Ranks, Request, Wire};
use crate::solver::joined::Leader;
use crate::solver::problem::Problem;
use crate::solver::together::failure::Failure;
use crate::solver::together::messages::{Begin, Begun, Call, Finish, BEGIN, FINISH};
use crate::solver::together::split::Split;

/// A call of all ranks, led by rank 0.
pub(super) struct Leading<'a> {
    pub ranks: &'a Arc<Ranks>,
    pub leader: &'a mut Leader,
    /// The part of rank 0.
    pub own: &'a mut Problem,
    /// The problem of all ranks.
    pub all: &'a mut Problem,
}

impl Leading<'_> {
    /// Leads the call; the other ranks hear of its end whatever happens.
    pub fn lead(&mut self, number: u64, call: Call) -> Result<Finish> {
        let begun = self.begin(number, call)?;
        let ended = together(number, call, &begun).and_then(|()| self.led(call, begun));
        let failed = |error: Error| {
            let failure = Some(Failure(error));
            (0..self.ranks.size).map(|_| Finish { failure: failure.clone(), share: None }).collect()
        };
        let mut ends: Vec<Finish> = ended.unwrap_or_else(failed);
        let own = ends.remove(0);
        let requests = ends.into_iter().enumerate().map(|(k, end)| Request {
            rank: k + 1,
            question: FINISH,
            put: Box::new(move |to| end.put(to)),
        });
        self.ranks.ask(requests.collect())?.answers()?;
        Ok(own)
    }

    /// Which calls the other ranks are in.
    fn begin(&self, number: u64, call: Call) -> Result<Vec<Begun>> {
        let request = |rank: usize| {
            let known = self.leader.told.as_ref().map(|told| told[rank].revisions);
            let begin = Begin { problem: number, call, known };
            Request { rank, question: BEGIN, put: Box::new(move |to| begin.put(to)) }
        };
        let answers = self.ranks.ask((1..self.ranks.size).map(request).collect())?.answers()?;
        let begun = |answer: Result<Vec<u8>>| {
            let serves = || Error::new(Kind::Unsupported, "some ranks serve and others give bodies");
            value::<Option<Begun>>(&answer?)?.ok_or_else(serves)
        };
        answers.into_iter().map(begun).collect()
    }

    /// What every rank gets.
    fn led(&mut self, call: Call, begun: Vec<Begun>) -> Result<Vec<Finish>> {
        self.gather(begun)?;
        let Self { leader, own, all, ranks } = self;
        std::mem::swap(&mut all.host, &mut own.host);
        let ended = match call {
            Call::Setup => all.setup(),
            Call::Solve => all.solve().map(drop),
        };
        std::mem::swap(&mut all.host, &mut own.host);
        let answer = all.current().map(|current| &*current.answer).filter(|_| call == Call::Solve);
        let split = Split::new(&leader.order, &all.model, answer)?;
        let failure = ended.err().map(|error| Failure(split.error(error)));
        let finish = |rank: usize| Finish {
            failure: failure.clone(),
            share: all.findings.as_ref().map(|findings| split.share(rank, answer, findings)),
        };
        Ok((0..ranks.size).map(finish).collect())
    }
}

/// Whether all ranks are in this call.
fn together(number: u64, call: Call, begun: &[Begun]) -> Result<()> {
    let is_other = |(_, of): &(usize, &Begun)| (of.problem, of.call) != (number, call);
    let Some((k, of)) = begun.iter().enumerate().find(is_other) else { return Ok(()) };
    let another = if of.problem == number { "" } else { " for another problem" };
    let what = format!("rank {} is in {}{another}, rank 0 in {}", k + 1, of.call.name(), call.name());
    Err(Error::new(Kind::State, what))
}
