//! Motions of an answer that keep its closed rows closed: whether the energy falls along them, and how far open rows
//! allow them.

use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{norm_max, NOISE};
use crate::linalg::{ByBody, Csr};
use crate::numbers::solve::{CLOSED_MOVES, STILL};
use crate::platform::memory::{filled, zeros};
use crate::solve::diagnosis::resistance;
use crate::solve::gaps::Gaps;
use crate::solve::recovery::Recovery;

const WHAT: &str = "a motion along closed rows";

/// `v = R alpha - K+ B'x`, x on the rows F alone.
pub struct Sliding {
    /// Length.
    pub v: ByBody,
    /// The same where rows touch.
    at: Vec<f64>,
    x: Vec<f64>,
    pub alpha: Vec<f64>,
}

impl Sliding {
    pub fn of(recovery: &Recovery, x: Vec<f64>, alpha: Vec<f64>) -> Result<Self> {
        let ready = recovery.ready;
        let mut forces = ByBody::zeros(&ready.island.ranges, WHAT)?;
        ready.take_forces(&x, &mut forces);
        let mut v = recovery.inverse(&forces)?;
        v.add(1.0, &ready.rigid_motion(&alpha));
        Ok(Self { at: ready.island.touched.at(&v), v, x, alpha })
    }

    /// Reverses the motion.
    pub fn turn(&mut self) {
        self.v.change(|v| *v = -*v);
        for part in [&mut self.at, &mut self.x, &mut self.alpha] {
            part.iter_mut().for_each(|v| *v = -*v);
        }
    }

    /// Friction does not resist v: on rows with a force x that follows from normal forces (`held`), v goes along this force.
    pub fn slips_on(&self, recovery: &Recovery, x: &[f64], held: &[bool]) -> bool {
        let rows = &recovery.ready.rows.matrix;
        let slips = (0..rows.rows()).filter(|&i| held[i] && x[i] != 0.0);
        slips.into_iter().all(|i| x[i].signum() * rows.row_dot(i, &self.at) >= -STILL * self.size(rows, i))
    }

    /// `v'K v < 0` by the matrices of the host, by more than the rounding of their entries, and no forces within the cones of the rows
    /// resist v.
    pub fn falls_beside_forces(&self, recovery: &Recovery) -> Result<bool> {
        let unit = recovery.ready.island.unit;
        let mut entries = 0.0;
        for (body, v) in recovery.data.bodies.iter().zip(self.v.each()) {
            let (mut image, mut terms) = (zeros(v.len(), WHAT)?, zeros(v.len(), WHAT)?);
            body.stiffness.mul_with_terms(v, &mut image, &mut terms)?;
            entries += v.iter().zip(terms).map(|(v, terms)| v.abs() * terms / unit).sum::<f64>();
        }
        let size = recovery.ready.length_of_all(&self.v);
        let falls = self.energy(recovery)?.0.value() < -NOISE * entries;
        Ok(falls && resistance(recovery.ready, &self.at) <= CLOSED_MOVES * size)
    }

    /// `v'K v` and the size of its terms, in units of 2^p.
    fn energy(&self, recovery: &Recovery) -> Result<(Twofold, f64)> {
        let unit = recovery.ready.island.unit;
        let (mut energy, mut terms) = (Twofold::default(), 0.0);
        for (body, v) in recovery.data.bodies.iter().zip(self.v.each()) {
            let mut image = filled(v.len(), Twofold::default(), WHAT)?;
            body.stiffness.add_twofold(1.0 / unit, v, &mut image)?;
            for (v, image) in v.iter().zip(image) {
                energy.add_product(*v, image.value());
                terms += (v * image.value()).abs();
            }
        }
        Ok((energy, terms))
    }

    /// `v'K v + x'C x <= 0` up to rounding by the matrices of the host, and by more than the energy from the motion of the rows F:
    /// without resistance the load alone decides how far the motion goes.
    pub fn falls(&self, recovery: &Recovery, held: &[bool]) -> Result<bool> {
        let rows = &recovery.ready.rows;
        let (mut energy, terms) = self.energy(recovery)?;
        let mut moved = 0.0;
        for i in (0..rows.groups()).filter(|&i| !held[i]) {
            let (given, compliance) = (rows.matrix.row_dot(i, &self.at), recovery.ready.dual.compliance[i]);
            let left = (given - compliance * self.x[i]).abs();
            if left > CLOSED_MOVES * self.size(&rows.matrix, i) {
                return Ok(false);
            }
            energy.add_product(self.x[i], compliance * self.x[i]);
            moved += left * self.x[i].abs();
        }
        Ok(energy.value() < NOISE * terms - 2.0 * moved)
    }

    /// The largest t for which `u + sense t v` violates no row marked in `held`; infinite if no such row stops the motion.
    pub fn reach(&self, recovery: &Recovery, u: &ByBody, held: &[bool], sense: f64) -> f64 {
        let (rows, Gaps { value: gaps, bounded, .. }) = (&recovery.ready.rows.scaled, &recovery.scaled.gaps);
        let (u, mut reach) = (recovery.data.touched.at(u), f64::INFINITY);
        for i in (0..rows.rows()).filter(|&i| held[i] && bounded[i]) {
            let closing = sense * rows.row_dot(i, &self.at);
            if closing > STILL * self.size(rows, i) {
                reach = reach.min((gaps[i] - rows.row_dot(i, &u)).max(0.0) / closing);
            }
        }
        reach
    }

    /// The largest motion that the row could have.
    fn size(&self, rows: &Csr, i: usize) -> f64 {
        self.v.each().map(norm_max).fold(0.0, f64::max) * rows.row(i).map(|(_, b)| b.abs()).sum::<f64>()
    }
}
