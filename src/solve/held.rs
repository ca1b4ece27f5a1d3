//! Which rows carry a force that holds a motion, and which rows carry only rounding.

use std::ops::Range;

use crate::certificate::Candidate;
use crate::constraints::RowKind;
use crate::linalg::vector::weighted_norm;
use crate::linalg::Operator;
use crate::setup::Ready;

/// A force below this part of all forces on each of the bodies that its row touches is rounding, and holds no motion; ...
const ROUNDING: f64 = 1e-12;
/// ... on bodies without load, whose forces may be nothing but rounding of those of others, so is one below this part of all forces.
const IDLE: f64 = 64.0 * f64::EPSILON;

/// Rows of the dual: groups of contact rows of which none carries a force, but for rounding, and tangential rows of nodes whose friction
/// has no bound; `load` is that of all unknowns, force.
pub fn without_force(ready: &Ready, load: &[f64], answer: Candidate) -> Vec<bool> {
    let lambda = answer.lambda;
    let (rows, island) = (&ready.rows, &ready.island);
    let mut push = vec![0.0; load.len()];
    for kind in RowKind::ALL {
        island.members(kind).rows.matrix.mul_transposed_add(1.0, answer.forces(kind), &mut push);
    }
    let size = |v: &[f64], range: &Range<usize>| {
        weighted_norm(&v[range.clone()], |j| 1.0 / rows.metric[range.start + j])
    };
    let everywhere = size(load, &(0..load.len())).hypot(size(&push, &(0..load.len())));
    let nothing = |range: &Range<usize>| {
        let own = size(load, range);
        let idle = if own == 0.0 { IDLE * everywhere } else { 0.0 };
        (ROUNDING * (own + size(&push, range))).max(idle)
    };
    let nothing: Vec<f64> = island.ranges.iter().map(nothing).collect();
    let mut held: Vec<bool> = (0..rows.groups()).map(|group| rows.kind(group) != RowKind::Equality).collect();
    for (i, (group, _)) in rows.scaling.grouping.members().filter(|(i, _)| *i < rows.contact) {
        let bodies = island.contact.rows.matrix.row(i).map(|(j, _)| nothing[island.body_of(j)]);
        if lambda[i] > rows.scaling.scale[i] * bodies.fold(f64::INFINITY, f64::min) {
            held[group] = false;
        }
    }
    // friction resists where its bound is more than nothing
    for node in island.friction.nodes.iter().filter(|node| node.limit(lambda) > 0.0) {
        for row in node.rows().map(|row| rows.tangential + row) {
            if let Some((group, _)) = rows.scaling.grouping.member[row] {
                held[group] = false;
            }
        }
    }
    held.resize(ready.dual.order(), false);
    held
}
