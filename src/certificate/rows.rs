//! Penetration, equality, sign and complementarity, every row for itself, and friction, every node.

use std::ops::Range;

use crate::certificate::deformation::Deformation;
use crate::certificate::field::Field;
use crate::certificate::forces::Forces;
use crate::certificate::friction::{judged, JudgedNode};
use crate::certificate::{positive, share, worse, BodyJudgement, Certificate, Entry, FrictionState};
use crate::certificate::{RowJudgement, NOISE};
use crate::constraints::RowKind;
use crate::linalg::vector::{ratio, weighted_norm};

/// A row with what it is measured against.
pub(super) struct JudgedRow {
    pub kind: RowKind,
    /// lambda_i or mu_i, force.
    pub force: f64,
    /// `c_i + C_i lambda_i - b_i u`, length; of a tangential row minus the slip.
    pub open: f64,
    /// What tells the error of the force of a tangential row, length: that of its node along it.
    slipping: f64,
    /// `|lambda_i| / s_i^2`, length: what an error of the force as large as itself would do to the gap.
    given_way: f64,
    /// `s_i (|b_i| delta + |lambda_i| / s_i^2) / U^1/2` with the deformation of its own unknowns alone, length.
    weighed: f64,
    /// What a gap may differ from zero by, length; not known of a row without scale.
    pub gap_limit: f64,
    /// What a force may, force.
    pub force_limit: f64,
    /// `weighed` as a multiple of the deformation of the body deformed least that the row touches, no unit; 0 without force.
    unevenness: f64,
}

impl JudgedRow {
    fn new(field: &Field, deformation: &Deformation, forces: &Forces, kind: RowKind, i: usize) -> Self {
        let rows = field.rows(kind);
        let scale = field.scales[kind as usize][i];
        let force = field.answer.forces(kind)[i];
        let empty = rows.matrix.row(i).next().is_none();
        let given_way = if scale > 0.0 { (force.abs() / scale) / scale / field.unit } else { 0.0 };
        // what all forces on its unknowns together would move there: those that cancel do nothing but by their rounding
        let moves = |forces: &[f64]| -> f64 {
            let at = |(j, b): (usize, f64)| (b / field.metric[j] * (forces[j] / field.unit)).abs();
            rows.matrix.row(i).map(at).sum()
        };
        let felt = given_way.min(moves(&field.push) + rows.compliance[i] * force.abs());
        let cancelled = moves(&field.push_terms);
        let moved = rows.matrix.row_dot_abs(i, field.answer.u);
        let size = rows.matrix.row_dot_abs(i, &deformation.joined) + felt;
        let given = rows.rhs[i].abs() + rows.compliance[i] * force.abs();
        let rounding = NOISE * (moved + given + cancelled);
        // a row that weighs nothing is not known to hold
        let known = scale > 0.0 || empty;
        let force_limit = forces.limit_of(field, kind, i);
        // tol C_i Lambda_i: what an error of the force that is allowed moves a soft row by
        let by_spring = if rows.compliance[i] > 0.0 { rows.compliance[i] * force_limit } else { 0.0 };
        let allowed = field.data.limit * size + rounding + by_spring;
        let gap_limit = if known { allowed } else { f64::NAN };
        let own = rows.matrix.row_dot_abs(i, &deformation.own) + felt;
        let (open, weighed) = (rows.open_gap(i, field.answer.u, force), scale * own);
        let closed = force.abs() > force_limit;
        let unevenness = if closed { ratio(weighed, forces.least_deformation(field, kind, i)) } else { 0.0 };
        let slipping = 0.0;
        Self { kind, force, open, slipping, given_way, weighed, gap_limit, force_limit, unevenness }
    }

    /// `(b_i u - c_i - C_i lambda_i)_+`, or the error of an equality row, against what it may be; no unit.
    fn violation(&self) -> f64 {
        let violation = match self.kind {
            RowKind::Inequality => positive(-self.open),
            RowKind::Equality => self.open.abs(),
            RowKind::Tangential => 0.0,
        };
        share(violation, self.gap_limit)
    }

    /// `(-lambda_i)_+ / (tol Lambda_i)`
    fn sign(&self) -> f64 {
        share(positive(-self.force), self.force_limit)
    }

    /// `min(g_i / (tol L_i + noise_i), lambda_i / (tol Lambda_i))` of an open row with a force.
    fn complementarity(&self) -> f64 {
        let (force, gap) = (positive(self.force), positive(self.open));
        let closed = if gap == f64::INFINITY { gap } else { share(gap, self.gap_limit) };
        let idle = share(force, self.force_limit);
        if closed.is_nan() || idle.is_nan() {
            return if force == 0.0 { 0.0 } else { f64::NAN };
        }
        closed.min(idle)
    }

    /// The violation that tells the error of its force: `min(g_i, lambda_i / s_i^2)`, the error of an equality row, or the part
    /// of a node with friction along its row, length.
    fn natural(&self) -> f64 {
        match self.kind {
            RowKind::Inequality => self.open.min(self.given_way * self.force.signum()).abs(),
            RowKind::Equality => self.open.abs(),
            RowKind::Tangential => self.slipping,
        }
    }

    /// The worse of what is violated in its gap, no unit; that of tangential rows is known of their node alone.
    fn gap_ratio(&self) -> f64 {
        match self.kind {
            RowKind::Inequality => worse(self.violation(), self.complementarity()),
            RowKind::Equality => self.violation(),
            RowKind::Tangential => 0.0,
        }
    }
}

/// All rows of the island, contact rows, equality rows, tangential rows, and its nodes with friction.
///
/// What is judged for itself is named by kind and number: that of a row, with `Tangential` that of a node.
pub(super) struct Measured {
    pub rows: [Vec<JudgedRow>; 3],
    nodes: Vec<JudgedNode>,
}

impl Measured {
    pub fn new(field: &Field, deformation: &Deformation, forces: &Forces) -> Self {
        let row = |kind, i| JudgedRow::new(field, deformation, forces, kind, i);
        let of = |kind| (0..field.rows(kind).len()).map(|i| row(kind, i)).collect();
        let mut rows = RowKind::ALL.map(of);
        let nodes = judged(field, &rows);
        for node in &nodes {
            let own = rows[RowKind::Tangential as usize][node.rows()].iter_mut();
            own.zip(node.natural(field.unit)).for_each(|(row, part)| row.slipping = part.abs());
        }
        Self { rows, nodes }
    }

    /// What is judged for itself.
    pub fn all(&self) -> impl Iterator<Item = (RowKind, usize)> + '_ {
        let [contact, equalities, _] = &self.rows;
        let counts = [contact.len(), equalities.len(), self.nodes.len()];
        RowKind::ALL.into_iter().zip(counts).flat_map(|(kind, count)| (0..count).map(move |i| (kind, i)))
    }

    /// Its rows among those of its kind.
    pub fn rows_of(&self, kind: RowKind, i: usize) -> Range<usize> {
        match kind {
            RowKind::Tangential => self.nodes[i].rows(),
            _ => i..i + 1,
        }
    }

    /// The worse of what its gap or its slip violates; no unit.
    pub fn gap_ratio(&self, kind: RowKind, i: usize) -> f64 {
        match kind {
            RowKind::Tangential => self.nodes[i].gap_ratio(self.slip_limit(&self.nodes[i])),
            _ => self.rows[kind as usize][i].gap_ratio(),
        }
    }

    /// What the slip of a node may differ from zero by, length: the most that one of its rows may.
    fn slip_limit(&self, node: &JudgedNode) -> f64 {
        self.rows[RowKind::Tangential as usize][node.rows()].iter().map(|row| row.gap_limit).fold(0.0, worse)
    }

    /// `b |s|` of all nodes, force x length.
    pub fn dissipated(&self) -> impl Iterator<Item = f64> + '_ {
        self.nodes.iter().map(|node| node.dissipated(self.slip_limit(node)))
    }

    pub fn states(&self) -> Vec<FrictionState> {
        self.nodes.iter().map(|node| node.state(self.slip_limit(node))).collect()
    }

    /// The entries of the rows and nodes.
    pub fn judge(&mut self, limit: f64, certificate: &mut Certificate) {
        self.judge_gaps(limit, certificate, |_, _| true);
        certificate.negative_force = worst(&self.rows[0], limit, JudgedRow::sign, |_| true);
        certificate.friction_cone = worst(&self.nodes, limit, JudgedNode::outside, |_| true);
    }

    /// The entries of gaps and slips, by the rows and nodes `counts` names.
    pub fn judge_gaps(
        &self,
        limit: f64,
        certificate: &mut Certificate,
        counts: impl Fn(RowKind, usize) -> bool,
    ) {
        let [contact, equalities, _] = &self.rows;
        let touches = |i| counts(RowKind::Inequality, i);
        certificate.penetration = worst(contact, limit, JudgedRow::violation, touches);
        certificate.complementarity = worst(contact, limit, JudgedRow::complementarity, touches);
        let joins = |i| counts(RowKind::Equality, i);
        certificate.equality = worst(equalities, limit, JudgedRow::violation, joins);
        let rubs = |i| counts(RowKind::Tangential, i);
        let unlawful = |node: &JudgedNode| node.unlawful(self.slip_limit(node));
        certificate.friction_work = worst(&self.nodes, limit, unlawful, rubs);
        let loose = |node: &JudgedNode| node.loose(self.slip_limit(node));
        certificate.friction_stick = worst(&self.nodes, limit, loose, rubs);
    }

    /// The largest unevenness of a row.
    pub fn unevenness(&self) -> f64 {
        self.rows.iter().flatten().map(|row| row.unevenness).fold(0.0, f64::max)
    }

    /// What counts as zero at every contact row.
    pub fn limits(&self) -> Vec<RowJudgement> {
        self.rows[0].iter().map(|row| RowJudgement { gap: row.gap_limit, force: row.force_limit }).collect()
    }

    /// `|S L|` over all rows with the deformation of their own unknowns alone, (force x length)^1/2.
    pub fn length(&self, field: &Field) -> f64 {
        let all: Vec<f64> = self.rows.iter().flatten().map(|row| row.weighed).collect();
        weighted_norm(&all, |_| 1.0) * field.unit.sqrt()
    }

    /// `eta_p = |S v|_p / |S^-1 lambda|_p` of every body; both in units of force.
    pub fn force_errors(&self, field: &Field) -> Vec<BodyJudgement> {
        let mut parts = vec![(Vec::new(), Vec::new()); field.data.bodies.len()];
        for (rows, scales) in self.rows.iter().zip(&field.scales) {
            for (i, row) in rows.iter().enumerate().filter(|(i, _)| scales[*i] > 0.0) {
                let (moved, force) = (field.unit * (scales[i] * row.natural()), row.force / scales[i]);
                for p in field.touched(field.rows(row.kind), i) {
                    parts[p].0.push(moved);
                    parts[p].1.push(force);
                }
            }
        }
        let norm = |x: &[f64]| weighted_norm(x, |_| 1.0);
        let of = |(moved, forces): &(Vec<f64>, Vec<f64>)| ratio(norm(moved), norm(forces));
        parts.iter().map(|part| BodyJudgement { force_error: of(part) }).collect()
    }
}

fn worst<T>(all: &[T], limit: f64, measure: impl Fn(&T) -> f64, counts: impl Fn(usize) -> bool) -> Entry {
    let mut worst = Entry::default();
    for (i, one) in all.iter().enumerate().filter(|(i, _)| counts(*i)) {
        worst.replace_if_worse(Entry::new(measure(one), limit, Some(i)));
    }
    worst
}
