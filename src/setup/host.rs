//! Bodies whose stiffness matrix stays with the host, which applies K and K+ by its functions.

use std::sync::Arc;
use std::time::Instant;

use crate::body::{Body, GeneralizedInverse, HostMultiple, Modes, NullSpaceInput, TOGETHER};
use crate::error::{Error, Kind, Result};
use crate::model::SolvedModel;
use crate::numbers::setup::TRIED;
use crate::progress::{Phase, SetupPart, Watch};
use crate::setup::prepared::{Inverse, Prepared};

impl Prepared {
    /// Makes K+ of the host's bodies that have none, and checks their functions.
    pub(super) fn try_hosts(&mut self, model: &SolvedModel, watch: &mut Watch) -> Result<()> {
        let pending =
            |&p: &usize| self.bodies[p].inverse.is_none() && model.bodies[p].body.operator().is_some();
        let pending: Vec<usize> = (0..self.bodies.len()).filter(pending).collect();
        if pending.is_empty() {
            return Ok(());
        }
        let begun = Instant::now();
        let part = SetupPart {
            threads: model.threads(),
            weights: pending.iter().map(|&p| model.bodies[p].body.order as f64).collect(),
            until: TRIED,
            on_caller: model.on_caller(&pending),
        };
        let tolerance = model.settings.null_space_tolerance;
        let make = |k: usize| {
            let body = &model.bodies[pending[k]].body;
            host_inverse(body, tolerance).map_err(|e| body.explained(e).body(pending[k]))
        };
        let mut made: Vec<Option<GeneralizedInverse>> = pending.iter().map(|_| None).collect();
        let ended = watch.every_body(&part, make, |k, inverse| made[k] = Some(inverse));
        for (&p, made) in pending.iter().zip(made) {
            let bytes = 2 * TOGETHER * size_of::<f64>() * model.bodies[p].body.order;
            let unit = model.bodies[p].body.unit();
            let inverse = made.map(|made| {
                let (kplus, grounded) = (Arc::new(made), Some(Arc::from([])));
                Arc::new(Inverse { unit, kplus, grounded, bytes })
            });
            self.bodies[p].inverse = inverse;
        }
        watch.phases.ended(Phase::NullSpaces, begun);
        ended
    }
}

fn host_inverse(body: &Body, tolerance: f64) -> Result<GeneralizedInverse> {
    let missing = || Error::new(Kind::Internal, "a body without functions of the host was checked");
    let operator = Arc::clone(body.operator().ok_or_else(missing)?);
    if body.fixing.is_some() {
        let what = "fixing dofs were given, but the host provides K+ of this body";
        return Err(Error::new(Kind::Unsupported, what));
    }
    let k = HostMultiple { operator, unit: body.unit() };
    if body.has_soft_motions() {
        let what = "soft motions were given, but the host provides K+ of this body";
        return Err(Error::new(Kind::Unsupported, what));
    }
    if let Some(given) = &body.null_space {
        return GeneralizedInverse::of_host(k, given, tolerance);
    }
    let missing = || Error::new(Kind::State, "the null space has not been given");
    let coordinates = body.coordinates.as_ref().ok_or_else(missing)?;
    let vectors = coordinates.rigid_modes(|dof| k.operator.diagonal(dof) > 0.0)?;
    let candidates = NullSpaceInput { vectors, modes: Modes::Candidates };
    let made = GeneralizedInverse::of_host(k, &candidates, tolerance)?;
    match made.misfit.filter(|_| body.coordinate_modes == Modes::Exact) {
        Some(misfit) => Err(Error::new(Kind::NullSpace, misfit.to_string()).value(misfit.next)),
        None => Ok(made),
    }
}
