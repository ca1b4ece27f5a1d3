//! If the forces of an answer leave motions free, the library returns the answer of least travel.

use std::sync::Arc;

use crate::body::Kept;
use crate::constraints::RowKind;
use crate::error::{Kind, Result};
use crate::linalg::Matrix;
use crate::platform::interrupt;
use crate::qp::{AnswerFace, Solution, Verdict};
use crate::solve::held::without_force;
use crate::solve::local::Sizes;
use crate::solve::recovery::{Ending, Recovered, Recovery};
use crate::solve::travel::{travel, OpenMotions, Rest};

/// The answer of least travel.
struct AtRest {
    recovered: Recovered,
    alpha: Vec<f64>,
    /// Number of the motions that no row holds.
    undetermined: usize,
}

impl<'a> Recovery<'a> {
    /// Replaces the answer by that of least travel among the answers that differ by motions which nothing resists, unless
    /// only the original answer passes: a far way has spoilt the other, which is returned. If the host or the time limit stops it, the
    /// answer is unchanged and the verdict names the reason.
    pub fn bring_to_rest(&self, ending: &mut Ending) -> Result<Option<Ending>> {
        let rest = match self.judged_at_rest(ending) {
            Ok(Some(rest)) => rest,
            Ok(None) => return Ok(None),
            Err(error) => {
                ending.solution.verdict = Verdict::of_refusal(error)?;
                return Ok(None);
            }
        };
        if ending.judgement.certificate.passed() && !rest.judgement.certificate.passed() {
            return Ok(Some(rest));
        }
        let x = std::mem::take(&mut ending.solution.x);
        *ending = Ending { solution: Solution { x, ..rest.solution }, ..rest };
        Ok(None)
    }

    /// The answer of least travel, x without forces that are rounding; none if all motions are held by others.
    fn judged_at_rest(&self, ending: &Ending) -> Result<Option<Ending>> {
        if self.friction {
            return Ok(None);
        }
        let held = self.without_force(&ending.recovered)?;
        let (mut members, lambda) = (self.ready.rows.scaling.grouping.members(), &ending.recovered.lambda);
        let is_rounding =
            members.any(|(i, (group, _))| held[group] && lambda.get(i).is_some_and(|force| *force > 0.0));
        if ending.solution.undetermined == 0 && !is_rounding {
            return Ok(None);
        }
        let Some(AtRest { recovered, alpha, undetermined }) = self.at_rest(&held, ending)? else {
            return Ok(None);
        };
        let judgement = self.judged(&recovered)?;
        let mut solution = Solution { alpha, undetermined, ..ending.solution.clone() };
        solution.x.iter_mut().zip(&held).filter(|(_, held)| **held).for_each(|(x, _)| *x = 0.0);
        Ok(Some(Ending { solution, deformed: ending.deformed.clone(), recovered, judgement }))
    }

    /// Rows of the dual whose forces hold nothing.
    pub fn without_force(&self, answer: &Recovered) -> Result<Vec<bool>> {
        let forces = RowKind::ALL.map(|kind| answer.view().forces(kind));
        let sizes = |push: &[f64]| {
            let sizes = |p: usize| Sizes { push: self.of_rows(p, push) };
            self.data.bodies.ask(sizes, &self.scaled.load.of)
        };
        without_force(self.ready, self.faces.qp.g_transposed, &sizes, forces)
    }

    /// The answer of least travel, with rows without force `held`; none if rows resist every motion. The distance
    /// that the method has travelled has no influence, not even through rounding.
    fn at_rest(&self, held: &[bool], ending: &Ending) -> Result<Option<AtRest>> {
        let Ending { solution, deformed, recovered: answer, .. } = ending;
        let (dual, x) = (&self.ready.dual, &solution.x[..]);
        let mut face = AnswerFace::of(&self.faces.qp, held)?;
        let free = face.undetermined()?;
        if free.cols == 0 {
            return Ok(None);
        }
        let undetermined = free.cols;
        let mut open = self.gaps_left(&[&deformed.at_rows], &[x]);
        // (F x)_s = x_s on the springs of bodies
        let springs = open.len() - dual.springs..;
        open[springs.clone()].copy_from_slice(&x[springs]);
        let mut alpha = dual.balanced(x, &face.fitted(&open)?);
        let mut forces = answer.lambda.clone();
        for (i, member) in self.ready.rows.scaling.grouping.member[..forces.len()].iter().enumerate() {
            if member.is_some_and(|(group, _)| held[group]) {
                forces[i] = 0.0;
            }
        }
        let way = interrupt::part("least travel", || {
            self.way_to_rest((&deformed.of, dual.amplitudes(&alpha)), &forces, free)
        })?;
        let Some(Rest { u, amplitudes }) = way else { return Ok(None) };
        for k in 0..self.data.bodies.len() {
            dual.modes_of(k).for_each(|mode| alpha[mode] = dual.size_of(k) * amplitudes[mode]);
        }
        Ok(Some(AtRest { recovered: Recovered { u: Arc::new(u), ..answer.clone() }, alpha, undetermined }))
    }

    /// The place of least travel along the free motions; none if rounding leaves no such place.
    fn way_to_rest(
        &self,
        (deformed, amplitudes): (&Kept, Vec<f64>),
        lambda: &[f64],
        mut free: Matrix,
    ) -> Result<Option<Rest>> {
        let dual = &self.ready.dual;
        for j in 0..free.cols {
            let own = dual.amplitudes(free.col(j));
            free.col_mut(j).copy_from_slice(&own);
        }
        let contact = self.data.contact;
        let open = OpenMotions {
            bodies: &self.data.bodies,
            modes: &(0..dual.bodies()).map(|p| dual.modes_of(p)).collect::<Vec<_>>(),
            rounding: dual.rounding(),
            amplitudes: &free,
            touched: self.data.touched,
            rows: &contact.matrix,
            gaps: &contact.rhs,
            compliance: &contact.compliance,
            lambda,
        };
        match travel(&open, deformed, amplitudes) {
            Err(error) if matches!(error.kind, Kind::Cancelled | Kind::TimeOver | Kind::Callback) => {
                Err(error)
            }
            way => Ok(way.ok()),
        }
    }
}
