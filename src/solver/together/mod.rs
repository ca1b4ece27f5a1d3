//! Calls that all ranks make for a problem to which each has given bodies and rows: rank 0 gathers them and solves one problem, the other
//! ranks answer until it has an end, and each gets what belongs to its own.

mod failure;
mod file;
mod follower;
mod gather;
mod leader;
mod messages;
mod share;
mod split;
mod states;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use crate::body::Lending;
use crate::certificate::Certificate;
use crate::error::{Error, Kind, Result};
use crate::model::{HostModel, Sizes};
use crate::ranks::Ranks;
use crate::serving::Rank;
use crate::solve::Report;
use crate::solver::call::Call;
use crate::solver::check::Candidate;
use crate::solver::findings::rigid_motion;
use crate::solver::joined::{Follower, Joined, Leader, Role};
use crate::solver::problem::Problem;
use crate::solver::undetermined::OpenMotion;
use leader::Leading;
use messages::{Called, Finish};

impl Problem {
    /// This rank gives its part of the problem: bodies and rows, which rows of other ranks may name by numbers. On every rank that gives
    /// some, before the first body and surface, in the same order for several problems.
    pub fn join(&mut self, rank: Arc<Rank>) -> Result<()> {
        if !self.model.bodies.is_empty() || !self.model.pairs.surfaces.is_empty() {
            let what = "the ranks must be given before the first body and the first surface";
            return Err(Error::new(Kind::State, what));
        }
        let ranks = &rank.ranks;
        let problem = ranks.block(1);
        let role = match ranks.rank {
            0 => Role::Leads(Box::<Leader>::default()),
            _ => Role::Follows(Box::new(Follower::new(Arc::clone(&rank)))),
        };
        let lending = || {
            let may_lend = ranks.size > 1 && ranks.rank == 0;
            may_lend.then(|| Lending::new(Arc::clone(ranks), cfg!(feature = "loopback")))
        };
        (self.prepared.lending, self.model.has_others) = (lending(), true);
        // whether other ranks have bodies is not known on rank 0 yet
        self.model.stays_whole = ranks.rank > 0;
        self.all = (ranks.rank == 0).then(|| {
            let mut all = Box::<Self>::default();
            all.prepared.lending = lending();
            all
        });
        rank.set_problem(problem, None);
        self.joined = Some(Box::new(Joined { rank, problem, role, answered: None, sizes: None }));
        Ok(())
    }

    /// The answer of this rank belongs to its present model.
    pub(super) fn is_answered_together(&self) -> bool {
        let answered = self.joined.as_ref().and_then(|joined| joined.answered);
        answered == Some(self.model.revisions)
    }

    /// Numbers of bodies, unknowns and rows of all ranks after a call of all; before it, and without others, those of this rank.
    #[doc(hidden)]
    pub fn sizes_of_all(&self) -> Sizes {
        self.joined.as_ref().and_then(|joined| joined.sizes).unwrap_or_else(|| self.sizes())
    }

    /// The problem is solved in the order of several ranks.
    pub(super) fn is_of_several(&self) -> bool {
        self.joined.as_ref().is_some_and(|joined| match &joined.role {
            Role::Leads(leader) => leader.told.is_some() || leader.paired.contains(&true),
            Role::Follows(_) => true,
        })
    }

    /// What this rank solves: on rank 0 the problem of all ranks, if several have a part of it.
    pub(super) fn of_all(&self) -> &Self {
        self.all.as_deref().filter(|_| self.is_of_several()).unwrap_or(self)
    }

    /// Other ranks have a part of the problem: what is asked is not known on one of them.
    pub(super) fn check_alone(&self) -> Result<()> {
        match self.is_of_several() && !self.is_only_rank() {
            true => Err(for_one_rank()),
            false => Ok(()),
        }
    }

    /// No other rank has a part of the problem.
    pub(super) fn is_only_rank(&self) -> bool {
        self.joined.as_ref().is_none_or(|joined| match &joined.role {
            Role::Leads(leader) => !leader.paired.contains(&true),
            Role::Follows(_) => false,
        })
    }

    /// Checks what the host gives in a call that all ranks make: if it is refused, the others hear of it.
    #[doc(hidden)]
    pub fn checked_together<T>(
        &mut self,
        call: Call,
        check: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<T> {
        check(self).map_err(|error| {
            let refused = Some(error.clone());
            let number = self.joined.as_ref().map(|joined| joined.rank.ranks.rank);
            match self.together(call, 0, Brought { refused, ..Brought::default() }) {
                // of several ranks that refuse something all hear of one
                Err(told) if told.place.rank.is_some_and(|by| Some(by) != number) => told,
                Err(_) => error.rank(number.unwrap_or(0)),
                Ok(_) => error,
            }
        })
    }

    /// As `setup`, by all ranks; false if rank 0 is alone with its problem. So in what follows.
    pub(super) fn set_up_together(&mut self) -> Result<bool> {
        Ok(self.together(Call::Setup, 0, Brought::default())?.is_some())
    }

    pub(super) fn solve_together(&mut self) -> Result<Option<Report>> {
        let missing = || Error::new(Kind::Internal, "a solve of all ranks left nothing");
        let report = |problem: &Self| problem.report().cloned().ok_or_else(missing);
        self.together(Call::Solve, 0, Brought::default())?.map(|_| report(self)).transpose()
    }

    pub(super) fn check_together(&mut self, answer: Candidate) -> Result<Option<Certificate>> {
        if self.joined.is_none() {
            return Ok(None);
        }
        let answer = Some(answer);
        let end = self.together(Call::Check, 0, Brought { answer, ..Brought::default() })?;
        Ok(end.and_then(|end| end.certificate))
    }

    pub(super) fn open_motion_together(&mut self, k: usize) -> Result<Option<OpenMotion>> {
        let Some(end) = self.together(Call::OpenMotion, k as u64, Brought::default())? else {
            return Ok(None);
        };
        let missing = || Error::new(Kind::Internal, "a motion of all ranks left nothing");
        let (v, body) = end.motion.ok_or_else(missing)?;
        let motion = body.and_then(|body| rigid_motion(&self.model, body, &v));
        Ok(Some(OpenMotion { v, body, motion }))
    }

    pub(super) fn dependent_together(&mut self) -> Result<Option<Vec<usize>>> {
        Ok(self.together(Call::Dependent, 0, Brought::default())?.map(|end| end.rows))
    }

    fn together(&mut self, call: Call, number: u64, brought: Brought) -> Result<Option<Finish>> {
        let Some(mut joined) = self.joined.take() else { return Ok(None) };
        let called = Called { call, number };
        joined.sizes = None;
        let ended = self.with_all(&mut joined, called, brought);
        let taken = ended.and_then(|end| end.map(|end| self.take_end(end, called, &mut joined)).transpose());
        if call == Call::Solve && matches!(taken, Ok(None)) {
            joined.answered = None;
        }
        self.joined = Some(joined);
        taken
    }

    fn with_all(&mut self, joined: &mut Joined, called: Called, brought: Brought) -> Result<Option<Finish>> {
        let Joined { rank, problem, role, .. } = joined;
        let (ranks, problem) = (&rank.ranks, *problem);
        let flag = self.host.canceller();
        flag.store(false, Ordering::Relaxed);
        let _cancelled_by = CancelledBy::new(ranks, flag);
        match role {
            Role::Leads(leader) => {
                let missing = || Error::new(Kind::Internal, "rank 0 has no problem of all ranks");
                let mut all = self.all.take().ok_or_else(missing)?;
                let mut leading = Leading { ranks, leader, own: self, all: &mut all, members: Vec::new() };
                let ended = leading.lead(problem, called, brought);
                self.all = Some(all);
                ended
            }
            Role::Follows(follower) => follower.follow(self, ranks, problem, (called, brought)).map(Some),
        }
    }

    /// Takes what belongs to this rank.
    fn take_end(&mut self, mut end: Finish, called: Called, joined: &mut Joined) -> Result<Finish> {
        joined.sizes = end.sizes;
        // a call that ends before the solve leaves the last answer
        if let Some(share) = end.share.take() {
            if called.call == Call::Solve {
                (self.history.current, joined.answered) = (None, None);
            }
            let mut findings = share.findings;
            findings.motion = findings.own_motion(&self.model, joined.rank.ranks.rank);
            self.findings = Some(findings);
            if let Some(mut answer) = share.answer {
                if let Role::Follows(follower) = &joined.role {
                    answer.u = follower.displacements(&share.names)?;
                }
                self.history().keep(answer, 0);
                joined.answered = Some(self.model.revisions);
            }
        }
        if let (Some(made), Role::Follows(follower)) = (end.made.take(), &mut joined.role) {
            let revisions = self.model.bodies.iter().map(|given| given.revisions);
            follower.made = revisions.zip(made).collect();
        }
        match end.failure.take() {
            Some(failure) => Err(failure.0),
            None => Ok(end),
        }
    }
}

/// What the host gives in a call.
#[derive(Default)]
struct Brought<'a> {
    /// Why this rank refuses what it was given.
    refused: Option<Error>,
    /// An answer to be checked.
    answer: Option<Candidate<'a>>,
    /// The file to be written, on rank 0.
    path: Option<&'a Path>,
}

/// The flag by which the host cancels the call on this rank, until it ends.
struct CancelledBy<'a>(&'a Ranks);

impl<'a> CancelledBy<'a> {
    fn new(ranks: &'a Ranks, flag: Arc<AtomicBool>) -> Self {
        ranks.cancel_by(Some(flag));
        Self(ranks)
    }
}

impl Drop for CancelledBy<'_> {
    fn drop(&mut self) {
        self.0.cancel_by(None);
    }
}

fn panicked(rank: usize) -> Error {
    Error::new(Kind::Internal, "the library has panicked").rank(rank)
}

fn for_one_rank() -> Error {
    let what = "this call is not available for a problem to which several ranks have given bodies";
    Error::new(Kind::Unsupported, what)
}

/// Refuses a part of the problem that lacks data, or that rank 0 cannot ask about. Bodies that have been cut are whole from now on.
fn ready_part(model: &mut HostModel, rank: usize) -> Result<()> {
    if model.bodies.is_empty() {
        return Ok(());
    }
    model.check_complete()?;
    if let Some(p) = model.bodies.iter().position(|given| rank > 0 && given.body.operator().is_some()) {
        let what = "a body given by functions on another rank than 0 cannot be solved together with bodies of other ranks";
        return Err(Error::new(Kind::Unsupported, what).body(p));
    }
    model.make_whole()
}
