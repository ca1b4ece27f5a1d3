//! Calls that all ranks make for a problem to which each has given bodies and rows: rank 0 gathers them and solves one problem, the other
//! ranks answer until it has an end, and each gets what belongs to its own.

mod failure;
mod follower;
mod gather;
mod leader;
mod messages;
mod share;
mod split;

use std::sync::Arc;

use crate::body::Lending;
use crate::error::{Error, Kind, Result};
use crate::model::HostModel;
use crate::ranks::Ranks;
use crate::serving::Rank;
use crate::solve::Report;
use crate::solver::joined::{Follower, Joined, Leader, Role};
use crate::solver::problem::Problem;
use leader::Leading;
use messages::{Call, Finish};

impl Problem {
    /// This rank gives its part of the problem: bodies and rows, which rows of other ranks may name by numbers. On every rank, before the
    /// first body; rank 0 has no `rank`.
    pub fn join(&mut self, ranks: Arc<Ranks>, rank: Option<Rank>) -> Result<()> {
        if !self.model.bodies.is_empty() {
            return Err(Error::new(Kind::State, "the ranks must be given before the first body"));
        }
        let problem = ranks.next_problem();
        let role = match rank {
            None => Role::Leads(Box::<Leader>::default()),
            Some(rank) => Role::Follows(Box::new(Follower::new(rank))),
        };
        let lending = || {
            let may_lend = ranks.size > 1 && ranks.rank == 0;
            may_lend.then(|| Lending::new(Arc::clone(&ranks), cfg!(feature = "loopback")))
        };
        (self.prepared.lending, self.model.has_others) = (lending(), true);
        self.all = (ranks.rank == 0).then(|| {
            let mut all = Box::<Self>::default();
            all.prepared.lending = lending();
            all
        });
        self.joined = Some(Box::new(Joined { ranks, problem, role, answered: None }));
        Ok(())
    }

    /// The answer of this rank belongs to its present model.
    pub(super) fn is_answered_together(&self) -> bool {
        let answered = self.joined.as_ref().and_then(|joined| joined.answered);
        answered == Some(self.model.revisions)
    }

    /// `feti_setup` on all ranks; none if rank 0 is alone with its problem.
    pub(super) fn set_up_together(&mut self) -> Result<Option<()>> {
        Ok(self.all_together(Call::Setup)?.map(drop))
    }

    /// `feti_solve` on all ranks; none if rank 0 is alone with its problem.
    pub(super) fn solve_together(&mut self) -> Result<Option<Report>> {
        let missing = || Error::new(Kind::Internal, "a solve of all ranks left nothing");
        self.all_together(Call::Solve)?.map(|report| report.ok_or_else(missing)).transpose()
    }

    fn all_together(&mut self, call: Call) -> Result<Option<Option<Report>>> {
        if self.joined.is_none() {
            return Ok(None);
        }
        let missing = || Error::new(Kind::Internal, "a problem of one rank was solved on several");
        let mut joined = self.joined.take().ok_or_else(missing)?;
        let Joined { ranks, problem, role, .. } = &mut *joined;
        let ended = match role {
            Role::Leads(leader) => {
                let mut all = self.all.take().ok_or_else(missing)?;
                let mut leading = Leading { ranks, leader, own: self, all: &mut all, members: Vec::new() };
                let ended = leading.lead(*problem, call);
                self.all = Some(all);
                ended
            }
            Role::Follows(follower) => follower.follow(self, ranks, *problem, call).map(Some),
        };
        let taken = ended.and_then(|end| end.map(|end| self.take_end(end, call)).transpose());
        match &taken {
            Ok(Some(Some(_))) => joined.answered = Some(self.model.revisions),
            Ok(None) => joined.answered = None,
            _ => {}
        }
        self.joined = Some(joined);
        taken
    }

    /// Takes what belongs to this rank.
    fn take_end(&mut self, Finish { failure, share }: Finish, call: Call) -> Result<Option<Report>> {
        if call == Call::Solve {
            self.history.current = None;
        }
        let mut report = None;
        if let Some(share) = share {
            let mut findings = share.findings;
            findings.motion = findings.own_motion(&self.model);
            self.findings = Some(findings);
            if let Some((told, own)) = share.answer {
                report = Some(told.clone());
                self.history().keep(own.into_answer(told)?, 0);
            }
        }
        match failure {
            Some(failure) => Err(failure.0),
            None => Ok(report),
        }
    }
}

/// Refuses a part of the problem that lacks data, or that other ranks cannot solve with.
fn check_part(model: &HostModel) -> Result<()> {
    if model.bodies.is_empty() {
        return Ok(());
    }
    model.check_complete()?;
    for (p, given) in model.bodies.iter().enumerate() {
        let what = match (given.body.operator(), given.body.assembled()) {
            (Some(_), _) => "a body given by functions",
            (_, Some(_)) => "a body that is cut into pieces (option pieces = 1 leaves it whole)",
            (None, None) => continue,
        };
        let what = format!("{what} cannot be solved together with bodies of other ranks yet");
        return Err(Error::new(Kind::Unsupported, what).body(p));
    }
    Ok(())
}
