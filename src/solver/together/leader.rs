//! Rank 0 in a call that all ranks make.

use std::sync::Arc;

use crate::error::{Error, Kind, Result};
use crate::gathering::is_numbered;
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
    /// The other ranks that have a part of it.
    pub members: Vec<usize>,
}

impl Leading<'_> {
    /// Leads the call; the other ranks hear of its end whatever happens. None if no other rank has a part, and no order of numbers is asked
    /// for: the problem of rank 0 is that of all.
    pub fn lead(&mut self, number: u64, call: Call) -> Result<Option<Finish>> {
        let begun = self.begin(number, call)?;
        self.members = begun.iter().map(|(rank, _)| *rank).collect();
        if begun.is_empty() && !is_numbered(&self.own.model) {
            return Ok(None);
        }
        let ended = together(number, call, &begun).and_then(|()| self.led(call, begun));
        let failed = |error: Error| {
            let failure = Some(Failure(error));
            (0..=self.members.len()).map(|_| Finish { failure: failure.clone(), share: None }).collect()
        };
        let mut ends: Vec<Finish> = ended.unwrap_or_else(failed);
        let own = ends.remove(0);
        let mut ends = ends.into_iter();
        self.ask(FINISH, |_| ends.next().unwrap_or_default())?;
        Ok(Some(own))
    }

    /// Asks the ranks that have a part; each with its answer.
    pub(super) fn ask<T: Wire + 'static>(
        &self,
        question: u32,
        mut of: impl FnMut(usize) -> T,
    ) -> Result<Vec<(usize, Vec<u8>)>> {
        let request = |&rank: &usize| {
            let of = of(rank);
            Request { rank, question, put: Box::new(move |to| of.put(to)) }
        };
        let answers = self.ranks.ask(self.members.iter().map(request).collect())?.answers()?;
        let own = self.members.iter().zip(answers);
        own.map(|(rank, answer)| Ok((*rank, answer.map_err(|e| e.rank(*rank))?))).collect()
    }

    /// Which calls the other ranks are in; without those that serve.
    fn begin(&mut self, number: u64, call: Call) -> Result<Vec<(usize, Begun)>> {
        self.leader.serve.resize(self.ranks.size, false);
        self.members = (1..self.ranks.size).filter(|rank| !self.leader.serve[*rank]).collect();
        let known = |rank: usize| self.leader.told.as_ref().map(|told| told[rank].revisions);
        let answers = self.ask(BEGIN, |rank| Begin { problem: number, call, known: known(rank) })?;
        let mut begun = Vec::with_capacity(answers.len());
        for (rank, answer) in answers {
            match value::<Option<Begun>>(&answer)? {
                Some(of) => begun.push((rank, of)),
                None => self.leader.serve[rank] = true,
            }
        }
        Ok(begun)
    }

    /// What every rank gets.
    fn led(&mut self, call: Call, begun: Vec<(usize, Begun)>) -> Result<Vec<Finish>> {
        if let Some(lending) = &mut self.all.prepared.lending {
            lending.serve.clone_from(&self.leader.serve);
            lending.serve[0] = true;
        }
        self.gather(begun)?;
        let Self { leader, own, all, .. } = self;
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
        Ok(std::iter::once(0).chain(self.members.iter().copied()).map(finish).collect())
    }
}

/// Whether all ranks are in this call.
fn together(number: u64, call: Call, begun: &[(usize, Begun)]) -> Result<()> {
    let is_other = |(_, of): &&(usize, Begun)| (of.problem, of.call) != (number, call);
    let Some((rank, of)) = begun.iter().find(is_other) else { return Ok(()) };
    let another = if of.problem == number { "" } else { " for another problem" };
    let what = format!("rank {rank} is in {}{another}, rank 0 in {}", of.call.name(), call.name());
    Err(Error::new(Kind::State, what))
}
