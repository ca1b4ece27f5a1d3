//! Penetration, equality, sign and complementarity of each row, and the laws of friction at each node.

use crate::certificate::deformation::Deformation;
use crate::certificate::field::Field;
use crate::certificate::forces::Forces;
use crate::certificate::friction::{judged, JudgedNode};
use crate::certificate::row::JudgedRow;
use crate::certificate::{worse, BodyJudgement, Certificate, Entry, FrictionState, RowJudgement};
use crate::constraints::RowKind;
use crate::linalg::vector::{ratio, weighted_norm};

/// All rows of the island, contact rows, equality rows, tangential rows, and its nodes with friction.
pub(super) struct JudgedRows {
    rows: [Vec<JudgedRow>; 3],
    nodes: Vec<JudgedNode>,
}

impl JudgedRows {
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

    /// Slips of a node below this count as zero, length: the largest gap limit of its rows.
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

    /// Evaluates the entries of rows and nodes.
    pub fn judge(&self, limit: f64, certificate: &mut Certificate) {
        let [contact, equalities, _] = &self.rows;
        certificate.negative_force = worst(contact, limit, JudgedRow::sign);
        certificate.penetration = worst(contact, limit, JudgedRow::violation);
        certificate.complementarity = worst(contact, limit, JudgedRow::complementarity);
        certificate.equality = worst(equalities, limit, JudgedRow::violation);
        let (outside, slip_limit) = (JudgedNode::outside, |node: &JudgedNode| self.slip_limit(node));
        certificate.friction_cone = worst(&self.nodes, limit, outside);
        certificate.friction_work = worst(&self.nodes, limit, |node| node.unlawful(slip_limit(node)));
        certificate.friction_stick = worst(&self.nodes, limit, |node| node.loose(slip_limit(node)));
    }

    /// The largest unevenness of a row.
    pub fn unevenness(&self) -> f64 {
        self.rows.iter().flatten().map(|row| row.unevenness).fold(0.0, f64::max)
    }

    /// The values that count as zero at every contact row.
    pub fn limits(&self) -> Vec<RowJudgement> {
        self.rows[0].iter().map(|row| RowJudgement { gap: row.gap_limit, force: row.force_limit }).collect()
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

fn worst<T>(all: &[T], limit: f64, measure: impl Fn(&T) -> f64) -> Entry {
    let mut worst = Entry::default();
    for (i, one) in all.iter().enumerate() {
        worst.replace_if_worse(Entry::new(measure(one), limit, Some(i)));
    }
    worst
}
