//! What all entries need: the rows of the island with the forces on them, values at the unknowns that rows touch, and the bodies.

use crate::body::Kept;
use crate::certificate::carried::{Metric, Search};
use crate::certificate::clusters::Trace;
use crate::certificate::part::{Felt, Fit, Fitted, Told};
use crate::certificate::{Candidate, Data};
use crate::constraints::{row_scales, RowKind, RowSet};
use crate::error::Result;
use crate::linalg::vector::power_of_two_below;

pub(super) struct Field<'a> {
    pub data: &'a Data<'a>,
    pub answer: Candidate<'a>,
    /// U, the power of two below max D, force / length.
    pub unit: f64,
    pub at: AtRows,
    /// `s_i / U^1/2` of contact, equality and tangential rows, no unit.
    pub scales: [Vec<f64>; 3],
    /// What every body tells first.
    pub fitted: Vec<Fitted>,
}

/// Values at the unknowns that rows touch.
pub(super) struct AtRows {
    /// Length.
    pub u: Vec<f64>,
    /// D~ / U and D^ / U, no unit.
    pub metric: Vec<f64>,
    pub led: Vec<f64>,
    /// r = B'lambda + H'mu + T'lambda_t, force.
    pub push: Vec<f64>,
    /// `|B'||lambda| + |H'||mu| + |T'||lambda_t|`, force.
    pub push_terms: Vec<f64>,
    /// r without the forces of an unknown's own rows where it is carried, force.
    pub passed_on: Vec<f64>,
    /// Carried unknowns.
    pub carried: Vec<bool>,
}

impl<'a> Field<'a> {
    /// With what the bodies keep of it.
    pub fn new(data: &'a Data<'a>, answer: Candidate<'a>) -> Result<(Self, Kept<Felt>)> {
        let trace = Trace::of(&data.bodies, |body| data.without(body));
        let stiffest = data.bodies.iter().zip(&trace.stiffest);
        let largest = stiffest.map(|(body, most)| if *most > 0.0 { *most } else { data.without(body) });
        let unit = power_of_two_below(largest.fold(0.0, f64::max));
        let at = AtRows::new(data, answer, &trace, unit)?;
        let told = |p: usize| {
            let range = data.touched.range(p);
            let told = Told {
                unit,
                without: data.without(data.bodies.body(p)),
                metric: at.metric[range.clone()].to_vec(),
                led: at.led[range.clone()].to_vec(),
                carried: at.carried[range.clone()].to_vec(),
                push: at.push[range.clone()].to_vec(),
                push_terms: at.push_terms[range.clone()].to_vec(),
                passed_on: at.passed_on[range].to_vec(),
            };
            Fit { told }
        };
        let (fitted, felt) = data.bodies.make(told, (answer.u, &data.loads))?;
        let scales = RowKind::ALL.map(|kind| row_scales(data.rows(kind), &at.metric, unit));
        Ok((Self { data, answer, unit, at, scales, fitted }, felt))
    }

    pub fn rows(&self, kind: RowKind) -> &'a RowSet {
        self.data.rows(kind)
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

    /// Touched unknown j of body p is grounded.
    pub fn is_grounded(&self, p: usize, j: usize) -> bool {
        self.fitted[p].grounded[j - self.data.touched.range(p).start]
    }
}

impl AtRows {
    fn new(data: &Data, answer: Candidate, trace: &Trace, unit: f64) -> Result<Self> {
        let touched = data.touched;
        let forces = RowKind::ALL.map(|kind| answer.forces(kind));
        let holds = |kind: usize, i: usize| kind == RowKind::Equality as usize || forces[kind][i] != 0.0;
        let search = Search::new(trace, RowKind::ALL.map(|kind| data.rows(kind)), &holds, unit)?;
        let led = search.clone().led()?;
        let Metric { values: metric, carried: places } = search.metric()?;
        let mut carried = vec![false; touched.len()];
        places.into_iter().for_each(|j| carried[j] = true);
        let (mut push, mut push_terms) = (vec![0.0; touched.len()], vec![0.0; touched.len()]);
        for kind in RowKind::ALL {
            let (rows, multipliers) = (data.rows(kind), answer.forces(kind));
            rows.matrix.mul_transposed_add(1.0, multipliers, &mut push);
            rows.matrix.mul_transposed_abs_add(multipliers, &mut push_terms);
        }
        let passed_on = passed_on(data, answer, &push, &carried);
        Ok(Self { u: answer.at_rows.to_vec(), metric, led, push, push_terms, passed_on, carried })
    }
}

/// The forces of rows where they touch, on carried unknowns that have rows of their own without the forces of those.
fn passed_on(data: &Data, answer: Candidate, push: &[f64], carried: &[bool]) -> Vec<f64> {
    let mut left = push.to_vec();
    if !carried.contains(&true) {
        return left;
    }
    for kind in RowKind::ALL {
        let (rows, forces) = (data.rows(kind), answer.forces(kind));
        for i in (0..rows.len()).filter(|i| forces[*i] != 0.0) {
            let mut entries = rows.matrix.row(i);
            if let (Some((j, b)), None) = (entries.next(), entries.next()) {
                if carried[j] {
                    left[j] -= b * forces[i];
                }
            }
        }
    }
    left
}
