//! Motions of an answer that keep its closed rows closed: whether the energy falls along them, and how far open rows
//! allow them.

use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{axpy, norm_max, weighted_norm, NOISE};
use crate::linalg::Csr;
use crate::numbers::solve::{CLOSED_MOVES, STILL};
use crate::platform::memory::{filled, zeros};
use crate::solve::diagnosis::resistance;
use crate::solve::gaps::Gaps;
use crate::solve::recovery::Recovery;

const WHAT: &str = "a motion along closed rows";

/// `v = R alpha - K+ B'x`, x on the rows F alone.
pub struct Sliding {
    /// Over the unknowns of the island, length.
    pub v: Vec<f64>,
    x: Vec<f64>,
    pub alpha: Vec<f64>,
}

impl Sliding {
    pub fn of(recovery: &Recovery, x: Vec<f64>, alpha: Vec<f64>) -> Result<Self> {
        let mut forces = zeros(recovery.scaled.load.len(), WHAT)?;
        recovery.ready.rows.take_forces(&x, &mut forces);
        let mut v = recovery.inverse(&forces)?;
        axpy(1.0, &recovery.ready.dual.rigid_motion(&alpha, v.len()), &mut v);
        Ok(Self { v, x, alpha })
    }

    /// Reverses the motion.
    pub fn turn(&mut self) {
        for part in [&mut self.v, &mut self.x, &mut self.alpha] {
            part.iter_mut().for_each(|v| *v = -*v);
        }
    }

    /// Friction does not resist v: on rows with a force x that follows from normal forces (`held`), v goes along this force.
    pub fn slips_on(&self, recovery: &Recovery, x: &[f64], held: &[bool]) -> bool {
        let rows = &recovery.ready.rows.matrix;
        let slips = (0..rows.rows()).filter(|&i| held[i] && x[i] != 0.0);
        slips.into_iter().all(|i| x[i].signum() * rows.row_dot(i, &self.v) >= -STILL * self.size(rows, i))
    }

    /// `v'K v < 0` by the matrices of the host, by more than the rounding of their entries, and no forces within the cones of the rows
    /// resist v.
    pub fn falls_beside_forces(&self, recovery: &Recovery) -> Result<bool> {
        let unit = recovery.ready.island.unit;
        let mut entries = 0.0;
        for body in &recovery.data.bodies {
            let v = &self.v[body.range()];
            let (mut image, mut terms) = (zeros(v.len(), WHAT)?, zeros(v.len(), WHAT)?);
            body.stiffness.mul_with_terms(v, &mut image, &mut terms)?;
            entries += v.iter().zip(terms).map(|(v, terms)| v.abs() * terms / unit).sum::<f64>();
        }
        let size = weighted_norm(&self.v, |j| recovery.ready.rows.metric[j]);
        let falls = self.energy(recovery)?.0.value() < -NOISE * entries;
        Ok(falls && resistance(recovery.ready, &self.v) <= CLOSED_MOVES * size)
    }

    /// `v'K v` and the size of its terms, in units of 2^p.
    fn energy(&self, recovery: &Recovery) -> Result<(Twofold, f64)> {
        let unit = recovery.ready.island.unit;
        let mut image = filled(self.v.len(), Twofold::default(), WHAT)?;
        for body in &recovery.data.bodies {
            body.stiffness.add_twofold(1.0 / unit, &self.v[body.range()], &mut image[body.range()])?;
        }
        let (mut energy, mut terms) = (Twofold::default(), 0.0);
        for (v, image) in self.v.iter().zip(image) {
            energy.add_product(*v, image.value());
            terms += (v * image.value()).abs();
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
            let (given, compliance) = (rows.matrix.row_dot(i, &self.v), recovery.ready.dual.compliance[i]);
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
    pub fn reach(&self, recovery: &Recovery, u: &[f64], held: &[bool], sense: f64) -> f64 {
        let (rows, Gaps { value: gaps, bounded, .. }) = (&recovery.ready.rows.scaled, &recovery.scaled.gaps);
        let mut reach = f64::INFINITY;
        for i in (0..rows.rows()).filter(|&i| held[i] && bounded[i]) {
            let closing = sense * rows.row_dot(i, &self.v);
            if closing > STILL * self.size(rows, i) {
                reach = reach.min((gaps[i] - rows.row_dot(i, u)).max(0.0) / closing);
            }
        }
        reach
    }
    /// The largest motion that the row could have.
    fn size(&self, rows: &Csr, i: usize) -> f64 {
        norm_max(&self.v) * rows.row(i).map(|(_, b)| b.abs()).sum::<f64>()
    }
}
