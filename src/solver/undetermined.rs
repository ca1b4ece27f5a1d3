//! What an answer leaves undetermined: rigid motions that no closed row and no equality row resists and on which the load
//! does no work; equality rows that depend on each other and share their forces.

use crate::constraints::RowKind;
use crate::dual::dependent_rows;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector;
use crate::linalg::Csr;
use crate::platform::memory::zeros;
use crate::qp::AnswerFace;
use crate::solve::local::{Scale, Sizes};
use crate::solve::{without_force, Case};
use crate::solver::findings::rigid_motion;
use crate::solver::problem::Problem;

/// One undetermined motion.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenMotion {
    /// Over all unknowns, largest entry 1.
    pub v: Vec<f64>,
    /// The body that moves fastest; none if another rank has it.
    pub body: Option<usize>,
    /// v on this body, if it has coordinates: velocity of the origin (length) and rotation about the axes.
    pub motion: Option<[f64; 6]>,
}

impl Problem {
    /// Motion k of the motions that the last answer leaves undetermined.
    pub fn open_motion(&mut self, k: usize) -> Result<OpenMotion> {
        if let Some(motion) = self.open_motion_together(k)? {
            return Ok(motion);
        }
        if self.current().is_none_or(|current| current.open_motions.is_none()) {
            let found = Some(self.find_open_motions()?);
            self.history.current.iter_mut().for_each(|current| current.open_motions.clone_from(&found));
        }
        let all = self.current().and_then(|current| current.open_motions.as_deref()).unwrap_or_default();
        let Some((island, amplitudes)) = all.get(k) else {
            let what = format!("{} motions are undetermined", all.len());
            return Err(Error::argument("k", what).index(k as i64).limit(all.len() as f64));
        };
        let ready = &self.prepared.done(&self.model)?.islands[*island];
        let case = Case { model: self.solved(), prepared: &self.prepared, ready, method: None };
        let own = case.rigid_motion(amplitudes)?;
        let mut v = zeros(self.solved().sizes().dofs, "an open motion")?;
        ready.island.scatter(self.solved(), own, &mut v);
        if let Some(parts) = self.parts() {
            v = parts.mean(&v)?;
        }
        let fastest = vector::fastest(&v);
        let largest = v.get(fastest).copied().unwrap_or(1.0);
        v.iter_mut().for_each(|v| *v /= largest);
        let body = self.model.offsets[1..].partition_point(|end| *end <= fastest);
        Ok(OpenMotion { motion: rigid_motion(&self.model, body, &v), body: Some(body), v })
    }

    /// Motion k on one body.
    pub fn open_motion_of(&mut self, k: usize, body: usize) -> Result<Vec<f64>> {
        self.model.given(body)?;
        let range = self.model.range(body);
        Ok(self.open_motion(k)?.v[range].to_vec())
    }

    /// Islands and amplitudes of the motions, over the modes of the island.
    fn find_open_motions(&self) -> Result<Vec<(usize, Vec<f64>)>> {
        let missing = || Error::new(Kind::State, "there is no answer yet: solve first");
        let answer = &self.current().ok_or_else(missing)?.answer;
        let mut all = Vec::new();
        let islands = self.prepared.done(&self.model)?.islands.iter().zip(&answer.cleaned).enumerate();
        for (k, (ready, cleaned)) in islands.filter(|(k, _)| !answer.failed[*k]) {
            let lambda = ready.island.contact.gather(&answer.lambda);
            let mu = ready.island.equalities.gather(&answer.mu);
            let tangential = ready.island.friction.tangential.gather(&answer.tangential);
            let dual = &ready.dual;
            let coarse = cleaned.as_deref().unwrap_or(&dual.coarse);
            let case = Case { model: self.solved(), prepared: &self.prepared, ready, method: None };
            let (bodies, touched) = (case.locals()?, &ready.island.touched);
            let (_, scaled) = bodies.make(|_| Scale, &case.loads()?)?;
            let sizes =
                |push: &[f64]| bodies.ask(|p| Sizes { push: push[touched.range(p)].to_vec() }, &scaled);
            let held = without_force(ready, coarse, &sizes, [&lambda, &mu, &tangential])?;
            let motions = AnswerFace::new(coarse, &dual.blocks, &held, dual.rounding())?.undetermined()?;
            all.extend((0..motions.cols).map(|j| (k, motions.col(j).to_vec())));
        }
        Ok(all)
    }

    /// Equality rows that are combinations of others: they add no constraint, and the distribution of forces among them
    /// is undetermined.
    pub fn dependent_equalities(&mut self) -> Result<Vec<usize>> {
        if let Some(rows) = self.dependent_together()? {
            return Ok(rows);
        }
        let missing = || Error::new(Kind::State, "the problem has not been set up yet");
        let mut dependent = Vec::new();
        for ready in &self.prepared.duals(&self.model).ok_or_else(missing)?.islands {
            let groups: Vec<usize> = (0..ready.rows.groups())
                .filter(|&group| ready.rows.kind(group) == RowKind::Equality)
                .collect();
            let mut rows = Csr::empty(ready.rows.scaled.cols);
            for &group in &groups {
                rows.push_row(
                    ready.rows.scaled.row(group).map(|(j, v)| (j, v / ready.rows.metric[j].sqrt())),
                );
            }
            let compliance: Vec<f64> = groups.iter().map(|&group| ready.dual.compliance[group]).collect();
            let found = dependent_rows(&rows.transposed()?, &compliance)?.into_iter();
            let leader = |at: usize| ready.rows.scaling.grouping.leaders[groups[at]] - ready.rows.contact;
            dependent.extend(found.map(|at| ready.island.equalities.numbers[leader(at)]));
        }
        dependent.retain(|row| *row < self.model.equalities.len());
        dependent.sort_unstable();
        Ok(dependent)
    }
}
