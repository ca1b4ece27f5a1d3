//! Rank 0 in a call that all ranks make.

use std::collections::HashMap;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Arc;

use crate::error::{Error, Kind, Result};
use crate::gathering::{is_numbered, At, Revised};
use crate::ranks::{value, Ranks, Request, Token, Wire};
use crate::solve::Stays;
use crate::solver::call::Call;
use crate::solver::check::{left_over, Candidate};
use crate::solver::joined::{BodyMade, Leader};
use crate::solver::joints::ends;
use crate::solver::problem::Problem;
use crate::solver::together::failure::Failure;
use crate::solver::together::messages::{
    Begin, Begun, Called, Candidates, Finish, BEGIN, BLOCK, CANDIDATES, FINISH,
};
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
        let is_left_alone = self.ranks.is_closed() && !self.leader.paired.contains(&true);
        let (begun, refusal) = if is_left_alone { (Vec::new(), None) } else { self.begin(problem, called)? };
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
        let sizes = self.leader.told.as_ref().map(|_| self.all.model.sizes());
        ends.iter_mut().for_each(|end| end.sizes = sizes);
        let own = ends.remove(0);
        let mut ends = ends.into_iter();
        self.ask(FINISH, |_| Finish { leads, ..ends.next().unwrap_or_default() })?;
        self.all.stays = Stays::default();
        Ok(Some(own))
    }

    /// A problem of rank 0 alone, which other ranks might have shared, is solved in the order that it has on several. If a body is cut, which
    /// it is not on several ranks, the order remains that of the host.
    fn puts_in_order(&mut self, call: Call) -> bool {
        let model = &self.own.model;
        let is_cut = model.bodies.iter().any(|given| given.body.assembled().is_some());
        let orders = call != Call::Read && is_numbered(model) && !is_cut;
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
        let with = answer.map(|answer| (answer, &all.stays));
        let split = Split::new(&self.leader.order, &all.model, self.ranks.size, with)?;
        let named = all.stays.names.iter().map(|(part, name)| (*part, name.number)).collect();
        let names = |rank: usize| split.names(rank, all.parts(), &named);
        let failure = ended.err().map(|error| Failure(split.error(error)));
        Ok(self.each(|rank| Finish {
            failure: failure.clone(),
            made: self.made(&split, rank),
            share: all.findings.as_ref().map(|findings| split.share(rank, answer, names(rank), findings)),
            ..Finish::default()
        }))
    }

    /// What has been made of the bodies of another rank.
    fn made(&self, split: &Split, rank: usize) -> Option<Vec<BodyMade>> {
        self.all.prepared.duals(&self.all.model)?;
        (rank > 0).then(|| split.own_bodies_of(rank).iter().map(|body| self.all.told_of(*body)).collect())
    }

    fn checked(&mut self, mut begun: Vec<(usize, Begun)>, answer: Option<Candidate>) -> Result<Vec<Finish>> {
        let lost = || Error::new(Kind::Internal, "a rank has given no answer to check");
        let own = answer.ok_or_else(lost)?;
        let mut forces = vec![Vec::new(); self.ranks.size];
        forces[0] = [own.lambda, own.mu, own.tangential].map(<[f64]>::to_vec).into();
        for (rank, of) in &mut begun {
            forces[*rank] = of.forces.take().ok_or_else(lost)?;
        }
        self.gather(begun)?;
        let order = Arc::clone(&self.leader.order);
        let [lambda, mu, tangential] = [0, 1, 2].map(|kind| {
            let own = |at: &At| forces[at.rank][kind].get(at.number).copied().unwrap_or(0.0);
            order.rows[kind].iter().map(own).collect::<Vec<f64>>()
        });
        let here = order.bodies.iter().filter(|at| at.rank == 0);
        let u: Vec<f64> = here.flat_map(|at| &own.u[self.own.model.range(at.number)]).copied().collect();
        let (names, left) = self.left_over(own.u)?;
        let candidate = Candidate { u: &u, lambda: &lambda, mu: &mu, tangential: &tangential };
        let there = |part: usize| names.get(&part).cloned();
        std::mem::swap(&mut self.all.host, &mut self.own.host);
        let checked = self.all.check_alone_with(candidate, &there, |_, _, unknowns| {
            let value = |j: &usize| left.get(j).copied().ok_or_else(lost);
            unknowns.iter().map(value).collect()
        });
        std::mem::swap(&mut self.all.host, &mut self.own.host);
        let split = Split::new(&self.leader.order, &self.all.model, self.ranks.size, None)?;
        let certificate = Some(split.certificate(&checked.map_err(|error| split.error(error))?));
        Ok(self.each(|rank| Finish { certificate, made: self.made(&split, rank), ..Finish::default() }))
    }

    /// Of an answer to be checked what its displacements on other ranks are called, by parts, and `f - K u` of unknowns with joints; `own`:
    /// displacements on rank 0.
    fn left_over(&mut self, own: &[f64]) -> Result<(HashMap<usize, Arc<Token>>, HashMap<usize, f64>)> {
        self.all.decompose()?;
        let (order, model) = (&self.leader.order, &self.all.model);
        let mut of_rank: Vec<Vec<(usize, (usize, usize))>> = vec![Vec::new(); self.ranks.size];
        for j in ends(&model.joints()?) {
            let body = model.offsets[1..].partition_point(|end| *end <= j);
            let At { rank, number } = order.bodies[body];
            of_rank[rank].push((j, (number, j - model.offsets[body])));
        }
        let mut left = HashMap::new();
        if !of_rank[0].is_empty() {
            let all = left_over(&self.own.model, own)?;
            let offsets = &self.own.model.offsets;
            left.extend(of_rank[0].iter().map(|(j, (body, dof))| (*j, all[offsets[*body] + dof])));
        }
        let firsts: Vec<u64> = (0..self.ranks.size).map(|_| self.ranks.block(BLOCK)).collect();
        let left_at = |rank: usize| of_rank[rank].iter().map(|(_, at)| *at).collect();
        let asked = |rank: usize| Candidates { first: firsts[rank], left_at: left_at(rank) };
        for (rank, answer) in self.ask(CANDIDATES, asked)? {
            let values: Vec<f64> = value(&answer)?;
            left.extend(of_rank[rank].iter().map(|(j, _)| *j).zip(values));
        }
        let (mut names, mut next) = (HashMap::new(), firsts);
        for (At { rank, .. }, body) in order.by_ranks().into_iter().filter(|(at, _)| at.rank > 0) {
            for part in self.all.parts_of(body) {
                names.insert(part, Arc::new(self.ranks.named(rank, next[rank])));
                next[rank] += 1;
            }
        }
        Ok((names, left))
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
