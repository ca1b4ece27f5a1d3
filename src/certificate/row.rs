//! One row and the quantities to which its gap and its force are relative.

use crate::certificate::deformation::Deformation;
use crate::certificate::field::Field;
use crate::certificate::forces::Forces;
use crate::certificate::{positive, share, NOISE};
use crate::constraints::RowKind;
use crate::linalg::vector::ratio;

/// A row and its limits.
pub(super) struct JudgedRow {
    pub kind: RowKind,
    /// lambda_i or mu_i, force.
    pub force: f64,
    /// `c_i + C_i lambda_i - b_i u`, length; of a tangential row minus the slip.
    pub open: f64,
    /// Estimate of the force error of a tangential row, length: the component of its node's error.
    pub slipping: f64,
    /// `|lambda_i| / s_i^2`, length: the gap that an error as large as the force would cause.
    given_way: f64,
    /// Gaps below this count as zero, length; NaN for a row without scale.
    pub gap_limit: f64,
    /// Forces below this count as zero, force.
    pub force_limit: f64,
    /// `s_i (|b_i| delta + |lambda_i| / s_i^2) / U^1/2` with the deformation of its own unknowns alone, divided by the smallest
    /// deformation among the bodies that the row touches, no unit; 0 without force.
    pub unevenness: f64,
}

impl JudgedRow {
    pub fn new(field: &Field, deformation: &Deformation, forces: &Forces, kind: RowKind, i: usize) -> Self {
        let rows = field.rows(kind);
        let scale = field.scales[kind as usize][i];
        let force = field.answer.forces(kind)[i];
        let empty = rows.matrix.row(i).next().is_none();
        let given_way = if scale > 0.0 { (force.abs() / scale) / scale / field.unit } else { 0.0 };
        // the motion caused there by all forces on its unknowns together: forces that cancel contribute only rounding
        let moves = |forces: &[f64], metric: &[f64]| -> f64 {
            let at = |(j, b): (usize, f64)| (b / metric[j] * (forces[j] / field.unit)).abs();
            rows.matrix.row(i).map(at).sum()
        };
        let felt = given_way.min(moves(&field.at.push, &field.at.metric) + rows.compliance[i] * force.abs());
        let cancelled = moves(&field.at.push_terms, &field.at.led);
        let moved = rows.matrix.row_dot_abs(i, &field.at.u);
        let size = rows.matrix.row_dot_abs(i, &deformation.joined) + felt;
        let given = rows.rhs[i].abs() + rows.compliance[i] * force.abs();
        // forces that do not deform a body are known to rounding, and so is its displacement
        let by_forces = forces.rounding_at(field, kind, i) * field.compliance(kind, i).sqrt();
        let rounding = NOISE * (moved + given + cancelled) + rows.rounding(i) + by_forces;
        // without a scale the row cannot be checked
        let known = scale > 0.0 || empty;
        let force_limit = forces.limit_of(field, kind, i);
        // tol C_i Lambda_i: motion of a soft row by a permitted error of its force
        let by_spring = if rows.compliance[i] > 0.0 { rows.compliance[i] * force_limit } else { 0.0 };
        let allowed = field.data.limit * size + rounding + by_spring;
        let gap_limit = if known { allowed } else { f64::NAN };
        let own = rows.matrix.row_dot_abs(i, &deformation.own) + felt;
        let (open, weighed) = (rows.open_gap(i, &field.at.u, force), scale * own);
        let closed = force.abs() > force_limit;
        let unevenness = if closed { ratio(weighed, forces.least_deformation(field, kind, i)) } else { 0.0 };
        let slipping = 0.0;
        Self { kind, force, open, slipping, given_way, gap_limit, force_limit, unevenness }
    }

    /// `(b_i u - c_i - C_i lambda_i)_+`, or the error of an equality row, relative to its limit; no unit.
    pub fn violation(&self) -> f64 {
        let violation = match self.kind {
            RowKind::Inequality => positive(-self.open),
            RowKind::Equality => self.open.abs(),
            RowKind::Tangential => 0.0,
        };
        share(violation, self.gap_limit)
    }

    /// `(-lambda_i)_+ / (tol Lambda_i)`
    pub fn sign(&self) -> f64 {
        share(positive(-self.force), self.force_limit)
    }

    /// `min(g_i / (tol L_i + noise_i), lambda_i / (tol Lambda_i))` of an open row with a force.
    pub fn complementarity(&self) -> f64 {
        let (force, gap) = (positive(self.force), positive(self.open));
        let closed = if gap == f64::INFINITY { gap } else { share(gap, self.gap_limit) };
        let idle = share(force, self.force_limit);
        if closed.is_nan() || idle.is_nan() {
            return if force == 0.0 { 0.0 } else { f64::NAN };
        }
        closed.min(idle)
    }

    /// The violation that estimates the error of its force: `min(g_i, lambda_i / s_i^2)`, the error of an equality row,
    /// or the component along its row for a node with friction, length.
    pub fn natural(&self) -> f64 {
        match self.kind {
            RowKind::Inequality => self.open.min(self.given_way * self.force.signum()).abs(),
            RowKind::Equality => self.open.abs(),
            RowKind::Tangential => self.slipping,
        }
    }
}
