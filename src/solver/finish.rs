//! Option `finish`: after a solve, the dual is solved directly on the active set found, and the whole answer is
//! corrected by the residuals of the host's own data, as long as its certificate improves.

use crate::certificate::Certificate;
use crate::error::Result;
use crate::linalg::vector::axpy;
use crate::qp::{settle, Direct, Qp, Settled, Solution, Verdict};
use crate::solver::solve::{Certifier, Ending};

/// Corrections at most.
const CORRECTIONS: usize = 4;

/// True where `ending` was replaced by an answer with a better certificate. Ended by the host or the time, it
/// leaves what there was: that is solved.
pub(super) fn finish(judge: &Certifier, qp: Qp, direct: Direct, ending: &mut Ending) -> Result<bool> {
    if ending.solution.verdict != Verdict::Solved {
        return Ok(false);
    }
    let attempt = settle(qp, direct, &ending.solution)?;
    ending.solution.counts = ending.solution.counts + attempt.counts;
    let Some(settled) = attempt.settled else { return Ok(false) };
    improve(judge, &settled, ending)
}

/// The settled point or one of its corrections in place of `ending`: the one with the best certificate.
fn improve(judge: &Certifier, settled: &Settled, ending: &mut Ending) -> Result<bool> {
    let (x, alpha) = (settled.x.clone(), settled.alpha.clone());
    let u = judge.displacement(&x, &alpha)?;
    let mut point = Point { u, x, alpha };
    let mut replaced = false;
    for _ in 0..=CORRECTIONS {
        let recovered = judge.with_forces(point.u.clone(), &point.x);
        let judgement = judge.judged(&recovered)?;
        let better = judgement.certificate.passed()
            && is_better(&judgement.certificate, &ending.judgement.certificate);
        if better {
            let Point { x, alpha, .. } = point.clone();
            let undetermined = settled.undetermined;
            let solution = Solution { x, alpha, undetermined, ..ending.solution.clone() };
            *ending = Ending { solution, recovered, judgement };
            replaced = true;
        }
        point.correct(judge, settled)?;
    }
    Ok(replaced)
}

/// The worst entry is smaller, or as good and the others together are: what no correction mends, balance where the null space
/// is not exact, does not choose among them.
fn is_better(new: &Certificate, old: &Certificate) -> bool {
    const AS_GOOD: f64 = 0.1;
    let others = |of: &Certificate| of.entries().iter().map(|entry| entry.ratio).sum::<f64>() - of.worst();
    let (worst, before) = (new.worst(), old.worst());
    worst < (1.0 - AS_GOOD) * before || worst <= (1.0 + AS_GOOD) * before && others(new) < others(old)
}

/// u with the forces and amplitudes that belong to it.
#[derive(Clone)]
struct Point {
    u: Vec<f64>,
    x: Vec<f64>,
    alpha: Vec<f64>,
}

impl Point {
    /// Solves (10)-(11) on the face for the loads and gaps that are left, `f - K u - B'x` and `c + C x - B u`: errors of
    /// F and of K+ fall with every correction.
    fn correct(&mut self, judge: &Certifier, settled: &Settled) -> Result<()> {
        let (dual, face) = (&judge.ready.dual, &settled.face);
        let mut load = self.load_left(judge)?;
        let rows = &judge.ready.rows;
        let value = judge.scaled.gaps.value.iter().enumerate();
        let left = value.map(|(i, gap)| gap - rows.scaled.row_dot(i, &self.u)).collect();
        let left = rows.decoupling.solve(left);
        let mut gaps = vec![0.0; self.x.len()];
        face.rows().iter().for_each(|&i| gaps[i] = left[i] + rows.compliance[i] * self.x[i]);
        let d = dual.rhs(&judge.ready.moved(judge.threads, &load)?, &gaps);
        let force = face.rows().iter().map(|&i| d[i]).collect();
        let (step, turn) = face.solve(force, &dual.resultants(&load))?;
        let mut forces = vec![0.0; self.x.len()];
        face.rows().iter().zip(step).for_each(|(&i, step)| forces[i] = step);
        rows.take_forces(&forces, &mut load);
        axpy(1.0, &judge.ready.displacement(judge.threads, &load, &turn)?, &mut self.u);
        axpy(1.0, &forces, &mut self.x);
        // what rounding has made of a force that is zero
        let bounded = self.x.iter_mut().zip(&judge.scaled.gaps.bounded).filter(|(_, bounded)| **bounded);
        bounded.for_each(|(x, _)| *x = x.max(0.0));
        axpy(1.0, &turn, &mut self.alpha);
        Ok(())
    }

    /// `f - K u - B'x` in units of 2^p.
    fn load_left(&self, judge: &Certifier) -> Result<Vec<f64>> {
        let mut load = judge.scaled.load.clone();
        for body in &judge.data.bodies {
            let range = body.start..body.start + body.stiffness.order();
            let mut strain = vec![0.0; range.len()];
            body.stiffness.mul(&self.u[range.clone()], &mut strain)?;
            axpy(-1.0 / judge.ready.island.unit, &strain, &mut load[range]);
        }
        judge.ready.rows.take_forces(&self.x, &mut load);
        Ok(load)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::qp::Face;
    use crate::solver::solve::tests::two_springs;

    #[test]
    fn a_wrong_active_set_is_never_accepted_and_the_right_one_is() {
        // springs 1 and 1 pushed by 3 and 1 against walls at 1 and 2: only the first touches, lambda = 2
        two_springs(1e-6, |judge, qp, direct, solved| {
            for (rows, right) in [(vec![0], true), (vec![], false), (vec![1], false), (vec![0, 1], false)] {
                let mut ending = judge.ending(solved.clone()).unwrap();
                let before = ending.judgement.certificate.worst();
                let face = Face::new(qp, direct.entries, rows.clone()).unwrap().unwrap();
                let mut x = vec![0.0; 2];
                let (on_face, alpha) = face.solve(rows.iter().map(|&i| qp.b[i]).collect(), qp.e).unwrap();
                rows.iter().zip(on_face).for_each(|(&i, v)| x[i] = v);
                let settled = Settled { x, alpha, undetermined: 0, face };
                assert_eq!(improve(judge, &settled, &mut ending).unwrap(), right, "{rows:?}");
                assert_eq!(ending.judgement.certificate.worst() < before, right, "{rows:?}");
                assert!(ending.judgement.certificate.passed());
            }
        });
    }

    #[test]
    fn a_force_that_rounding_has_made_negative_is_none() {
        two_springs(0.0, |judge, qp, direct, solved| {
            let face = Face::new(qp, direct.entries, vec![0]).unwrap().unwrap();
            let settled = Settled { x: solved.x.clone(), alpha: vec![], undetermined: 0, face };
            let x = vec![2.0, -1e-20];
            let u = judge.displacement(&x, &[]).unwrap();
            let mut point = Point { u, x, alpha: vec![] };
            point.correct(judge, &settled).unwrap();
            assert_eq!(point.x, [2.0, 0.0]);
        });
    }
}
