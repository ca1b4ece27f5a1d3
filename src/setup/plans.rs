//! How K+ of each body will be computed: null spaces and fixing dofs, found before any factorisation, here or where the body is.

use std::collections::HashMap;
use std::sync::Arc;

use crate::body::{Layout, Plan, PlanAway, Planned, Planning};
use crate::error::{Error, Kind, Result};
use crate::model::SolvedModel;
use crate::numbers::setup::NULL_SPACES;
use crate::platform::stopwatch;
use crate::progress::{SetupPart, Watch};
use crate::setup::prepared::Prepared;

/// The plan of a body on one of the ranks that need its K+.
pub(super) struct PlanOf {
    pub body: usize,
    pub rank: usize,
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
        of: &[(usize, usize)],
        watch: &mut Watch,
    ) -> Result<Vec<PlanOf>> {
        let with = |p: usize| Planning {
            carried: self.bodies[p].carried.as_deref().cloned(),
            tolerance: model.settings.null_space_tolerance,
            is_piece: model.is_piece(p),
        };
        let (mut questions, mut names) = (Vec::new(), HashMap::new());
        for (k, (p, rank)) in of.iter().enumerate().filter(|(_, (_, rank))| *rank > 0) {
            let lending = self.lending.as_ref().ok_or_else(without_ranks)?;
            let (asking, name) = lending.planning(*rank, &model.bodies[*p].body, with(*p));
            questions.push((k, asking));
            names.insert(k, name);
        }
        let owed = watch.stops.interrupt.during(|| self.ask(questions))?;
        let here: Vec<usize> = (0..of.len()).filter(|k| of[*k].1 == 0).collect();
        let bodies: Vec<usize> = here.iter().map(|k| of[*k].0).collect();
        let part = SetupPart::of(model.threads(), weights(model, &bodies), NULL_SPACES);
        let find =
            |k: usize| model.bodies[bodies[k]].body.plan(with(bodies[k])).map_err(|e| e.body(bodies[k]));
        let mut plans: Vec<Option<PlanAt>> = of.iter().map(|_| None).collect();
        let take = |k: usize, plan| plans[here[k]] = Some(PlanAt::Here(Box::new(plan)));
        let mut ended = stopwatch::aside(|| watch.every_body(&part, find, take));
        for (k, answer) in owed.answers::<Planned>()? {
            let name = names.remove(&k).ok_or_else(without_ranks)?;
            match answer {
                Ok(planned) => plans[k] = Some(PlanAt::Away(PlanAway::new(name, planned))),
                Err(error) => ended = first_of_bodies(ended, error.body(of[k].0)),
            }
        }
        ended?;
        let made = |(&(body, rank), at): (_, Option<PlanAt>)| Some(PlanOf { body, rank, at: at? });
        Ok(of.iter().zip(plans).filter_map(made).collect())
    }
}

/// Of two failures that of the first body.
pub(super) fn first_of_bodies(a: Result<()>, b: Error) -> Result<()> {
    let body = |error: &Error| error.place.body.unwrap_or(0);
    match a {
        Err(a) if body(&a) <= body(&b) => Err(a),
        _ => Err(b),
    }
}

pub(super) fn without_ranks() -> Error {
    Error::new(Kind::Internal, "a body was lent without a plan or a rank")
}

/// Numbers of entries of K of these bodies.
pub(super) fn weights(model: &SolvedModel, bodies: &[usize]) -> Vec<f64> {
    let entries = |&p: &usize| model.bodies[p].body.stiffness.as_ref().map_or(1, |k| k.col.len());
    bodies.iter().map(|p| entries(p) as f64).collect()
}
