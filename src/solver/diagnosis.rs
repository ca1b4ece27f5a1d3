//! Why there is no answer: a load that nothing holds, rows that contradict each other.

use crate::constraints::RowKind;
use crate::error::{Error, Kind, Proof};
use crate::linalg::graph::components;
use crate::linalg::vector::{dot, norm, norm_max, weighted_norm};
use crate::solver::presolve::Gaps;
use crate::solver::problem::Problem;
use crate::solver::setup::Ready;

/// A combination of rows is empty when this little of it is left.
const EMPTY: f64 = 1e-8;

/// `direction` = e - G l of the nearest contact forces l: the rigid motion `v = R direction` opens every
/// contact it touches and the load does work on it.
pub(super) fn load_not_held(problem: &Problem, ready: &Ready, direction: &[f64], margin: f64) -> Error {
    let island = &ready.island;
    let share = |k: usize| norm(&direction[ready.dual.modes_of(k)]);
    let bodies = island.bodies.len();
    let worst = (0..bodies).fold(0, |best, k| if share(k) > share(best) { k } else { best });
    let own = ready.dual.rigid_motion(direction, island.unknowns());
    let mut v = vec![0.0; problem.counts().dofs];
    island.scatter(problem, &own, &mut v);
    let body = island.bodies[worst];
    let range = problem.range(body);
    let fastest =
        range.clone().fold(range.start, |best, i| if v[i].abs() > v[best].abs() { i } else { best });
    let sense = if v[fastest] > 0.0 { "positive" } else { "negative" };
    let what = format!(
        "the load moves the body and no contact force can hold it ({:.1} % of the resultant is left); \
         the motion is fastest at this dof, in the {sense} sense",
        100.0 * margin
    );
    let largest = norm_max(&v);
    let v = v.iter().map(|v| v / largest).collect();
    let dof = fastest - range.start;
    let error = Error::new(Kind::LoadNotHeld, what).body(body).dof(dof).value(margin).limit(0.0);
    let parts = problem.bodies[body].body.stiffness.as_deref().map(components);
    let error = match parts {
        Some((part_of, 2..)) => error.component(part_of[dof]),
        _ => error,
    };
    error.proved_by(Proof::Motion { margin, v })
}

/// The weights w combine the scaled rows of the host to nothing, `B'w = 0`, yet demand a negative gap, `c'w < 0`: no
/// displacement satisfies them. `None` when w does not prove it. Compliant rows contradict nothing.
pub(super) fn gaps_contradict(problem: &Problem, ready: &Ready, gaps: &Gaps, w: &[f64]) -> Option<Error> {
    let rows = &ready.rows;
    let leader = |group: usize| rows.grouping.leaders[group];
    let bounded = |group: usize| leader(group) < rows.contact;
    let negligible = EMPTY * norm_max(w);
    let counts = |group: usize| rows.compliance[group] == 0.0 && w[group].abs() > negligible;
    let w: Vec<f64> = (0..w.len()).map(|group| if counts(group) { w[group] } else { 0.0 }).collect();
    let (mut left, mut terms) = (vec![0.0; rows.scaled.cols], vec![0.0; rows.scaled.cols]);
    rows.scaled.mul_transposed_add(1.0, &w, &mut left);
    rows.scaled.mul_transposed_abs_add(&w, &mut terms);
    let size = |x: &[f64]| weighted_norm(x, |i| 1.0 / rows.metric[i]);
    let demanded = dot(&gaps.value, &w);
    let demands: f64 = gaps.value.iter().zip(&w).map(|(c, w)| (c * w).abs()).sum();
    let proves = (0..w.len()).all(|group| !bounded(group) || w[group] >= 0.0)
        && size(&left) <= EMPTY * size(&terms)
        && demanded < -EMPTY * demands;
    if !proves {
        return None;
    }
    let heaviest = (0..w.len()).fold(0, |best, i| if w[i].abs() > w[best].abs() { i } else { best });
    let others = w.iter().filter(|v| **v != 0.0).count() - 1;
    let (kind, row) = ready.island.kind_and_row(gaps.holder[heaviest]);
    let what = format!(
        "this {} and {others} others contradict each other: no displacement satisfies them",
        kind.name()
    );
    let error = Error::new(Kind::GapsContradict, what).row(row).value(demanded).limit(0.0);
    let involved = (0..w.len()).filter(|&group| w[group] != 0.0);
    let place = |group: usize| in_stack(problem, ready, gaps.holder[group]);
    let weights = involved.map(|group| (place(group), w[group] * rows.scale[gaps.holder[group]]));
    Some(error.proved_by(proof_of_rows(-demanded / demands, weights.collect(), place(heaviest))))
}

/// The error of a row without entries, which contradicts itself; `first` is the place of its kind in the stack.
pub(super) fn empty_row_contradicts(error: Error, first: usize) -> Error {
    let (Some(row), Some(gap)) = (error.place.row, error.place.value) else { return error };
    error.proved_by(proof_of_rows(1.0, vec![(first + row, -gap)], first + row))
}

/// Weights in the scaling of the host, the largest 1, in the order of the rows.
pub(super) fn proof_of_rows(margin: f64, mut weights: Vec<(usize, f64)>, heaviest: usize) -> Proof {
    let largest = weights.iter().fold(0.0, |largest: f64, (_, w)| largest.max(w.abs()));
    weights.iter_mut().for_each(|(_, w)| *w /= largest);
    weights.sort_by_key(|(row, _)| *row);
    Proof::Rows { margin, weights, heaviest }
}

/// Number in the stack of all contact rows and all equality rows of row i in that of an island.
pub(super) fn in_stack(problem: &Problem, ready: &Ready, i: usize) -> usize {
    match ready.island.kind_and_row(i) {
        (RowKind::Inequality, row) => row,
        (RowKind::Equality, row) => problem.contact.len() + row,
    }
}

/// Kind of a row of the stack, and its number among those.
pub(super) fn kind_and_row(i: usize, contact: usize) -> (RowKind, usize) {
    if i < contact {
        (RowKind::Inequality, i)
    } else {
        (RowKind::Equality, i - contact)
    }
}
