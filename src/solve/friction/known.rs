//! The linear problem for the states in which a solve with friction has ended: used for measurements, not part of a solve.

use crate::error::Result;
use crate::model::Settings;
use crate::qp::friction::{known_face, FrictionLimits, FrictionProblem};
use crate::qp::{Observer, Qp, Restricted, StepReport};
use crate::setup::Ready;
use crate::solve::friction::laws::{cones, OfBodies};
use crate::solve::gaps::Gaps;

/// Products with F of conjugate gradients in which closed and sticking nodes, slip directions and slips of the last answer are known:
/// cold, with the preconditioner, rows and tolerance of that solve. None where no solve has left an answer since.
pub fn on_known_states(ready: &Ready, settings: &Settings, qp: Qp, gaps: &Gaps) -> Result<Option<usize>> {
    let Some(answer) = ready.pairs.as_ref().and_then(|pairs| pairs.take_answer()) else { return Ok(None) };
    let near = Restricted::new(qp, &answer.rows);
    let cones = cones(ready, gaps, &answer.rows)?;
    let preconditioner =
        ready.preconditioner.as_ref().map(|made| OfBodies { of: &made.1, rows: &answer.rows });
    let preconditioner = preconditioner.as_ref().map(|of| of as _);
    let problem = FrictionProblem { qp: near.qp(), cones: &cones, preconditioner };
    let products = usize::try_from(settings.max_steps).unwrap_or(usize::MAX);
    let limits = FrictionLimits { tolerance: settings.tolerance, products, direct: None };
    known_face(problem, limits, (&answer.x, &answer.alpha), &mut Silent).map(Some)
}

/// Does not report products and never stops them.
struct Silent;

impl Observer for Silent {
    fn step(&mut self, _: &StepReport) -> Result<()> {
        Ok(())
    }
}
