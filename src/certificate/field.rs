//! Quantities needed for all entries, over all unknowns and rows of the island.

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

use crate::body::Stiffness;
use crate::certificate::carried::{Metric, Search};
use crate::certificate::{BodyData, Candidate, Data, NOISE};
use crate::constraints::{row_scales, RowKind, RowSet};
use crate::error::Result;
use crate::linalg::vector::{power_of_two_below, weighted_norm};
use crate::linalg::Matrix;

pub(super) struct Field<'a> {
    pub data: &'a Data<'a>,
    pub answer: Candidate<'a>,
    /// U, the power of two below max D, force / length.
    pub unit: f64,
    /// D~ / U, n, no unit.
    pub metric: Vec<f64>,
    /// D^ / U, n, no unit: in it forces that cancel move an unknown by their rounding.
    pub led: Vec<f64>,
    /// Carried unknowns, n.
    pub carried: Vec<bool>,
    /// R of every body, and the unit with `R'D~R = unit`, force / length.
    pub motions: Vec<(Cow<'a, Matrix>, f64)>,
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
        let metered = data.metered();
        let stiffest = |(_, k, unit): &(usize, Stiffness, f64)| {
            (0..k.order()).map(|i| k.metric(i, *unit)).fold(0.0, f64::max)
        };
        let unit = power_of_two_below(metered.iter().map(stiffest).fold(0.0, f64::max));
        let forces = RowKind::ALL.map(|kind| answer.forces(kind));
        let holds = |kind: usize, i: usize| kind == RowKind::Equality as usize || forces[kind][i] != 0.0;
        let rows = RowKind::ALL.map(|kind| data.rows(kind));
        let search = Search::new(&metered, rows, &holds, unit)?;
        let led = search.clone().led()?;
        let Metric { values: metric, carried: places } = search.metric()?;
        let mut carried = vec![false; n];
        places.into_iter().for_each(|j| carried[j] = true);
        let motions = data.bodies.iter().map(|body| motions(body, unit, &metric, &carried));
        let motions = motions.collect::<Result<_>>()?;
        let (mut push, mut push_terms) = (vec![0.0; n], vec![0.0; n]);
        for kind in RowKind::ALL {
            let (rows, multipliers) = (data.rows(kind), answer.forces(kind));
            rows.matrix.mul_transposed_add(1.0, multipliers, &mut push);
            rows.matrix.mul_transposed_abs_add(multipliers, &mut push_terms);
        }
        let mut grounded = vec![false; n];
        for body in data.bodies.iter().filter(|body| !body.grounded.is_empty()) {
            let moving = moving(body)?;
            let free = |j: &&u32| carried[body.start + **j as usize] || moving.contains(j);
            let held = body.grounded.iter().filter(|j| !free(j));
            held.for_each(|j| grounded[body.start + *j as usize] = true);
        }
        let scales = RowKind::ALL.map(|kind| row_scales(data.rows(kind), &metric, unit));
        Ok(Self { data, answer, unit, metric, led, carried, motions, grounded, push, push_terms, scales })
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

    /// `|v|_{D^-1}` in D^ over the unknowns of body p, n_p, force.
    pub fn led_size(&self, p: usize, v: &[f64]) -> f64 {
        let start = self.data.bodies[p].start;
        weighted_norm(v, |i| 1.0 / self.led[start + i])
    }

    /// `b_i D^-1 b_i' + C_i` in D^, length / force.
    pub fn compliance(&self, kind: RowKind, i: usize) -> f64 {
        self.rows(kind).yields(i, &self.led, self.unit) / self.unit
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

/// R of a body with its unit: those of the host, or of `R'D~R = U` if some of its unknowns are carried or may be by more rows than
/// have a force here: then it was scaled in another metric, and all of u would count as deformation.
fn motions<'a>(
    body: &BodyData<'a>,
    unit: f64,
    metric: &[f64],
    carried: &[bool],
) -> Result<(Cow<'a, Matrix>, f64)> {
    let given = body.null_space;
    if given.cols == 0 || !body.soft && !carried[body.range()].contains(&true) {
        return Ok((Cow::Borrowed(given), body.unit));
    }
    let root = |i: usize| metric[body.start + i].sqrt();
    let basis = Matrix::from_fn(given.rows, given.cols, |i, j| root(i) * given.get(i, j))?;
    let basis = basis.orthonormalised(NOISE);
    let motions = Matrix::from_fn(basis.rows, basis.cols, |i, j| basis.get(i, j) / root(i))?;
    Ok((Cow::Owned(motions), unit))
}

/// Grounded unknowns j of a body that its null space moves nevertheless, `|K_jj R_j| > 1/4 sum_k |K_jk||R_k|`: they are
/// held only by a stiff neighbour, which may itself move. The motion of what rows may carry is no such motion: K resists it, and
/// it bends what a support holds.
fn moving(body: &BodyData) -> Result<HashSet<u32>> {
    let (n, motions) = (body.null_space.rows, body.null_space);
    let (mut image, mut terms, mut moving) = (vec![0.0; n], vec![0.0; n], HashSet::new());
    for k in 0..motions.cols {
        let motion = motions.col(k);
        body.stiffness.mul_with_terms(motion, &mut image, &mut terms)?;
        let work: f64 = motion.iter().zip(&image).map(|(r, f)| r * f).sum();
        let of_terms: f64 = motion.iter().zip(&terms).map(|(r, f)| r.abs() * f).sum();
        if work > NOISE * of_terms {
            continue;
        }
        let moves = |j: usize| 4.0 * (body.stiffness.metric(j, 0.0) * motion[j]).abs() > terms[j];
        moving.extend(body.grounded.iter().filter(|j| moves(**j as usize)));
    }
    Ok(moving)
}
