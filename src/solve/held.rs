//! Which rows carry a force that holds a motion, and which rows carry only rounding.

use std::ops::Range;

use crate::certificate::Candidate;
use crate::constraints::RowKind;
use crate::linalg::vector::weighted_norm;
use crate::linalg::Operator;
use crate::setup::Ready;

/// A force is rounding, and holds no motion, if it is below this part of the forces on each body that its row touches ...
const ROUNDING: f64 = 1e-12;
/// ... or, on bodies without load, below this part of all forces: it may be rounding of the forces of other bodies.
const IDLE: f64 = 64.0 * f64::EPSILON;

/// Rows of the dual that hold nothing: groups of contact rows whose forces are all rounding, and tangential rows of nodes
/// whose friction bound is 0. `load`: loads of all unknowns, force.
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
    // friction resists if its bound is positive
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
