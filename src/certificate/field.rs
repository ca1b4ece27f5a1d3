//! Quantities needed for all entries, over all unknowns and rows of the island.

use std::collections::HashSet;
use std::ops::Range;

use crate::certificate::{metric, BodyData, Candidate, Data};
use crate::constraints::{row_scales, RowKind, RowSet};
use crate::error::Result;
use crate::linalg::vector::{norm_max, power_of_two_below, weighted_norm};

pub(super) struct Field<'a> {
    pub data: &'a Data<'a>,
    pub answer: Candidate<'a>,
    /// U, the power of two below max D, force / length.
    pub unit: f64,
    /// D / U, n, no unit.
    pub metric: Vec<f64>,
    /// Grounded unknowns, n.
    pub grounded: Vec<bool>,
    /// r = B'lambda + H'mu + T'lambda_t, n, force.
    pub push: Vec<f64>,
    /// `|B'||lambda| + |H'||mu| + |T'||lambda_t|`, n, force.
    pub push_terms: Vec<f64>,
    /// `s_i / U^1/2` of contact, equality and tangential rows, no unit.
    pub scales: [Vec<f64>; 3],
}

impl<'a> Field<'a> {
    pub fn new(data: &'a Data<'a>, answer: Candidate<'a>) -> Result<Self> {
        let n = answer.u.len();
        let mut metric = metric(data, n);
        let unit = power_of_two_below(norm_max(&metric));
        metric.iter_mut().for_each(|d| *d /= unit);
        let (mut push, mut push_terms) = (vec![0.0; n], vec![0.0; n]);
        for kind in RowKind::ALL {
            let (rows, multipliers) = (data.rows(kind), answer.forces(kind));
            rows.matrix.mul_transposed_add(1.0, multipliers, &mut push);
            rows.matrix.mul_transposed_abs_add(multipliers, &mut push_terms);
        }
        let mut grounded = vec![false; n];
        for body in data.bodies.iter().filter(|body| !body.grounded.is_empty()) {
            let moving = moving(body)?;
            let held = body.grounded.iter().filter(|j| !moving.contains(j));
            held.for_each(|j| grounded[body.start + *j as usize] = true);
        }
        let scales = RowKind::ALL.map(|kind| row_scales(data.rows(kind), &metric, unit));
        Ok(Self { data, answer, unit, metric, grounded, push, push_terms, scales })
    }

    pub fn rows(&self, kind: RowKind) -> &'a RowSet {
        self.data.rows(kind)
    }

    /// Range of the unknowns of body p among all unknowns.
    pub fn range(&self, p: usize) -> Range<usize> {
        self.data.bodies[p].range()
    }

    /// `f_j`, force.
    pub fn load(&self, p: usize, j: usize) -> f64 {
        let body = &self.data.bodies[p];
        body.load.map_or(0.0, |f| f[j - body.start])
    }

    /// `value` over the unknowns of body p, 0 if they are grounded.
    pub fn free(&self, p: usize, value: impl Fn(usize) -> f64) -> Vec<f64> {
        self.range(p).map(|j| if self.grounded[j] { 0.0 } else { value(j) }).collect()
    }

    /// `|v|_{D^-1}` over the unknowns of body p, n_p, force.
    pub fn size(&self, p: usize, v: &[f64]) -> f64 {
        let start = self.data.bodies[p].start;
        weighted_norm(v, |i| 1.0 / self.metric[start + i])
    }

    /// The bodies that row i touches, ascending.
    pub fn touched<'s>(&'s self, rows: &'s RowSet, i: usize) -> impl Iterator<Item = usize> + 's {
        let mut end = 0;
        rows.matrix.row(i).filter_map(move |(j, _)| {
            if j < end {
                return None;
            }
            let p = self.data.bodies.partition_point(|body| body.start <= j) - 1;
            end = self.range(p).end;
            Some(p)
        })
    }
}

/// Grounded unknowns j of a body that its null space moves nevertheless, `|K_jj R_j| > 1/4 sum_k |K_jk||R_k|`: they are
/// held only by a stiff neighbour, which may itself move.
fn moving(body: &BodyData) -> Result<HashSet<u32>> {
    let (n, motions) = (body.null_space.rows, body.null_space);
    let (mut image, mut terms, mut moving) = (vec![0.0; n], vec![0.0; n], HashSet::new());
    for k in 0..motions.cols {
        body.stiffness.mul_with_terms(motions.col(k), &mut image, &mut terms)?;
        let moves = |j: usize| 4.0 * (body.stiffness.metric(j, 0.0) * motions.get(j, k)).abs() > terms[j];
        moving.extend(body.grounded.iter().filter(|j| moves(**j as usize)));
    }
    Ok(moving)
}
