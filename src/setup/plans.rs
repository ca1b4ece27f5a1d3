//! How K+ of each body will be computed: null spaces and fixing dofs, found before any factorisation, here or where the body is.

use std::sync::Arc;

use crate::body::{Layout, Plan, PlanAway, Planned, Planning};
use crate::error::{Error, Kind, Result};
use crate::model::SolvedModel;
use crate::numbers::setup::NULL_SPACES;
use crate::progress::Watch;
use crate::setup::prepared::Prepared;

/// A K+ that will be made for all bodies equal to `body` on a rank, from the data of one of these.
pub(super) struct Maker {
    pub body: usize,
    pub rank: usize,
    pub by: usize,
}

/// Its plan.
pub(super) struct PlanOf {
    pub body: usize,
    pub rank: usize,
    pub by: usize,
    pub at: PlanAt,
}

pub(super) enum PlanAt {
    Here(Box<Plan>),
    Away(PlanAway),
}

impl PlanOf {
    pub fn layout(&self) -> Arc<Layout> {
        match &self.at {
            PlanAt::Here(plan) => plan.layout(),
            PlanAt::Away(plan) => Arc::clone(&plan.of.layout),
        }
    }

    /// The null space is known.
    pub fn is_known(&self) -> bool {
        match &self.at {
            PlanAt::Here(plan) => plan.is_known(),
            PlanAt::Away(plan) => plan.of.is_known,
        }
    }

    pub fn here(&self) -> Result<&Plan> {
        match &self.at {
            PlanAt::Here(plan) => Ok(plan),
            PlanAt::Away(_) => Err(Error::new(Kind::Internal, "a plan is looked for on the wrong rank")),
        }
    }

    pub fn away(&self) -> Option<&PlanAway> {
        match &self.at {
            PlanAt::Here(_) => None,
            PlanAt::Away(plan) => Some(plan),
        }
    }
}

impl Prepared {
    /// The plans of bodies on ranks.
    pub(super) fn plans(
        &self,
        model: &SolvedModel,
        makers: Vec<Maker>,
        watch: &mut Watch,
    ) -> Result<Vec<PlanOf>> {
        let with = |of: &Maker| Planning {
            carried: self.bodies[of.by].carried.as_deref().cloned(),
            tolerance: model.settings.null_space_tolerance,
            is_piece: model.is_piece(of.by),
        };
        let asking = |k: usize| {
            let of: &Maker = &makers[k];
            self.bodies[of.by].there.as_ref().map(|there| there.of.planning(with(of)))
        };
        let here = |k: usize| {
            let of = &makers[k];
            Ok(PlanAt::Here(Box::new(model.bodies[of.by].body.plan(with(of))?)))
        };
        let there = |name, of: Planned| PlanAt::Away(PlanAway::new(name, of));
        let bodies: Vec<usize> = makers.iter().map(|of| of.body).collect();
        let plans = self.wherever((model, &bodies), asking, here, there, (watch, NULL_SPACES))?;
        let all = makers.into_iter().zip(plans);
        Ok(all.map(|(Maker { body, rank, by }, at)| PlanOf { body, rank, by, at }).collect())
    }
}
