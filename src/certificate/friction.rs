//! Nodes with friction, each node separately. `b = bound + mu lambda_n`, `s = T u - s_old - C_t lambda_t`; a node sticks, `s = 0`
//! and `|lambda_t| <= b`, or slips along its force, `lambda_t = b s / |s|`.

use std::ops::Range;

use crate::certificate::field::Field;
use crate::certificate::row::JudgedRow;
use crate::certificate::{positive, share, worse, FrictionState, NOISE};
use crate::constraints::{FrictionNode, RowKind};
use crate::linalg::vector::weighted_norm;

/// A slip of so many times its limit is far beyond any bound: more would overflow.
const FAR: f64 = 1e100;

/// A node with what it is measured against. One tangential row is the first of two, the second is 0.
pub(super) struct JudgedNode {
    rows: Range<usize>,
    /// lambda_t, force.
    force: [f64; 2],
    /// s, length.
    slip: [f64; 2],
    /// b, force.
    bound: f64,
    /// The largest `b / s_i` of the nodes on the bodies that this one touches, times its own s_i, force.
    largest: f64,
    /// s_i of the row that weighs most, `/ U^1/2`, no unit.
    scale: f64,
    /// What its force may be off by: the largest `tol Lambda_i` of its rows and rounding of lambda_t, force.
    force_limit: f64,
    /// What b may be off by: mu x what the normal force may, force.
    bound_limit: f64,
    /// tol, no unit.
    limit: f64,
}

/// All nodes of the island, with their rows.
pub(super) fn judged(field: &Field, rows: &[Vec<JudgedRow>; 3]) -> Vec<JudgedNode> {
    let (nodes, lambda) = (field.data.nodes, field.answer.lambda);
    let mut largest = vec![0.0; field.data.bodies.len()];
    for node in nodes {
        // factors of nodes differ: by what their rows weigh bounds are comparable
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

/// `s_i / U^1/2` of its row that weighs most, no unit.
fn scale(field: &Field, node: &FrictionNode) -> f64 {
    let scales = &field.scales[RowKind::Tangential as usize][node.rows()];
    scales.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Bodies that the rows of a node touch, some of them more than once.
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

    /// `(|lambda_t| - b)_+` of what the force may be off by; no unit.
    pub fn outside(&self) -> f64 {
        share(positive(length(self.force) - self.bound), self.force_limit)
    }

    /// `|lambda_t - P_b(lambda_t + k s)|` of what the force may be off by, no unit; P_b projects on the disc of radius b, and k takes
    /// `gap_limit`, what the slip may be off by, length, to what the force may. 0 where `b |s| = lambda_t.s` and `|lambda_t| <= b`
    /// alone, and linear in what is wrong: `|s| / gap_limit` of a slip that is small, of a large one
    /// `|lambda_t - b s / |s||` of what the force may be off by.
    pub fn unlawful(&self, gap_limit: f64) -> f64 {
        let force = self.force.map(|part| share(part, self.force_limit));
        let lawful = self.lawful(gap_limit);
        length([force[0] - lawful[0], force[1] - lawful[1]])
    }

    /// `P_b(lambda_t + k s)` in units of what the force may be off by.
    fn lawful(&self, gap_limit: f64) -> [f64; 2] {
        let unit = self.force_limit;
        let far = share(length(self.slip), gap_limit);
        let far = if far > FAR { FAR } else { far };
        let along = self.slip.map(|part| far * share(part, length(self.slip)));
        held(self.force.map(|part| share(part, unit)), along, share(self.bound, unit))
    }

    /// `P_b(lambda_t + k s).s`, force x length: `b |s|` of a slip, nothing but rounding of a stick, however large b is.
    pub fn dissipated(&self, gap_limit: f64) -> f64 {
        let lawful = self.lawful(gap_limit);
        (lawful[0] * self.slip[0] + lawful[1] * self.slip[1]) * self.force_limit
    }

    /// `|s| (b - |lambda_t|)_+ / (b + tol x the largest b around)` of what the slip may be off by, no unit. b is known to tol of
    /// itself and to mu x what the normal force may be off by.
    pub fn loose(&self, gap_limit: f64) -> f64 {
        let known = (self.limit + NOISE) * self.bound + self.bound_limit;
        let missing = positive(self.bound - length(self.force) - known);
        if missing == 0.0 {
            return 0.0;
        }
        share(length(self.slip), gap_limit) * share(missing, self.bound + self.limit * self.largest)
    }

    /// The worse of what a slip that is off may violate.
    pub fn gap_ratio(&self, gap_limit: f64) -> f64 {
        worse(self.unlawful(gap_limit), self.loose(gap_limit))
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

    /// `(lambda_t - P_b(lambda_t + s_i^2 s)) / s_i^2`, length: what tells the error of the force, as `min(g_i, lambda_i / s_i^2)` of a
    /// contact row. `unit`: U, force / length.
    pub fn natural(&self, unit: f64) -> [f64; 2] {
        let moved = 1.0 / self.scale / self.scale / unit;
        let lawful = held(self.force, self.slip.map(|part| part / moved), self.bound);
        [0, 1].map(|k| (self.force[k] - lawful[k]) * moved)
    }
}

/// `P_b(force + step)`, all in one unit.
fn held(force: [f64; 2], step: [f64; 2], bound: f64) -> [f64; 2] {
    let all = [force[0] + step[0], force[1] + step[1]];
    let size = length(all);
    if size > bound {
        all.map(|part| part * (bound / size))
    } else {
        all
    }
}

/// `|v|`, however small or large.
fn length(v: [f64; 2]) -> f64 {
    weighted_norm(&v, |_| 1.0)
}
