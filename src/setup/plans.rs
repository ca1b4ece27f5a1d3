//! How K+ of each body will be computed: null spaces and fixing dofs, found before any factorisation.

use std::sync::Arc;

use crate::body::{check_diagonal, Body, Digits, GeneralizedInverse, Modes, Pilots, Plan};
use crate::error::{Error, Kind, Result};
use crate::linalg::Multiple;
use crate::model::SolvedModel;
use crate::numbers::setup::NULL_SPACES;
use crate::progress::{SetupPart, Watch};
use crate::setup::prepared::PreparedBody;

/// Null spaces and fixing dofs of the pending bodies.
pub(super) fn plans(
    model: &SolvedModel,
    pending: &[usize],
    bodies: &[PreparedBody],
    watch: &mut Watch,
) -> Result<Vec<Plan>> {
    let tolerance = model.settings.null_space_tolerance;
    let part = SetupPart::of(model.threads(), weights(model, pending), NULL_SPACES);
    let find = |k: usize| {
        let (p, body) = (pending[k], &model.bodies[pending[k]].body);
        plan(body, bodies[p].pilots.as_deref().cloned(), tolerance, model.is_piece(p))
            .map_err(|e| of_coordinates(body, e).body(p))
    };
    let mut plans: Vec<Option<Plan>> = pending.iter().map(|_| None).collect();
    watch.every_body(&part, find, |k, plan| plans[k] = Some(plan))?;
    Ok(plans.into_iter().flatten().collect())
}

/// If a null space comes from coordinates, its error says so: the coordinates may be wrong.
pub(super) fn of_coordinates(body: &Body, mut error: Error) -> Error {
    let only = body.null_space.is_none() && body.coordinates.is_some();
    if only && error.kind == Kind::NullSpace && !error.what.contains("of these coordinates") {
        error.what =
            format!("the coordinates, from which the null space comes, may be wrong: {}", error.what);
    }
    let entries = body.stiffness.as_deref().filter(|_| error.kind == Kind::Indefinite);
    if let Some(digits) = entries.and_then(|k| Digits::of_rounded(k, Digits::TOLD)) {
        error.what = format!("{}; the entries of K have {digits}: rounding may have made it so", error.what);
    }
    error
}

/// Numbers of entries of K of these bodies.
pub(super) fn weights(model: &SolvedModel, bodies: &[usize]) -> Vec<f64> {
    let entries = |&p: &usize| model.bodies[p].body.stiffness.as_ref().map_or(1, |k| k.col.len());
    bodies.iter().map(|p| entries(p) as f64).collect()
}

/// Null space and fixing dofs of a body, found before any factorisation. Only now is it known whether its motions are soft.
fn plan(body: &Body, pilots: Option<Pilots>, tolerance: f64, is_piece: bool) -> Result<Plan> {
    let missing = || Error::new(Kind::Internal, "a body without stiffness was set up");
    let matrix = Arc::clone(body.stiffness.as_ref().ok_or_else(missing)?);
    if !body.has_soft_motions() {
        check_diagonal(&matrix)?;
    }
    let k = Multiple { matrix, by: 1.0 / body.unit() };
    match pilots {
        Some(pilots) if pilots.are_all() => Plan::of_pilots(k, pilots),
        pilots => own_plan(body, k, tolerance, is_piece)?.with_pilots(pilots),
    }
}

/// Without unknowns that rows carry.
fn own_plan(body: &Body, k: Multiple, tolerance: f64, is_piece: bool) -> Result<Plan> {
    let fixing = body.fixing.as_deref();
    if let Some(given) = &body.null_space {
        let planned = GeneralizedInverse::plan_with(k, given, tolerance, fixing)?;
        return Ok(if given.modes == Modes::Soft { planned } else { planned.or_search(tolerance, true) });
    }
    let Some(coordinates) = &body.coordinates else {
        return GeneralizedInverse::search(k, tolerance, fixing);
    };
    let rigid = coordinates.rigid_modes(|i| k.matrix.diagonal(i) > 0.0)?;
    let planned = match body.coordinate_modes {
        Modes::Soft => GeneralizedInverse::plan_soft(k, &rigid, fixing)?,
        modes => GeneralizedInverse::plan_near(k, &rigid, modes, tolerance, fixing)?,
    };
    if is_piece {
        return Ok(planned.or_search(tolerance, false).carrying(rigid));
    }
    Ok(planned)
}
