//! What an answer leaves open: rigid motions that no closed row and no equality resists, and on which the load does no
//! work; equality rows that depend on each other and share their forces.

use std::ops::Range;

use crate::dual::dependent_rows;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::weighted_norm;
use crate::linalg::Csr;
use crate::platform::memory::zeros;
use crate::qp;
use crate::solver::problem::Problem;
use crate::solver::setup::Ready;
use crate::solver::RowKind;

/// One of them.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenMotion {
    /// Over all unknowns, largest entry 1.
    pub v: Vec<f64>,
    /// The body that moves fastest.
    pub body: usize,
    /// v on this body, where it has coordinates: velocity of the origin (length) and rotation about the axes.
    pub motion: Option<[f64; 6]>,
}

impl Problem {
    /// Motion k of those that the last answer leaves open.
    pub fn open_motion(&mut self, k: usize) -> Result<OpenMotion> {
        if self.asked.open_motions.is_none() {
            self.asked.open_motions = Some(self.find_open_motions()?);
        }
        let all = self.asked.open_motions.as_deref().unwrap_or_default();
        let Some((island, amplitudes)) = all.get(k) else {
            let what = format!("{} motions are undetermined", all.len());
            return Err(Error::argument("k", what).index(k as i64).limit(all.len() as f64));
        };
        let ready = &self.ready()?.islands[*island];
        let own = ready.dual.rigid_motion(amplitudes, ready.island.unknowns());
        let mut v = zeros(self.counts().dofs, "an open motion")?;
        ready.island.scatter(self, &own, &mut v);
        let fastest = (0..v.len()).fold(0, |best, i| if v[i].abs() > v[best].abs() { i } else { best });
        let largest = v.get(fastest).copied().unwrap_or(1.0);
        v.iter_mut().for_each(|v| *v /= largest);
        let body = self.offsets[1..].partition_point(|end| *end <= fastest);
        Ok(OpenMotion { motion: self.rigid_motion(body, &v), body, v })
    }

    /// Motion k on one body.
    pub fn open_motion_of(&mut self, k: usize, body: usize) -> Result<Vec<f64>> {
        self.slot(body)?;
        let range = self.range(body);
        Ok(self.open_motion(k)?.v[range].to_vec())
    }

    /// Islands and amplitudes of the motions, over the modes of the island.
    fn find_open_motions(&self) -> Result<Vec<(usize, Vec<f64>)>> {
        let missing = || Error::new(Kind::State, "there is no answer yet: solve first");
        let answer = self.answer.as_ref().ok_or_else(missing)?;
        let mut all = Vec::new();
        let islands = self.ready()?.islands.iter().zip(&answer.failed).enumerate();
        for (k, (ready, _)) in islands.filter(|(_, (_, failed))| !**failed) {
            let lambda = ready.island.contact.gather(&answer.lambda);
            let mu = ready.island.equalities.gather(&answer.mu);
            let held = ready.without_force(&ready.island.loads(self)?, &lambda, &mu);
            let motions = qp::undetermined(&ready.dual.coarse, &held, ready.dual.rounding())?;
            all.extend((0..motions.cols).map(|j| (k, motions.col(j).to_vec())));
        }
        Ok(all)
    }
}

/// A force below this part of all forces on each of the bodies that its row touches is rounding, and holds no motion; ...
const ROUNDING: f64 = 1e-12;
/// ... on bodies without load, whose forces may be nothing but rounding of those of others, so is one below this part of all forces.
const IDLE: f64 = 64.0 * f64::EPSILON;

impl Ready {
    /// Groups of contact rows of which none carries a force, but for rounding; `load` is that of all unknowns, force.
    pub fn without_force(&self, load: &[f64], lambda: &[f64], mu: &[f64]) -> Vec<bool> {
        let (rows, island) = (&self.rows, &self.island);
        let mut push = vec![0.0; load.len()];
        island.contact.rows.matrix.mul_transposed_add(1.0, lambda, &mut push);
        island.equalities.rows.matrix.mul_transposed_add(1.0, mu, &mut push);
        let size = |v: &[f64], range: &Range<usize>| {
            weighted_norm(&v[range.clone()], |j| 1.0 / rows.metric[range.start + j])
        };
        let everywhere = size(load, &(0..load.len())).hypot(size(&push, &(0..load.len())));
        let nothing = |range: &Range<usize>| {
            let own = size(load, range);
            let idle = if own == 0.0 { IDLE * everywhere } else { 0.0 };
            (ROUNDING * (own + size(&push, range))).max(idle)
        };
        let nothing: Vec<f64> = island.ranges.iter().map(nothing).collect();
        let mut held: Vec<bool> =
            (0..rows.groups()).map(|group| rows.kind(group) == RowKind::Inequality).collect();
        for (i, (group, _)) in rows.grouping.members().filter(|(i, _)| *i < rows.contact) {
            let bodies = island.contact.rows.matrix.row(i).map(|(j, _)| nothing[island.body_of(j)]);
            if lambda[i] > rows.scale[i] * bodies.fold(f64::INFINITY, f64::min) {
                held[group] = false;
            }
        }
        held
    }
}

impl Problem {
    /// Equality rows that are combinations of others: they constrain nothing, and which of them carry the forces is open.
    pub fn dependent_equalities(&self) -> Result<Vec<usize>> {
        let missing = || Error::new(Kind::State, "the problem has not been set up yet");
        let mut dependent = Vec::new();
        for ready in &self.ready.as_ref().ok_or_else(missing)?.islands {
            let groups: Vec<usize> = (0..ready.rows.groups())
                .filter(|&group| ready.rows.kind(group) == RowKind::Equality)
                .collect();
            let mut rows = Csr::empty(ready.rows.scaled.cols);
            for &group in &groups {
                rows.push_row(
                    ready.rows.scaled.row(group).map(|(j, v)| (j, v / ready.rows.metric[j].sqrt())),
                );
            }
            let compliance: Vec<f64> = groups.iter().map(|&group| ready.rows.compliance[group]).collect();
            let found = dependent_rows(&rows.transposed()?, &compliance)?.into_iter();
            let leader = |at: usize| ready.rows.grouping.leaders[groups[at]] - ready.rows.contact;
            dependent.extend(found.map(|at| ready.island.equalities.numbers[leader(at)]));
        }
        dependent.sort_unstable();
        Ok(dependent)
    }
}
