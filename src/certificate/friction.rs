//! Nodes with friction, each node separately. `b = bound + mu lambda_n`, `s = T u - s_old - C_t lambda_t`; a node sticks, `s = 0`
//! and `|lambda_t| <= b`, or slips along its force, `lambda_t = b s / |s|`.

use std::ops::Range;

use crate::certificate::field::Field;
use crate::certificate::row::JudgedRow;
use crate::certificate::{positive, share, worse, FrictionState, NOISE};
use crate::constraints::{FrictionNode, RowKind};
use crate::linalg::vector::weighted_norm;
use crate::numbers::certificate::OVERFLOW;

/// A node and its limits. With one tangential row, the second component is 0.
pub(super) struct JudgedNode {
    rows: Range<usize>,
    /// lambda_t, force.
    force: [f64; 2],
    /// s, length.
    slip: [f64; 2],
    /// b, force.
    bound: f64,
    /// The largest `b / s_i` of the nodes on the bodies that this node touches, multiplied by its s_i, force.
    largest: f64,
    /// The smallest s_i of its tangential rows, `/ U^1/2`, no unit.
    scale: f64,
    /// Permitted error of its force: the largest `tol Lambda_i` of its rows plus rounding of lambda_t, force.
    force_limit: f64,
    /// Permitted error of b: mu times that of the normal force, force.
    bound_limit: f64,
    /// tol, no unit.
    limit: f64,
}

/// All nodes of the island with the limits of their rows.
pub(super) fn judged(field: &Field, rows: &[Vec<JudgedRow>; 3]) -> Vec<JudgedNode> {
    let (nodes, lambda) = (field.data.nodes, field.answer.lambda);
    let mut largest = vec![0.0; field.data.bodies.len()];
    for node in nodes {
        // rows of nodes may have different factors: bounds divided by the row scale are comparable
        let bound = node.limit(lambda) / scale(field, node);
        bodies(field, node).for_each(|p| largest[p] = f64::max(largest[p], bound));
    }
    let [contact, _, tangential] = rows;
    let of = |node: &FrictionNode| {
        let own = &tangential[node.rows()];
        let both = |of: fn(&JudgedRow) -> f64| [0, 1].map(|k| own.get(k).map_or(0.0, of));
        let (force, slip) = (both(|row| row.force), both(|row| -row.open));
        let rounding = 2.0 * NOISE * length(force);
        JudgedNode {
            rows: node.rows(),
            force,
            slip,
            bound: node.limit(lambda),
            largest: scale(field, node) * bodies(field, node).map(|p| largest[p]).fold(0.0, f64::max),
            scale: scale(field, node),
            force_limit: own.iter().map(|row| row.force_limit).fold(0.0, worse) + rounding,
            bound_limit: node.normal.map_or(0.0, |row| node.coefficient * contact[row].force_limit),
            limit: field.data.limit,
        }
    };
    nodes.iter().map(of).collect()
}

/// The smallest `s_i / U^1/2` of its tangential rows, no unit; that of its contact row if none of them has entries.
fn scale(field: &Field, node: &FrictionNode) -> f64 {
    let [contact, _, tangential] = &field.scales;
    let with_entries = tangential[node.rows()].iter().copied().filter(|s| *s > 0.0);
    with_entries.reduce(f64::min).or(node.normal.map(|row| contact[row])).unwrap_or(0.0)
}

/// Bodies that the rows of a node touch, with repetitions.
fn bodies<'a>(field: &'a Field, node: &'a FrictionNode) -> impl Iterator<Item = usize> + 'a {
    let of = |kind: RowKind, i: usize| field.touched(field.rows(kind), i);
    let tangential = node.rows().flat_map(move |i| of(RowKind::Tangential, i));
    tangential.chain(node.normal.into_iter().flat_map(move |i| of(RowKind::Inequality, i)))
}

impl JudgedNode {
    /// Its tangential rows.
    pub fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// `(|lambda_t| - b)_+` relative to the permitted error of the force; no unit.
    pub fn outside(&self) -> f64 {
        share(positive(length(self.force) - self.bound), self.force_limit)
    }

    /// `|lambda_t - P_b(lambda_t + k s)|` relative to the permitted error of the force, no unit. P_b projects on the disc
    /// of radius b; k is the ratio of the permitted errors of force and slip (`gap_limit`, length). It is 0 only if `b
    /// |s| = lambda_t.s` and `|lambda_t| <= b`, and linear in the error: `|s| / gap_limit` for a small slip, `|lambda_t -
    /// b s / |s||` relative to the permitted error of the force for a large one.
    pub fn unlawful(&self, gap_limit: f64) -> f64 {
        let force = self.force.map(|part| share(part, self.force_limit));
        let lawful = self.lawful(gap_limit);
        length([force[0] - lawful[0], force[1] - lawful[1]])
    }

    /// `P_b(lambda_t + k s)` in units of the permitted error of the force.
    fn lawful(&self, gap_limit: f64) -> [f64; 2] {
        let unit = self.force_limit;
        let far = share(length(self.slip), gap_limit);
        let far = if far > OVERFLOW { OVERFLOW } else { far };
        let along = self.slip.map(|part| far * share(part, length(self.slip)));
        held(self.force.map(|part| share(part, unit)), along, share(self.bound, unit))
    }

    /// `P_b(lambda_t + k s).s`, force x length: `b |s|` of a slip; for a stick only rounding, however large b is.
    pub fn dissipated(&self, gap_limit: f64) -> f64 {
        let lawful = self.lawful(gap_limit);
        (lawful[0] * self.slip[0] + lawful[1] * self.slip[1]) * self.force_limit
    }

    /// `|s| (b - |lambda_t|)_+ / (b + tol x the largest b nearby)` relative to the permitted error of the slip, no unit.
    /// The error of b is tol b plus mu times the permitted error of the normal force.
    pub fn loose(&self, gap_limit: f64) -> f64 {
        let known = (self.limit + NOISE) * self.bound + self.bound_limit;
        let missing = positive(self.bound - length(self.force) - known);
        if missing == 0.0 {
            return 0.0;
        }
        share(length(self.slip), gap_limit) * share(missing, self.bound + self.limit * self.largest)
    }

    pub fn state(&self, gap_limit: f64) -> FrictionState {
        let (force, slip) = (length(self.force), length(self.slip));
        let nothing = self.force_limit + self.bound_limit;
        if self.bound <= nothing && force <= nothing {
            FrictionState::Open
        } else if slip > gap_limit {
            FrictionState::Slip
        } else if slip <= gap_limit && force < self.bound - self.force_limit {
            FrictionState::Stick
        } else {
            FrictionState::Weak
        }
    }

    /// `(lambda_t - P_b(lambda_t + s_i^2 s)) / s_i^2`, length: the estimate of the force error, like `min(g_i, lambda_i /
    /// s_i^2)` of a contact row. `unit`: U, force / length.
    pub fn natural(&self, unit: f64) -> [f64; 2] {
        let moved = 1.0 / self.scale / self.scale / unit;
        let lawful = held(self.force, self.slip.map(|part| part / moved), self.bound);
        [0, 1].map(|k| (self.force[k] - lawful[k]) * moved)
    }
}

/// `P_b(force + step)`, all in the same unit.
fn held(force: [f64; 2], step: [f64; 2], bound: f64) -> [f64; 2] {
    let all = [force[0] + step[0], force[1] + step[1]];
    let size = length(all);
    if size > bound {
        all.map(|part| part * (bound / size))
    } else {
        all
    }
}

/// `|v|` without overflow or underflow.
fn length(v: [f64; 2]) -> f64 {
    weighted_norm(&v, |_| 1.0)
}
