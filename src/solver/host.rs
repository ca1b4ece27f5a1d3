//! Bodies whose stiffness the host keeps, K and K+ by its functions.

use std::sync::Arc;
use std::time::Instant;

use crate::body::{
    Body, GeneralizedInverse, HostFunctions, HostMultiple, HostOperator, Modes, NullSpaceInput, TOGETHER,
};
use crate::error::{Error, Kind, Result};
use crate::platform::memory::copied;
use crate::solver::phases::Phase;
use crate::solver::problem::{Inverse, Problem};
use crate::solver::watch::{Part, Watch};

/// Fraction of a setup that is done once the functions of the host have been tried.
const TRIED: f64 = 0.03;

impl Problem {
    /// `diagonal` is `K_ii`, n numbers >= 0, force / length; a matrix or functions given before are replaced.
    pub fn set_operator(&mut self, body: usize, diagonal: &[f64], functions: HostFunctions) -> Result<()> {
        self.check_length(body, "n", diagonal.len())?;
        if let Some(dof) = diagonal.iter().position(|d| !(d.is_finite() && *d >= 0.0)) {
            let what = "the diagonal entry of K is no finite number >= 0";
            return Err(Error::argument("diag", what).body(body).dof(dof).entry(dof).value(diagonal[dof]));
        }
        let operator = HostOperator::new(body, copied(diagonal, "the diagonal of a body")?, functions);
        let slot = self.changed(body, false)?;
        slot.body.operator = Some(Arc::new(operator));
        slot.body.stiffness = None;
        slot.form = None;
        slot.spoiled = false;
        (slot.symbolic, slot.keys) = (None, None);
        Ok(())
    }

    /// K+ of those bodies of the host that have none: their functions are tried.
    pub(super) fn try_hosts(&mut self, watch: &mut Watch) -> Result<()> {
        let slots = self.bodies.iter().enumerate();
        let pending = slots.filter(|(_, slot)| slot.inverse.is_none() && slot.body.operator.is_some());
        let pending: Vec<usize> = pending.map(|(p, _)| p).collect();
        if pending.is_empty() {
            return Ok(());
        }
        let begun = Instant::now();
        let part = Part {
            threads: self.threads(),
            weights: pending.iter().map(|&p| self.bodies[p].body.order as f64).collect(),
            until: TRIED,
            on_caller: self.on_caller(&pending),
        };
        let tolerance = self.settings.null_space_tolerance;
        let make =
            |k: usize| host_inverse(&self.bodies[pending[k]].body, tolerance).map_err(|e| e.body(pending[k]));
        let mut made: Vec<Option<GeneralizedInverse>> = pending.iter().map(|_| None).collect();
        let ended = watch.every_body(&part, make, |k, inverse| made[k] = Some(inverse));
        for (&p, made) in pending.iter().zip(made) {
            let bytes = 2 * TOGETHER * size_of::<f64>() * self.bodies[p].body.order;
            let unit = self.bodies[p].body.unit();
            let inverse = made.map(|made| {
                let (kplus, grounded) = (Arc::new(made), Arc::from([]));
                Inverse { unit, kplus, grounded, bytes, operator: None }
            });
            self.bodies[p].inverse = inverse;
        }
        self.phases.ended(Phase::NullSpaces, begun);
        ended
    }

    /// Which of these bodies are worked on by the thread alone that calls the library.
    pub(super) fn on_caller(&self, bodies: &[usize]) -> Vec<bool> {
        let on_caller = |p: &usize| self.bodies[*p].body.k().is_some_and(|k| k.on_caller());
        bodies.iter().map(on_caller).collect()
    }
}

/// A body that the host keeps lacks its null space.
pub(super) fn lacks_null_space(body: &Body) -> bool {
    body.operator.is_some() && body.null_space.is_none() && body.coordinates.is_none()
}

fn host_inverse(body: &Body, tolerance: f64) -> Result<GeneralizedInverse> {
    let missing = || Error::new(Kind::Internal, "a body without functions of the host was tried");
    let operator = Arc::clone(body.operator.as_ref().ok_or_else(missing)?);
    if body.fixing.is_some() {
        let what = "fixing dofs were given, and K+ of this body is the host's";
        return Err(Error::new(Kind::Unsupported, what));
    }
    let k = HostMultiple { operator, unit: body.unit() };
    if let Some(given) = &body.null_space {
        return GeneralizedInverse::of_host(k, given, tolerance);
    }
    let missing = || Error::new(Kind::State, "the null space has not been given");
    let coordinates = body.coordinates.as_ref().ok_or_else(missing)?;
    let vectors = coordinates.rigid_modes_of_one(|dof| k.operator.diagonal(dof) > 0.0)?;
    let candidates = NullSpaceInput { vectors, modes: Modes::Candidates };
    GeneralizedInverse::of_host(k, &candidates, tolerance)
}
