//! What the last setup has made of a body of the host: K+ of its parts, on whichever rank it was decided.

use std::sync::Arc;

use crate::body::GeneralizedInverse;
use crate::model::BodyRevisions;
use crate::setup::{Duals, Inverse};
use crate::solver::joined::{BodyMade, Follower, Role};
use crate::solver::problem::Problem;

/// A part of a body, and its K+.
pub struct MadePart<'a> {
    /// Its unknowns within the body, ascending; none: all.
    dofs: Option<&'a [u32]>,
    pub inverse: Arc<Inverse>,
}

impl MadePart<'_> {
    /// Unknown i of the part within the body.
    pub fn place(&self, i: usize) -> usize {
        self.dofs.map_or(i, |dofs| dofs[i] as usize)
    }

    pub fn kplus(&self) -> &GeneralizedInverse {
        &self.inverse.kplus
    }

    /// Of its factor.
    pub fn bytes(&self) -> usize {
        self.kplus().bytes().unwrap_or(self.inverse.bytes)
    }
}

impl Problem {
    /// The parts of a body with their K+, as far as made for its present data.
    pub(super) fn made(&self, body: usize) -> Vec<MadePart<'_>> {
        let now = self.model.bodies[body].revisions;
        match (&self.joined.as_deref().map(|joined| &joined.role), self.in_all(body)) {
            (_, Some((all, number))) => all.made_of(number, now),
            (Some(Role::Follows(follower)), _) => follower.made_of(body, now),
            _ => self.made_of(body, now),
        }
    }

    /// The problem of all ranks that rank 0 has solved, and the number of one of its own bodies in it.
    pub(super) fn in_all(&self, body: usize) -> Option<(&Self, usize)> {
        let Role::Leads(leader) = &self.joined.as_deref()?.role else { return None };
        leader.told.as_ref()?;
        Some((self.all.as_deref()?, *leader.own.get(body)?))
    }

    fn made_of(&self, body: usize, now: BodyRevisions) -> Vec<MadePart<'_>> {
        let solved = self.solved();
        let range = self.parts_of(body);
        if solved.bodies.get(range.start).map(|given| given.revisions) != Some(now) {
            return Vec::new();
        }
        let dofs = |part: usize| self.parts()?.listed(part);
        let made = |part: usize| {
            let inverse = self.prepared.inverse(solved, part)?;
            Some(MadePart { dofs: dofs(part), inverse: Arc::clone(inverse) })
        };
        range.filter_map(made).collect()
    }

    /// Bytes of the assembled dual operator of a body, none if it is not assembled; none without a setup.
    pub(super) fn operator_of(&self, body: usize) -> Option<Option<usize>> {
        if let Some((all, number)) = self.in_all(body) {
            return all.operator_of(number);
        }
        if let Some(Role::Follows(follower)) = self.joined.as_deref().map(|joined| &joined.role) {
            let (of, made) = follower.made.get(body)?;
            return (*of == self.model.bodies[body].revisions).then_some(made.operator);
        }
        let Duals { operators, .. } = self.prepared.duals(&self.model)?;
        let mut parts = self.parts_of(body);
        let explicit = parts.clone().all(|part| !operators.implicit[part]);
        Some(explicit.then(|| parts.by_ref().map(|part| operators.sizes[part].bytes(false)).sum()))
    }

    /// What a body on another rank has to know of what was made of it here.
    pub(super) fn told_of(&self, body: usize) -> BodyMade {
        let kplus = |part: MadePart| {
            let name = part.kplus().elsewhere()?.number();
            Some((name, part.inverse.unit))
        };
        let made = self.made_of(body, self.model.bodies[body].revisions).into_iter();
        BodyMade { kplus: made.filter_map(kplus).collect(), operator: self.operator_of(body).flatten() }
    }
}

impl Follower {
    fn made_of(&self, body: usize, now: BodyRevisions) -> Vec<MadePart<'_>> {
        let (Some((of, made)), Some(known)) = (self.made.get(body), &self.parts) else { return Vec::new() };
        let Some(parts) = known.model.parts.as_deref().filter(|_| *of == now) else { return Vec::new() };
        let part = |(part, (name, unit)): (usize, &(u64, f64))| {
            let dofs = parts.listed(part);
            let inverse = Inverse {
                unit: *unit,
                kplus: self.rank.bodies.kplus_named(*name)?,
                grounded: None,
                bytes: 0,
            };
            Some(MadePart { dofs, inverse: Arc::new(inverse) })
        };
        parts.of(body).zip(&made.kplus).filter_map(part).collect()
    }
}
