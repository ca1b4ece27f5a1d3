//! Quantities needed for all entries, over the unknowns of every body, the unknowns that rows touch, and the rows of the island.

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

use crate::certificate::carried::{everywhere, stiffest, Metric, Search};
use crate::certificate::{BodyData, Candidate, Data, NOISE};
use crate::constraints::{row_scales, RowKind, RowSet};
use crate::error::Result;
use crate::linalg::vector::{power_of_two_below, weighted_norm};
use crate::linalg::{ByBody, Matrix};

const WHAT: &str = "the certificate";

pub(super) struct Field<'a> {
    pub data: &'a Data<'a>,
    pub answer: Candidate<'a>,
    /// U, the power of two below max D, force / length.
    pub unit: f64,
    /// D~ / U, no unit.
    pub metric: ByBody,
    /// D^ / U, no unit: in it forces that cancel move an unknown by their rounding.
    pub led: ByBody,
    /// R of every body, and the unit with `R'D~R = unit`, force / length.
    pub motions: Vec<(Cow<'a, Matrix>, f64)>,
    /// Grounded unknowns.
    pub grounded: ByBody<bool>,
    /// r = B'lambda + H'mu + T'lambda_t, force.
    pub push: ByBody,
    /// `|B'||lambda| + |H'||mu| + |T'||lambda_t|`, force.
    pub push_terms: ByBody,
    /// The same and the answer where rows touch.
    pub at: AtRows,
    /// `s_i / U^1/2` of contact, equality and tangential rows, no unit.
    pub scales: [Vec<f64>; 3],
}

/// Values at the unknowns that rows touch.
pub(super) struct AtRows {
    /// Length.
    pub u: Vec<f64>,
    pub metric: Vec<f64>,
    pub led: Vec<f64>,
    pub push: Vec<f64>,
    pub push_terms: Vec<f64>,
    /// Loads, force.
    pub load: Vec<f64>,
    pub grounded: Vec<bool>,
    /// Carried unknowns.
    pub carried: Vec<bool>,
}

impl<'a> Field<'a> {
    pub fn new(data: &'a Data<'a>, answer: Candidate<'a>) -> Result<Self> {
        let (touched, ranges) = (data.touched, data.ranges);
        let metered = data.metered();
        let unit = metered.iter().map(|(k, without)| stiffest(*k, *without)).fold(0.0, f64::max);
        let unit = power_of_two_below(unit);
        let forces = RowKind::ALL.map(|kind| answer.forces(kind));
        let holds = |kind: usize, i: usize| kind == RowKind::Equality as usize || forces[kind][i] != 0.0;
        let rows = RowKind::ALL.map(|kind| data.rows(kind));
        let search = Search::new(&metered, touched, rows, &holds, unit)?;
        let led = search.clone().led()?;
        let Metric { values: metric, carried: places } = search.metric()?;
        let mut carried = vec![false; touched.len()];
        places.into_iter().for_each(|j| carried[j] = true);
        let metric = everywhere(&metered, (ranges, touched), &metric, unit)?;
        let mut all_led = metric.clone();
        touched.set(&led, &mut all_led);
        let motions = data.bodies.iter().enumerate().map(|(p, body)| {
            let is_carried = carried[touched.range(p)].contains(&true);
            motions(body, unit, metric.on(p), is_carried)
        });
        let motions = motions.collect::<Result<_>>()?;
        let grounded = grounded(data, &carried)?;
        let (mut push, mut push_terms) = (vec![0.0; touched.len()], vec![0.0; touched.len()]);
        for kind in RowKind::ALL {
            let (rows, multipliers) = (data.rows(kind), answer.forces(kind));
            rows.matrix.mul_transposed_add(1.0, multipliers, &mut push);
            rows.matrix.mul_transposed_abs_add(multipliers, &mut push_terms);
        }
        let load = |(p, body): (usize, &'a BodyData<'a>)| {
            touched.dofs(p).map(move |dof| body.load.map_or(0.0, |load| load[dof]))
        };
        let at = AtRows {
            u: touched.at(answer.u),
            metric: touched.at(&metric),
            led,
            load: data.bodies.iter().enumerate().flat_map(load).collect(),
            grounded: touched.at(&grounded),
            carried,
            push,
            push_terms,
        };
        let (mut push, mut push_terms) = (ByBody::zeros(ranges, WHAT)?, ByBody::zeros(ranges, WHAT)?);
        touched.set(&at.push, &mut push);
        touched.set(&at.push_terms, &mut push_terms);
        let scales = RowKind::ALL.map(|kind| row_scales(data.rows(kind), &at.metric, unit));
        Ok(Self { data, answer, unit, metric, led: all_led, motions, grounded, push, push_terms, at, scales })
    }

    pub fn rows(&self, kind: RowKind) -> &'a RowSet {
        self.data.rows(kind)
    }

    /// Unknowns of body p.
    pub fn dofs(&self, p: usize) -> Range<usize> {
        0..self.data.bodies[p].stiffness.order()
    }

    /// `f_j` of unknown j of body p, force.
    pub fn load(&self, p: usize, j: usize) -> f64 {
        self.data.bodies[p].load.map_or(0.0, |f| f[j])
    }

    /// `value` over the unknowns of body p, 0 if they are grounded.
    pub fn free(&self, p: usize, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let grounded = self.grounded.on(p);
        self.dofs(p).map(|j| if grounded[j] { 0.0 } else { value(j) }).collect()
    }

    /// `|v|_{D^-1}` over the unknowns of body p, force.
    pub fn size(&self, p: usize, v: &[f64]) -> f64 {
        let metric = self.metric.on(p);
        weighted_norm(v, |j| 1.0 / metric[j])
    }

    /// `|v|_{D^-1}` in D^ over the unknowns of body p, force.
    pub fn led_size(&self, p: usize, v: &[f64]) -> f64 {
        let led = self.led.on(p);
        weighted_norm(v, |j| 1.0 / led[j])
    }

    /// `b_i D^-1 b_i' + C_i` in D^, length / force.
    pub fn compliance(&self, kind: RowKind, i: usize) -> f64 {
        self.rows(kind).yields(i, &self.at.led, self.unit) / self.unit
    }

    /// The bodies that row i touches, ascending.
    pub fn touched<'s>(&'s self, rows: &'s RowSet, i: usize) -> impl Iterator<Item = usize> + 's {
        let mut end = 0;
        rows.matrix.row(i).filter_map(move |(j, _)| {
            if j < end {
                return None;
            }
            let p = self.data.touched.body_of(j);
            end = self.data.touched.range(p).end;
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
    is_carried: bool,
) -> Result<(Cow<'a, Matrix>, f64)> {
    let given = body.null_space;
    if given.cols == 0 || !body.soft && !is_carried {
        return Ok((Cow::Borrowed(given), body.unit));
    }
    let root = |i: usize| metric[i].sqrt();
    let basis = Matrix::from_fn(given.rows, given.cols, |i, j| root(i) * given.get(i, j))?;
    let basis = basis.orthonormalised(NOISE);
    let motions = Matrix::from_fn(basis.rows, basis.cols, |i, j| basis.get(i, j) / root(i))?;
    Ok((Cow::Owned(motions), unit))
}

/// Grounded unknowns that are not carried, and that no motion moves.
fn grounded(data: &Data, carried: &[bool]) -> Result<ByBody<bool>> {
    let mut grounded = ByBody::filled(data.ranges, false, WHAT)?;
    for (p, body) in data.bodies.iter().enumerate().filter(|(_, body)| !body.grounded.is_empty()) {
        let moving = moving(body)?;
        let is_carried = |j: u32| data.touched.place(p, j as usize).is_some_and(|at| carried[at]);
        let held = body.grounded.iter().filter(|j| !is_carried(**j) && !moving.contains(j));
        held.for_each(|j| grounded.on_mut(p)[*j as usize] = true);
    }
    Ok(grounded)
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
