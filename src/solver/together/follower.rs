//! A rank other than 0 in a call that all ranks make.

use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Arc;

use crate::body::Facts;
use crate::decomposition::Decomposition;
use crate::error::{Error, Kind, Result};
use crate::gathering::{copies, Revised, Told, Values, SECTION};
use crate::model::file::write::lengths;
use crate::model::HostModel;
use crate::platform::memory::zeros;
use crate::platform::threads;
use crate::ranks::{message, value, Incoming, Ranks, Wire, END};
use crate::serving::answer;
use crate::solver::call::Call;
use crate::solver::check::{left_over, Candidate};
use crate::solver::joined::Follower;
use crate::solver::problem::Problem;
use crate::solver::together::failure::Failure;
use crate::solver::together::file::section_of;
use crate::solver::together::messages::{
    Begin, Begun, Called, Candidates, Finish, PartTold, PartsTold, Touch, Touched, BEGIN, CANDIDATES, FINISH,
    LENGTHS, LOADS, NUMBERS, SECTION_OF_FILE, TOUCH,
};
use crate::solver::together::{panicked, ready_part, Brought};

impl Follower {
    /// Answers until the call ends.
    pub(super) fn follow(
        &mut self,
        problem: &mut Problem,
        ranks: &Arc<Ranks>,
        number: u64,
        (called, mut brought): (Called, Brought),
    ) -> Result<Finish> {
        let threads = threads::count(problem.model.settings.threads, usize::MAX);
        loop {
            let incoming = ranks.next()?;
            self.rank.bodies.forget(&incoming.dropped);
            match incoming.question {
                FINISH => {
                    self.numbers = None;
                    ranks.reply(&incoming, Ok(Vec::new()))?;
                    let end: Finish = value(&incoming.message)?;
                    if end.leads.is_some() {
                        self.leads = end.leads;
                        self.rank.set_problem(number, end.leads);
                    }
                    return Ok(end);
                }
                END => {
                    ranks.reply(&incoming, Ok(Vec::new()))?;
                    let what =
                        format!("rank 0 has called feti_serve, this rank is in {}", called.call.name());
                    return Err(Error::new(Kind::State, what));
                }
                question => {
                    let mine = (ranks.rank, number, self.leads);
                    let answered = catch_unwind(AssertUnwindSafe(|| match question {
                        BEGIN => begun(problem, &incoming, mine, (called, &mut brought)),
                        NUMBERS => self.section(&problem.model),
                        TOUCH => {
                            value(&incoming.message).and_then(|of| sent(self.touched(&problem.model, of)))
                        }
                        LOADS => {
                            value(&incoming.message).and_then(|first| sent(self.loads(&problem.model, first)))
                        }
                        CANDIDATES => value(&incoming.message)
                            .and_then(|of| sent(self.candidates(&problem.model, brought.answer, of))),
                        LENGTHS => Ok(message(&lengths(&problem.model))),
                        SECTION_OF_FILE => {
                            value(&incoming.message).and_then(|of| sent(section_of(&problem.model, of)))
                        }
                        _ => answer(&self.rank.bodies, &incoming, threads),
                    }));
                    let answered = answered.unwrap_or_else(|_| Err(panicked(ranks.rank)));
                    ranks.reply(&incoming, answered)?;
                }
            }
        }
    }

    /// The next numbers of this rank, ascending.
    fn section(&mut self, model: &HostModel) -> Result<Vec<u8>> {
        let all = || {
            let mut all: Vec<usize> = model.unknowns.keys().copied().collect();
            all.sort_unstable();
            (all, 0)
        };
        let (numbers, done) = self.numbers.get_or_insert_with(all);
        let end = (*done + SECTION).min(numbers.len());
        let section = message(&numbers[*done..end].to_vec());
        *done = end;
        Ok(section)
    }

    /// Makes the parts, and keeps them for rank 0.
    fn touched(&mut self, model: &HostModel, Touch { numbers, first }: Touch) -> Result<Touched> {
        let copies = copies(model, numbers)?;
        self.connected.follow(model)?;
        let places = copies.1.iter().flatten().map(|(body, dof)| model.offsets[*body] + dof);
        let parts = Decomposition::of_part(model, &self.connected, places)?;
        let known = parts.model.parts.clone().ok_or_else(missing)?;
        let mut bodies = Vec::with_capacity(model.bodies.len());
        for body in 0..model.bodies.len() {
            let mut told = Vec::new();
            for part in known.of(body) {
                let own = &parts.model.bodies[part].body;
                let name = first + part as u64;
                told.push(PartTold {
                    order: own.order,
                    dofs: known.listed(part).map(Arc::from),
                    facts: Facts::of(own).ok_or_else(missing)?,
                });
                self.rank.bodies.keep_body(name, own.without_load());
            }
            let range = model.range(body);
            let loose = known.loose.iter().filter(|j| range.contains(j)).map(|j| (j - range.start) as u32);
            bodies.push(PartsTold { parts: told, loose: loose.collect() });
        }
        self.parts = Some(parts);
        Ok(Touched { copies, bodies })
    }

    /// Keeps the displacements of an answer to be checked; `f - K u` where it is asked for.
    fn candidates(
        &self,
        model: &HostModel,
        answer: Option<Candidate>,
        Candidates { first, left_at }: Candidates,
    ) -> Result<Vec<f64>> {
        let (Some(parts), Some(answer)) = (&self.parts, answer) else { return Ok(Vec::new()) };
        let parts = parts.model.parts.as_deref().ok_or_else(missing)?;
        for (part, of) in parts.parts.iter().enumerate() {
            let own = parts.gather(part, &answer.u[parts.offsets[of.body]..]).collect();
            self.rank.bodies.keep_vector(first + part as u64, own);
        }
        if left_at.is_empty() {
            return Ok(Vec::new());
        }
        let left = left_over(model, answer.u)?;
        let value = |(body, dof): &(usize, usize)| {
            let at = model.offsets.get(*body).and_then(|first| left.get(first + dof));
            at.copied().ok_or_else(missing)
        };
        left_at.iter().map(value).collect()
    }

    /// Displacements over all unknowns of this rank, of parts whose vectors have these names.
    pub(super) fn displacements(&self, names: &[Option<u64>]) -> Result<Vec<f64>> {
        let parts = self.parts.as_ref().and_then(|of| of.model.parts.as_deref()).ok_or_else(missing)?;
        let mut all = zeros(parts.offsets.last().copied().unwrap_or(0), "displacements")?;
        for (part, name) in names.iter().enumerate() {
            let own = &mut all[parts.offsets[parts.parts[part].body]..];
            let places = parts.dofs_of(part);
            match name {
                Some(name) => {
                    places.zip(self.rank.bodies.taken_vector(*name)?).for_each(|(i, v)| own[i] += v)
                }
                None => places.for_each(|i| own[i] = f64::NAN),
            }
        }
        Ok(all)
    }

    /// Keeps the loads of the parts for rank 0; the largest entry of each.
    fn loads(&mut self, model: &HostModel, first: u64) -> Result<Vec<Option<f64>>> {
        let Some(parts) = &mut self.parts else { return Ok(Vec::new()) };
        parts.refresh_loads(model)?;
        let mut largest = Vec::with_capacity(parts.model.bodies.len());
        for (part, given) in parts.model.bodies.iter().enumerate() {
            self.rank.bodies.keep_load(first + part as u64, given.body.load.as_deref().map(Arc::from));
            largest.push(given.body.largest_load());
        }
        Ok(largest)
    }
}

/// What this rank does, and what rank 0 does not know of its part.
fn begun(
    problem: &mut Problem,
    incoming: &Incoming,
    (rank, number, leads): (usize, u64, Option<u64>),
    (called, brought): (Called, &mut Brought<'_>),
) -> Result<Vec<u8>> {
    let Begin { known, .. } = value(&incoming.message)?;
    let mut begun = Begun {
        problem: number,
        leads,
        called,
        refused: None,
        told: None,
        values: None,
        forces: brought.answer.map(|of| [of.lambda, of.mu, of.tangential].map(<[f64]>::to_vec).into()),
        fits: false,
    };
    let ready = match called.call {
        _ if brought.refused.is_some() => brought.refused.take().map_or(Ok(()), Err),
        Call::RestoreState => problem.restorable(called.number as usize).map(|fits| begun.fits = fits),
        Call::Setup | Call::Solve | Call::Check => ready_part(&mut problem.model, rank),
        Call::Write => ready_part(&mut problem.model, rank).and_then(|()| problem.model.check_kept()),
        Call::SaveState | Call::OpenMotion | Call::Dependent | Call::Read => Ok(()),
    };
    let is_new = known != Some(Revised::of(&problem.model));
    let told = ready.and_then(|()| is_new.then(|| Told::of(&problem.model)).transpose());
    match told {
        Ok(told) => begun.told = told,
        Err(error) => begun.refused = Some(Failure(error)),
    }
    if matches!(called.call, Call::Setup | Call::Solve | Call::Check | Call::Write) {
        let start = problem.history().given_start();
        begun.values = Some(Values::of(&problem.model, start, problem.history.commits));
    }
    Ok(message(&Some(begun)))
}

fn sent<T: Wire>(answer: Result<T>) -> Result<Vec<u8>> {
    answer.map(|answer| message(&answer))
}

fn missing() -> Error {
    Error::new(Kind::Internal, "a part of a body is missing")
}
