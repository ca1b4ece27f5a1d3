//! Motions of an answer that keep its closed rows closed: whether the energy falls along them, and how far open rows
//! allow them.

use crate::body::Distributed;
use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{weighted_norm, NOISE};
use crate::linalg::Csr;
use crate::numbers::solve::{CLOSED_MOVES, STILL};
use crate::solve::diagnosis::resistance;
use crate::solve::gaps::Gaps;
use crate::solve::local::{Energy, Negate, Slide};
use crate::solve::recovery::Recovery;

/// `v = R alpha - K+ B'x`, x on the rows F alone.
pub struct Sliding {
    /// Length.
    pub v: Distributed,
    x: Vec<f64>,
    pub alpha: Vec<f64>,
    /// The largest entry of v.
    fastest: f64,
    length: f64,
    /// `v'K v` in units of 2^p, the sum of the sizes of its terms, and the same of the terms of its entries.
    stored: Twofold,
    terms: f64,
    entries: f64,
}

impl Sliding {
    pub fn of(recovery: &Recovery, x: Vec<f64>, alpha: Vec<f64>) -> Result<Self> {
        let (bodies, touched) = (&recovery.data.bodies, recovery.data.touched);
        let forces = recovery.ready.without_forces(&x, vec![0.0; touched.len()]);
        let slide =
            |p: usize| Slide { at_rows: recovery.of_rows(p, &forces), a: recovery.of_modes(p, &alpha) };
        let v = Distributed::new(bodies.make(slide, ())?);
        let (mut stored, mut terms, mut entries) = (Twofold::default(), 0.0, 0.0);
        let (mut lengths, mut fastest) = (Vec::new(), 0.0f64);
        for of in bodies.ask(|_| Energy, &v.of)? {
            stored.add_twofold(of.stored);
            (terms, entries) = (terms + of.terms, entries + of.entries);
            lengths.push(of.length);
            fastest = fastest.max(of.fastest);
        }
        let length = weighted_norm(&lengths, |_| 1.0);
        Ok(Self { v, x, alpha, fastest, length, stored, terms, entries })
    }

    /// Reverses the motion.
    pub fn turn(&mut self, recovery: &Recovery) -> Result<()> {
        recovery.data.bodies.change(|_| Negate, &mut self.v.of, ())?;
        for part in [&mut self.v.at_rows, &mut self.x, &mut self.alpha] {
            part.iter_mut().for_each(|v| *v = -*v);
        }
        Ok(())
    }

    /// Friction does not resist v: on rows with a force x that follows from normal forces (`held`), v goes along this force.
    pub fn slips_on(&self, recovery: &Recovery, x: &[f64], held: &[bool]) -> bool {
        let rows = &recovery.ready.rows.matrix;
        let slips = (0..rows.rows()).filter(|&i| held[i] && x[i] != 0.0);
        slips
            .into_iter()
            .all(|i| x[i].signum() * rows.row_dot(i, &self.v.at_rows) >= -STILL * self.size(rows, i))
    }

    /// `v'K v < 0` by the matrices of the host, by more than the rounding of their entries, and no forces within the cones of the rows
    /// resist v.
    pub fn falls_beside_forces(&self, recovery: &Recovery) -> bool {
        let falls = self.stored.value() < -NOISE * self.entries;
        falls && resistance(recovery.ready, &self.v.at_rows) <= CLOSED_MOVES * self.length
    }

    /// `v'K v + x'C x <= 0` up to rounding by the matrices of the host, and by more than the energy from the motion of the rows F:
    /// without resistance the load alone decides how far the motion goes.
    pub fn falls(&self, recovery: &Recovery, held: &[bool]) -> bool {
        let rows = &recovery.ready.rows;
        let (mut energy, mut moved) = (self.stored, 0.0);
        for i in (0..rows.groups()).filter(|&i| !held[i]) {
            let (given, compliance) =
                (rows.matrix.row_dot(i, &self.v.at_rows), recovery.ready.dual.compliance[i]);
            let left = (given - compliance * self.x[i]).abs();
            if left > CLOSED_MOVES * self.size(&rows.matrix, i) {
                return false;
            }
            energy.add_product(self.x[i], compliance * self.x[i]);
            moved += left * self.x[i].abs();
        }
        energy.value() < NOISE * self.terms - 2.0 * moved
    }

    /// u where rows touch: the largest t for which `u + sense t v` violates no row marked in `held`; infinite if no such row stops the motion.
    pub fn reach(&self, recovery: &Recovery, u: &[f64], held: &[bool], sense: f64) -> f64 {
        let (rows, Gaps { value: gaps, bounded, .. }) = (&recovery.ready.rows.scaled, &recovery.scaled.gaps);
        let mut reach = f64::INFINITY;
        for i in (0..rows.rows()).filter(|&i| held[i] && bounded[i]) {
            let closing = sense * rows.row_dot(i, &self.v.at_rows);
            if closing > STILL * self.size(rows, i) {
                reach = reach.min((gaps[i] - rows.row_dot(i, u)).max(0.0) / closing);
            }
        }
        reach
    }

    /// The largest motion that the row could have.
    fn size(&self, rows: &Csr, i: usize) -> f64 {
        self.fastest * rows.row(i).map(|(_, b)| b.abs()).sum::<f64>()
    }
}
