//! Displacements that loads and forces of rows cause through K+, to find how much of an answer's error rounding of the
//! loads explains.

use std::cell::Cell;

use crate::certificate::{Data, Response};
use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::vector::dot;
use crate::platform::memory::zeros;
use crate::setup::Ready;

/// K+ of all bodies.
pub struct ByInverse<'a> {
    pub data: &'a Data<'a>,
    pub ready: &'a Ready,
    pub threads: usize,
    /// V of these loads, force x length, if already computed.
    pub work: &'a Cell<Option<f64>>,
}

impl Response for ByInverse<'_> {
    fn work_of_loads(&mut self) -> Result<f64> {
        if let Some(work) = self.work.get() {
            return Ok(work);
        }
        let mut load = zeros(self.unknowns(), "the work of the loads")?;
        for body in &self.data.bodies {
            let free = &mut load[body.range()];
            free.copy_from_slice(body.load.unwrap_or(&vec![0.0; free.len()]));
            body.grounded.iter().for_each(|j| free[*j as usize] = 0.0);
        }
        let work = self.work_of(load)?;
        self.work.set(Some(work));
        Ok(work)
    }

    fn compliance_of(&mut self, kind: RowKind, row: usize) -> Result<f64> {
        let rows = self.data.rows(kind);
        let mut force = zeros(self.unknowns(), "the force of a row")?;
        rows.matrix.row(row).for_each(|(j, b)| force[j] = b);
        self.work_of(force)
    }
}

impl ByInverse<'_> {
    fn unknowns(&self) -> usize {
        self.data.bodies.last().map_or(0, |body| body.start + body.stiffness.order())
    }

    /// `sum_p (g'v)^2 / v'K v` of the self-equilibrated part `g = f - D R R'f / unit` of a load f, n. For any motion v
    /// this is at most `g'K+ g`, the work of the load on the body alone: v = K+ g makes it large, and an inexact K+
    /// cannot make it too large.
    fn work_of(&self, mut load: Vec<f64>) -> Result<f64> {
        let (metric, unit) = (&self.ready.rows.metric, self.ready.island.unit);
        for body in &self.data.bodies {
            let range = body.range();
            let resultants = body.null_space.mul_transposed(&load[range.clone()]);
            let mut rigid = zeros(range.len(), "the work of a load")?;
            body.null_space.mul_add(1.0 / body.unit, &resultants, &mut rigid);
            range.for_each(|j| load[j] -= unit * metric[j] * rigid[j - body.start]);
        }
        let motion = self.ready.displacement(self.threads, &load)?;
        let mut work = 0.0;
        for body in &self.data.bodies {
            let range = body.range();
            let (g, v) = (&load[range.clone()], &motion[range.clone()]);
            let mut strain = zeros(range.len(), "the work of a load")?;
            body.stiffness.mul(v, &mut strain)?;
            let (done, stored) = (dot(g, v), dot(v, &strain));
            work += if stored > 0.0 { done * (done / stored) } else { 0.0 };
        }
        Ok(work)
    }
}
