//! The dual of an island with friction is solved by the Newton method of `qp::friction`.

mod corrector;
mod known;
mod laws;
mod slides;

use crate::error::Result;
use crate::progress::Steps;
use crate::qp::friction::{
    friction, Cones, DualAnswer, FrictionLimits, FrictionProblem, FrictionSolution, FrictionStart, State,
};
use crate::qp::{AcceptanceTest, AnswerFace, Qp, Restricted, Solution, Verdict};
use crate::solve::case::Case;
use crate::solve::fallback::{Found, MethodOptions};
use crate::solve::friction::laws::OfBodies;
use crate::solve::friction::slides::named;
use crate::solve::gaps::Gaps;

pub use known::on_known_states;
pub use laws::cones;

/// The method on a subset of the rows. It reuses the pairs of earlier solves if the start is not 0.
pub fn solve_with_friction(
    case: Case,
    means: &MethodOptions,
    (qp, gaps): (&Qp, &Gaps),
    (near, rows): (&Restricted, &[usize]),
    start: &[f64],
    judged: &mut dyn AcceptanceTest,
    steps: &mut Steps,
) -> Result<Found> {
    let ready = case.ready;
    let cones: Cones = cones(ready, gaps, rows)?;
    let preconditioner = ready.preconditioner.as_ref().map(|made| OfBodies { of: &made.1, rows });
    let preconditioner = preconditioner.as_ref().map(|of| of as _);
    let problem = FrictionProblem { qp: near.qp(), cones: &cones, preconditioner };
    let most = usize::try_from(means.settings.max_steps).unwrap_or(usize::MAX);
    let limits = FrictionLimits {
        tolerance: means.settings.tolerance,
        products: most,
        direct: (means.direct.limit > 0).then_some(means.direct),
    };
    let start = near.start(start);
    let pairs = ready.pairs.as_deref();
    let kept = pairs.and_then(|pairs| pairs.take(rows));
    let is_warm = start.iter().any(|x| *x != 0.0);
    let start = FrictionStart {
        x: is_warm.then_some(&start[..]),
        alpha: None,
        pairs: kept.filter(|_| is_warm).unwrap_or_default(),
    };
    let mut found = friction(problem, limits, start, judged, steps)?;
    let counts = found.counts;
    if let (Verdict::Stalled, Some(slide)) = (&found.verdict, &found.slide) {
        return Err(named(case, slide, found.counts.starts)?);
    }
    if let Some(pairs) = pairs {
        pairs.keep(rows, std::mem::take(&mut found.pairs), ready.dual.product_work());
        let (x, alpha) = (found.x.clone(), found.alpha.clone());
        pairs.keep_answer(DualAnswer { rows: rows.to_vec(), x, alpha });
    }
    let x = near.spread(&found.x);
    // rows without force, and tangential rows of nodes that no friction holds
    let mut held = vec![true; x.len()];
    rows.iter().for_each(|&row| held[row] = qp.bounded[row] && x[row] <= 0.0);
    let without = cones.nodes().iter().filter(|node| node.limit(node.of(&found.x).normal) <= 0.0);
    without.flat_map(|node| node.tangents()).for_each(|&row| held[rows[row]] = true);
    let undetermined = match found.verdict {
        Verdict::Solved => AnswerFace::of(qp, &held)?.undetermined()?.cols,
        _ => 0,
    };
    let slips = cones.nodes().iter().zip(&found.states).filter(|(_, state)| **state == State::Slip);
    slips.flat_map(|(node, _)| node.tangents()).for_each(|&row| held[rows[row]] = true);
    let FrictionSolution { alpha, scale, verdict, .. } = found;
    Ok(Found { solution: Solution { x, alpha, undetermined, scale, verdict, counts }, held })
}
