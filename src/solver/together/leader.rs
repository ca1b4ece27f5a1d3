//! Rank 0 in a call that all ranks make.

use std::collections::HashMap;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Arc;

use crate::error::{Error, Kind, Result};
use crate::gathering::{is_numbered, At, Order, Revised};
use crate::ranks::{value, Ranks, Request, Wire};
use crate::solver::check::Candidate;
use crate::solver::joined::Leader;
use crate::solver::made::BodyMade;
use crate::solver::problem::Problem;
use crate::solver::together::failure::Failure;
use crate::solver::together::messages::{Begin, Begun, Call, Called, Finish, Given, BEGIN, FINISH};
use crate::solver::together::split::Split;
use crate::solver::together::{for_one_rank, panicked, Brought};

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
    /// Leads the call; the other ranks hear of its end whatever happens. None if no other rank has a part: the problem of rank 0 is that
    /// of all.
    pub fn lead(&mut self, problem: u64, called: Called, brought: Brought) -> Result<Option<Finish>> {
        if self.ranks.is_closed() && self.leader.told.is_none() {
            return Ok(None);
        }
        let (begun, refusal) = self.begin(problem, called)?;
        self.members = begun.iter().map(|(rank, _)| *rank).collect();
        if begun.is_empty() && refusal.is_none() && !self.puts_in_order(called.call) {
            return Ok(None);
        }
        let leads = self.pair(problem, &begun).then_some(problem);
        let ended = match refusal.or_else(|| Some(brought.refused.clone()?.rank(0))) {
            None => together(leads, called, &begun).and_then(|()| {
                // the others hear of a panic, too
                catch_unwind(AssertUnwindSafe(|| self.led(called, begun, brought)))
                    .unwrap_or_else(|_| Err(panicked(0)))
            }),
            Some(error) => Err(error),
        };
        let failed = |error: Error| {
            let failure = Some(Failure(error));
            (0..=self.members.len())
                .map(|_| Finish { failure: failure.clone(), ..Finish::default() })
                .collect()
        };
        let mut ends: Vec<Finish> = ended.unwrap_or_else(failed);
        let own = ends.remove(0);
        let mut ends = ends.into_iter();
        self.ask(FINISH, |_| Finish { leads, ..ends.next().unwrap_or_default() })?;
        Ok(Some(own))
    }

    /// One rank alone, which other ranks might have shared the problem with, solves it in the order that it has on several. If a body is
    /// cut, which it is not on several ranks, the order remains that of the host.
    fn puts_in_order(&mut self, call: Call) -> bool {
        let model = &self.own.model;
        let is_cut = model.bodies.iter().any(|given| given.body.assembled().is_some());
        let orders = self.ranks.size == 1 && call != Call::Read && is_numbered(model) && !is_cut;
        self.leader.told.take_if(|_| !orders);
        orders
    }

    /// Asks the ranks that have a part; each with its answer.
    pub(super) fn ask<T: Wire + 'static>(
        &self,
        question: u32,
        of: impl FnMut(usize) -> T,
    ) -> Result<Vec<(usize, Vec<u8>)>> {
        let answers = self.asked(question, of)?.into_iter();
        answers.map(|(rank, answer)| Ok((rank, answer.map_err(|e| e.rank(rank))?))).collect()
    }

    /// Asks one rank.
    pub(super) fn ask_one<A: Wire, T: Wire + 'static>(&self, rank: usize, question: u32, of: T) -> Result<A> {
        let missing = || Error::new(Kind::Internal, "a rank did not answer");
        let request = Request { rank, question, put: Box::new(move |to| of.put(to)) };
        let answer = self.ranks.ask(vec![request])?.answers()?.pop().ok_or_else(missing)?;
        value(&answer.map_err(|e| e.rank(rank))?)
    }

    fn asked<T: Wire + 'static>(
        &self,
        question: u32,
        mut of: impl FnMut(usize) -> T,
    ) -> Result<Vec<(usize, Result<Vec<u8>>)>> {
        if self.members.is_empty() {
            return Ok(Vec::new());
        }
        let request = |&rank: &usize| {
            let of = of(rank);
            Request { rank, question, put: Box::new(move |to| of.put(to)) }
        };
        let answers = self.ranks.ask(self.members.iter().map(request).collect())?.answers()?;
        Ok(self.members.iter().copied().zip(answers).collect())
    }

    /// Which calls the other ranks are in, without those that serve; and why one cannot take part.
    fn begin(&mut self, problem: u64, called: Called) -> Result<(Vec<(usize, Begun)>, Option<Error>)> {
        self.leader.serve.resize(self.ranks.size, false);
        self.members = (1..self.ranks.size).filter(|rank| !self.leader.serve[*rank]).collect();
        let known = |rank: usize| self.leader.told.as_ref().map(|told| told[rank].revisions);
        let answers = self.asked(BEGIN, |rank| Begin { problem, called, known: known(rank) })?;
        let (mut begun, mut refusal) = (Vec::with_capacity(answers.len()), None);
        for (rank, answer) in answers {
            match answer.and_then(|answer| value::<Option<Begun>>(&answer)) {
                Ok(Some(of)) => begun.push((rank, of)),
                Ok(None) => self.leader.serve[rank] = true,
                Err(error) => drop(refusal.get_or_insert(error.rank(rank))),
            }
        }
        Ok((begun, refusal))
    }

    /// Whether all ranks are in a call for the same problem: once met, they remain together.
    fn pair(&mut self, problem: u64, begun: &[(usize, Begun)]) -> bool {
        self.leader.paired.resize(self.ranks.size, false);
        let fits = |(rank, of): &(usize, Begun)| of.leads == self.leader.paired[*rank].then_some(problem);
        let new: Vec<_> = begun.iter().filter(|(_, of)| of.leads.is_none()).collect();
        let numbers: Vec<_> = new.iter().map(|(rank, of)| (*rank, of.problem)).collect();
        let fits = begun.iter().all(fits) && self.ranks.pair(problem, &numbers);
        new.iter().filter(|_| fits).for_each(|(rank, _)| self.leader.paired[*rank] = true);
        fits
    }

    /// What every rank gets, rank 0 first.
    fn led(&mut self, called: Called, begun: Vec<(usize, Begun)>, brought: Brought) -> Result<Vec<Finish>> {
        if let Some(lending) = &mut self.all.prepared.lending {
            lending.serve = self.leader.serve.clone().into();
            lending.serve[0] = true;
        }
        match called.call {
            Call::Setup | Call::Solve => self.solved(called.call, begun),
            Call::Check => self.checked(begun, brought.answer),
            Call::OpenMotion | Call::Dependent if !self.is_as_told(&begun) => {
                let what = "what has been asked belongs to the last answer, and the problem has changed: solve first";
                Err(Error::new(Kind::State, what))
            }
            Call::OpenMotion => self.open_motion(called.number as usize),
            Call::Dependent => self.dependent(),
            Call::Write => self.written(begun, brought.path),
            Call::Read => Err(for_one_rank()),
            Call::SaveState => {
                self.save(called.number as usize);
                Ok(self.each(|_| Finish::default()))
            }
            Call::RestoreState => {
                let fits = self.fit(&begun, called.number as usize)?;
                let fits = self.restore(called.number as usize, fits);
                Ok(self.each(|_| Finish { fits, ..Finish::default() }))
            }
        }
    }

    /// Rank 0, then the others that have a part.
    pub(super) fn each(&self, end: impl FnMut(usize) -> Finish) -> Vec<Finish> {
        std::iter::once(0).chain(self.members.iter().copied()).map(end).collect()
    }

    fn solved(&mut self, call: Call, begun: Vec<(usize, Begun)>) -> Result<Vec<Finish>> {
        self.gather(begun)?;
        self.all.method = self.own.method;
        std::mem::swap(&mut self.all.host, &mut self.own.host);
        let ended = match call {
            Call::Setup => self.all.setup(),
            _ => self.all.solve().map(drop),
        };
        std::mem::swap(&mut self.all.host, &mut self.own.host);
        let all = &self.all;
        let answer = all.current().map(|current| &*current.answer).filter(|_| call == Call::Solve);
        let split = Split::new(&self.leader.order, &all.model, self.ranks.size, answer)?;
        let failure = ended.err().map(|error| Failure(split.error(error)));
        Ok(self.each(|rank| Finish {
            failure: failure.clone(),
            made: self.made(&split, rank),
            share: all.findings.as_ref().map(|findings| split.share(rank, answer, findings)),
            ..Finish::default()
        }))
    }

    /// What has been made of the bodies of another rank.
    fn made(&self, split: &Split, rank: usize) -> Option<Vec<BodyMade>> {
        self.all.prepared.duals(&self.all.model)?;
        (rank > 0).then(|| split.own_bodies_of(rank).iter().map(|body| self.all.told_of(*body)).collect())
    }

    fn checked(&mut self, mut begun: Vec<(usize, Begun)>, given: Option<Given>) -> Result<Vec<Finish>> {
        let lost = || Error::new(Kind::Internal, "a rank has given no answer to check");
        let mut answers = vec![(0, given.ok_or_else(lost)?)];
        for (rank, of) in &mut begun {
            answers.push((*rank, of.answer.take().ok_or_else(lost)?));
        }
        self.gather(begun)?;
        let all = merged(&self.leader.order, &answers);
        let [lambda, mu, tangential] = [0, 1, 2].map(|kind| &all.forces[kind][..]);
        let candidate = Candidate { u: &all.u, lambda, mu, tangential };
        std::mem::swap(&mut self.all.host, &mut self.own.host);
        let checked = self.all.check_alone_with(candidate, |_, _| Ok(all.left.clone()));
        std::mem::swap(&mut self.all.host, &mut self.own.host);
        let split = Split::new(&self.leader.order, &self.all.model, self.ranks.size, None)?;
        let certificate = Some(split.certificate(&checked.map_err(|error| split.error(error))?));
        Ok(self.each(|rank| Finish { certificate, made: self.made(&split, rank), ..Finish::default() }))
    }

    fn open_motion(&mut self, k: usize) -> Result<Vec<Finish>> {
        let open = self.all.open_motion(k)?;
        let split = Split::new(&self.leader.order, &self.all.model, self.ranks.size, None)?;
        let motion = |rank: usize| Some((split.own(rank, &open.v), split.own_body(rank, open.body?)));
        Ok(self.each(|rank| Finish { motion: motion(rank), ..Finish::default() }))
    }

    fn dependent(&mut self) -> Result<Vec<Finish>> {
        let rows = self.all.dependent_equalities()?;
        let split = Split::new(&self.leader.order, &self.all.model, self.ranks.size, None)?;
        Ok(self.each(|rank| Finish { rows: split.own_rows(rank, &rows), ..Finish::default() }))
    }

    /// Whether the answers that all ranks have saved are those of their data, with the present matrices.
    fn fit(&self, begun: &[(usize, Begun)], number: usize) -> Result<bool> {
        let own = self.own.restorable(number).map_err(|e| e.rank(0))?;
        Ok(own && self.is_as_told(begun) && begun.iter().all(|(_, of)| of.fits))
    }

    /// Bodies and rows of all ranks are those of the last setup.
    fn is_as_told(&self, begun: &[(usize, Begun)]) -> bool {
        let told = self.leader.told.as_ref();
        let same = told.is_some_and(|told| told[0].revisions == Revised::of(&self.own.model));
        same && begun.iter().all(|(_, of)| of.told.is_none())
    }
}

/// Whether all ranks are in this call, with data that none of them refuses.
fn together(leads: Option<u64>, called: Called, begun: &[(usize, Begun)]) -> Result<()> {
    let refused = begun.iter().find_map(|(rank, of)| Some((*rank, of.refused.clone()?)));
    if let Some((rank, failure)) = refused.filter(|_| leads.is_some()) {
        return Err(failure.0.rank(rank));
    }
    let is_other = |(_, of): &&(usize, Begun)| leads.is_none() || of.called != called;
    let Some((rank, of)) = begun.iter().find(is_other) else { return Ok(()) };
    let name = |called: Called| match called.number {
        0 => called.call.name().to_owned(),
        number => format!("{} with number {number}", called.call.name()),
    };
    let another = if leads.is_some() { "" } else { " for another problem" };
    let what = format!("rank {rank} is in {}{another}, rank 0 in {}", name(of.called), name(called));
    Err(Error::new(Kind::State, what))
}

/// An answer on the bodies and rows of all ranks.
fn merged(order: &Order, answers: &[(usize, Given)]) -> Given {
    let of: HashMap<usize, &Given> = answers.iter().map(|(rank, of)| (*rank, of)).collect();
    let starts = order.starts();
    let values = |pick: fn(&Given) -> &[f64]| {
        let mut all = Vec::new();
        for (body, at) in order.bodies.iter().enumerate() {
            let (start, n) = (starts[body], order.offsets[body + 1] - order.offsets[body]);
            let own = of.get(&at.rank).and_then(|of| pick(of).get(start..start + n));
            all.extend_from_slice(own.unwrap_or(&vec![0.0; n]));
        }
        all
    };
    let forces = |kind: usize| {
        let own = |at: &At| of.get(&at.rank).and_then(|of| of.forces[kind].get(at.number)).copied();
        order.rows[kind].iter().map(|at| own(at).unwrap_or(0.0)).collect()
    };
    Given { u: values(|of| &of.u), left: values(|of| &of.left), forces: (0..3).map(forces).collect() }
}
