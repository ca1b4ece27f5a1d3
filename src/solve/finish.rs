//! Option `finish`: after a solve, the residuals of the host's data correct forces and displacements together, each time
//! on the rows that these data show to be in contact, until only rounding is left.

use crate::certificate::{Certificate, NOISE};
use crate::error::{Kind, Result};
use crate::linalg::twofold::TwofoldVector;
use crate::linalg::vector::{axpy, weighted_norm};
use crate::model::{FinishBy, Method, Settings};
use crate::platform::interrupt;
use crate::qp::{Face, Verdict};
use crate::solve::feedback::{Feedback, NegativeMotions};
use crate::solve::gaps::Gaps;
use crate::solve::recovery::{Ending, Faces, Recovery};
use crate::solve::slides::FAR;
use crate::solve::sparse_face::{SparseFace, SparseFaces};

/// Limit of active sets.
const FACES: usize = 16;
/// Limit of corrections on one active set.
const CORRECTIONS: usize = 10;
/// Ratios of the certificate below this are rounding.
const ROUNDING: f64 = 1e-4;
/// A ratio below `MUCH_BETTER` times another is much better; below `NO_WORSE` times another it is no worse.
const MUCH_BETTER: f64 = 0.5;
const NO_WORSE: f64 = 1.1;

/// Errors may be large on bodies beside others that are deformed more by this factor.
const UNEVEN: f64 = 100.0;

/// Whether option `finish` asks for the finish of an island's answer. `automatic`: if an error that passes the
/// certificate may be large on some body. Not with friction: those answers already have exact forces for their states.
pub fn is_to_finish(settings: &Settings, recovery: &Recovery, ending: &Ending) -> bool {
    if recovery.friction {
        return false;
    }
    let default = settings.method == Method::Proportioning && settings.finish == FinishBy::Automatic;
    let overlooked = ending.judgement.unevenness > UNEVEN;
    settings.finish == FinishBy::Direct || default && (overlooked || is_delicate(recovery, ending))
}

/// The error of an answer may be much larger than its certificate: beside soft bodies, by rows that join uneven bodies, and where
/// forces exceed those that deform as far as slides exceed deformations.
fn is_delicate(recovery: &Recovery, ending: &Ending) -> bool {
    ending.judgement.leverage >= FAR || recovery.soft || recovery.ready.rows.uneven
}

/// True if a corrected answer replaced `ending`: it passes and its certificate is no worse. If the host, the time limit
/// or a lack of memory stops the finish, `ending` stays solved. Nothing is corrected where motions count as undetermined
/// although rows of the host resist them a little: these rows would move bodies along them.
pub fn finish(recovery: &Recovery, ending: &mut Ending) -> Result<bool> {
    if recovery.scaled.cleaned.is_some() {
        return Ok(false);
    }
    let negative = NegativeMotions::of(recovery.ready);
    let delicate = is_delicate(recovery, ending);
    let mut finish = Finish { recovery, ending, delicate, replaced: false, negative };
    match finish.run() {
        Ok(()) => {}
        Err(error) if error.kind == Kind::Memory => {}
        Err(error) => drop(Verdict::of_refusal(error)?),
    }
    let Finish { ending, replaced, .. } = finish;
    if replaced {
        recovery.bring_to_rest(ending, true)?;
    }
    Ok(replaced)
}

struct Finish<'a, 'b> {
    recovery: &'b Recovery<'a>,
    ending: &'b mut Ending,
    /// Rounding of K along motions no larger than the deformation matters, and so do errors below those of the certificate.
    delicate: bool,
    replaced: bool,
    negative: NegativeMotions,
}

impl Finish<'_, '_> {
    /// Active sets one after the other, until one confirms itself or occurs again.
    fn run(&mut self) -> Result<()> {
        let Faces { qp, direct } = &self.recovery.faces;
        let mut active = qp.at_bound(&self.ending.solution.x);
        let mut point = SplitPoint::of(self.recovery, self.ending, if self.delicate { 1.0 } else { FAR })?;
        let mut visited: Vec<Vec<bool>> = Vec::new();
        // a factor of the whole island costs as much as its setup: only an answer that does not pass is worth it
        let (mut sparse, passes) = (None, self.ending.judgement.certificate.passed());
        while visited.len() < FACES && !visited.contains(&active) {
            let rows: Vec<usize> = (0..active.len()).filter(|&i| !active[i]).collect();
            let is_large = rows.len() + point.alpha.len() > direct.limit;
            if is_large && passes {
                break;
            }
            point.hold(&active);
            self.ending.solution.counts.direct += 1;
            if is_large {
                if sparse.is_none() {
                    sparse = SparseFaces::of(self.recovery)?;
                }
                let face = sparse.as_ref().map(|faces| faces.on(rows)).transpose()?.flatten();
                let Some(face) = face else { break };
                self.correct(&mut point, FaceSolver::Sparse(&face))?;
            } else {
                let Some(face) = Face::new(*qp, direct.entries, rows)? else { break };
                let mut feedback = Feedback::on(face, point.alpha.len(), &self.negative)?;
                self.correct(&mut point, FaceSolver::Dense(&feedback))?;
                if feedback.face.is_truncated() {
                    feedback = Feedback::on(feedback.face.in_full()?, point.alpha.len(), &self.negative)?;
                    self.correct(&mut point, FaceSolver::Dense(&feedback))?;
                }
            }
            if !self.delicate && self.ending.judgement.certificate.worst() <= ROUNDING {
                break;
            }
            visited.push(std::mem::replace(&mut active, point.active(self.recovery)));
        }
        Ok(())
    }

    /// Corrections on one face while each is less than half the previous one; every intermediate answer that is no worse
    /// replaces the current one.
    fn correct(&mut self, point: &mut SplitPoint, face: FaceSolver) -> Result<()> {
        let (mut last, undetermined) = (f64::INFINITY, face.undetermined());
        for _ in 0..CORRECTIONS {
            interrupt::check()?;
            let size = point.correct(self.recovery, &self.negative, face)?;
            self.keep(point, undetermined)?;
            if size >= 0.5 * last {
                break;
            }
            last = size;
        }
        Ok(())
    }

    fn keep(&mut self, point: &SplitPoint, undetermined: usize) -> Result<()> {
        let x = point.forces(&self.recovery.scaled.gaps.bounded);
        let recovered = self.recovery.with_forces(point.displacement(), &x);
        let judgement = self.recovery.judged(&recovered)?;
        if is_better(&judgement.certificate, &self.ending.judgement.certificate) {
            let solution = &mut self.ending.solution;
            (solution.x, solution.alpha) = (x, point.alpha.clone());
            solution.undetermined = undetermined;
            (self.ending.recovered, self.ending.judgement) = (recovered, judgement);
            self.ending.deformed = point.deformed(self.recovery);
            self.replaced = true;
        }
        Ok(())
    }
}

/// The factors of a face: dense ones of F and the modes, or sparse ones of the island.
#[derive(Clone, Copy)]
enum FaceSolver<'a> {
    Dense(&'a Feedback<'a>),
    Sparse(&'a SparseFace<'a>),
}

impl FaceSolver<'_> {
    fn undetermined(&self) -> usize {
        match self {
            Self::Dense(feedback) => feedback.face.undetermined(),
            Self::Sparse(face) => face.undetermined(),
        }
    }
}

/// It passes, and it is much better or, up to rounding, worse in no entry. On bodies that carry little, rounding of other
/// bodies may be a loss of balance.
fn is_better(new: &Certificate, old: &Certificate) -> bool {
    let mut entries = new.entries().into_iter().zip(old.entries());
    let much = new.worst() <= MUCH_BETTER * old.worst();
    new.passed() && (much || entries.all(|(new, old)| new.ratio <= (NO_WORSE * old.ratio).max(ROUNDING)))
}

/// Forces x and amplitudes alpha with u = v + w: w are motions that K does not resist; in a sum with large w, v would
/// lose its digits. v, w and x are in two doubles: where loads and forces nearly cancel, rounding of x would move v.
struct SplitPoint {
    v: TwofoldVector,
    /// Amplitudes of the motions that v contains.
    beta: Vec<f64>,
    w: TwofoldVector,
    x: TwofoldVector,
    alpha: Vec<f64>,
    /// A motion of a body is added to w where it is larger than v by this factor.
    apart: f64,
    /// The largest correction of each unknown on this face: its rounding is not seen in u where a row presses u to zero.
    corrected: Vec<f64>,
}

impl SplitPoint {
    /// The current answer, or zero if it does not pass: redundant rows may have spoilt its forces.
    fn of(recovery: &Recovery, ending: &Ending, apart: f64) -> Result<Self> {
        let Ending { solution, deformed, judgement, .. } = ending;
        let modes = solution.alpha.len();
        if !judgement.certificate.passed() {
            return Ok(Self::at_origin(vec![0.0; deformed.len()], vec![0.0; solution.x.len()], modes, apart));
        }
        let deformed = recovery.deformed(&solution.x)?;
        let mut point = Self::at_origin(deformed, solution.x.clone(), modes, apart);
        point.turn(recovery, &solution.alpha)?;
        Ok(point)
    }

    fn at_origin(v: Vec<f64>, x: Vec<f64>, modes: usize, apart: f64) -> Self {
        let none = vec![0.0; v.len()];
        let (w, v, x) = (none.clone().into(), v.into(), x.into());
        Self { w, v, x, alpha: vec![0.0; modes], beta: vec![0.0; modes], apart, corrected: none }
    }

    /// Adds R a and returns R a.
    fn turn(&mut self, recovery: &Recovery, a: &[f64]) -> Result<Vec<f64>> {
        let dual = &recovery.ready.dual;
        let whole = dual.rigid_motion(a, self.v.len());
        let mut motion = whole.clone();
        let apart = recovery.clean(&mut motion, &self.v.values(), self.apart)?;
        for (k, (body, apart)) in recovery.data.bodies.iter().zip(apart).enumerate() {
            let to = if apart { &mut self.w } else { &mut self.v };
            body.range().for_each(|j| to.add(j, motion[j]));
            if !apart {
                let modes = dual.modes_of(k);
                axpy(1.0, &a[modes.clone()], &mut self.beta[modes]);
            }
        }
        axpy(1.0, a, &mut self.alpha);
        Ok(whole)
    }

    /// u - R alpha
    fn deformed(&self, recovery: &Recovery) -> Vec<f64> {
        let mut v = recovery.ready.dual.rigid_motion(&self.beta, self.v.len());
        v.iter_mut().enumerate().for_each(|(j, motion)| *motion = self.v.get(j) - *motion);
        v
    }

    /// u
    fn displacement(&self) -> Vec<f64> {
        let mut u = self.w.values();
        axpy(1.0, &self.v.values(), &mut u);
        u
    }

    fn gaps_left(&self, recovery: &Recovery) -> Vec<f64> {
        recovery.gaps_left(&[self.v.parts(), self.w.parts()].concat(), &self.x.parts())
    }

    /// Sets the forces to 0 on rows outside the active set.
    fn hold(&mut self, active: &[bool]) {
        (0..active.len()).filter(|&i| active[i]).for_each(|i| self.x.set_to_zero(i));
        self.corrected.fill(0.0);
    }

    /// x without the rounding of forces that are zero.
    fn forces(&self, bounded: &[bool]) -> Vec<f64> {
        let bounded = self.x.values().into_iter().zip(bounded);
        bounded.map(|(x, bounded)| if *bounded { x.max(0.0) } else { x }).collect()
    }

    /// Solves (10)-(11) on the face for the residual loads and gaps, `f - K u - B'x` and `c + C x - B u`: every
    /// correction reduces the errors of F and K+. Returns the length of the correction, `|.|_D`.
    fn correct(&mut self, recovery: &Recovery, negative: &NegativeMotions, face: FaceSolver) -> Result<f64> {
        let (dual, rows) = (&recovery.ready.dual, &recovery.ready.rows);
        let mut load = recovery.load_left(&self.v.parts(), &self.x.parts())?;
        let left = self.gaps_left(recovery);
        let (moved, forces) = match face {
            FaceSolver::Sparse(face) => {
                let (moved, forces) = face.solve(load, &left)?;
                moved.iter().enumerate().for_each(|(j, moved)| self.v.add(j, *moved));
                let turn = recovery.amplitudes(&moved);
                axpy(1.0, &turn, &mut self.alpha);
                axpy(1.0, &turn, &mut self.beta);
                (moved, forces)
            }
            FaceSolver::Dense(feedback) => {
                let face = &feedback.face;
                let mut gaps = vec![0.0; self.x.len()];
                face.rows().iter().for_each(|&i| gaps[i] = left[i]);
                let d = dual.rhs(&recovery.ready.moved(recovery.threads, &load)?, &gaps);
                let force = face.rows().iter().map(|&i| d[i]).collect();
                let (step, turn) = feedback.solve(negative, force, &dual.resultants(&load))?;
                let mut forces = vec![0.0; self.x.len()];
                face.rows().iter().zip(step).for_each(|(&i, step)| forces[i] = step);
                rows.take_forces(&forces, &mut load);
                let mut moved = recovery.inverse(&load)?;
                moved.iter().enumerate().for_each(|(j, moved)| self.v.add(j, *moved));
                axpy(1.0, &self.turn(recovery, &turn)?, &mut moved);
                (moved, forces)
            }
        };
        forces.iter().enumerate().for_each(|(i, force)| self.x.add(i, *force));
        self.corrected.iter_mut().zip(&moved).for_each(|(most, by)| *most = most.max(by.abs()));
        Ok(weighted_norm(&moved, |i| rows.metric[i]))
    }

    /// The active set by the signs of forces and gaps.
    fn active(&self, recovery: &Recovery) -> Vec<bool> {
        let (left, rows) = (self.gaps_left(recovery), &recovery.ready.rows.scaled);
        let (u, x) = (self.displacement(), self.x.values());
        let Gaps { value, bounded, .. } = &recovery.scaled.gaps;
        let terms =
            |i: usize| rows.row(i).map(|(j, v)| v.abs() * u[j].abs().max(self.corrected[j])).sum::<f64>();
        let noise = |i: usize| NOISE * (value[i].abs() + terms(i));
        // a gap that corrections cannot close depends on other rows, which also carry its force
        let leaves = |i: usize| x[i] < 0.0 || left[i] > noise(i);
        let stays = |i: usize| if x[i] == 0.0 { left[i] >= -noise(i) } else { leaves(i) };
        (0..x.len()).map(|i| bounded[i] && stays(i)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::Entry;
    use crate::qp::Solution;
    use crate::solve::certifier::tests::two_springs;

    /// Springs 1 and 1 pushed by 3 and 1 against walls at 1 and 2: only the first touches, lambda = 2.
    #[test]
    fn whatever_rows_the_answer_had_in_contact_it_ends_with_those_that_are() {
        two_springs(1e-6, |judge, solved| {
            let recovery = &judge.recovery;
            for x in [[2.0 * (1.0 + 1e-6), 0.0], [2.0 * (1.0 + 1e-6), 1e-12]] {
                let mut ending = recovery.ending(Solution { x: x.to_vec(), ..solved.clone() }).unwrap();
                assert!(finish(recovery, &mut ending).unwrap(), "{x:?}");
                assert_eq!(ending.solution.x, [2.0, 0.0]);
                assert_eq!(
                    (ending.recovered.u.as_slice(), ending.recovered.lambda.as_slice()),
                    ([1.0, 1.0].as_slice(), [2.0, 0.0].as_slice())
                );
            }
        });
    }

    #[test]
    fn no_answer_is_kept_on_a_wrong_active_set() {
        two_springs(1e-6, |judge, solved| {
            let recovery = &judge.recovery;
            for (rows, right) in [(vec![0], true), (vec![], false), (vec![1], false), (vec![0, 1], false)] {
                let mut ending = recovery.ending(solved.clone()).unwrap();
                let mut point = SplitPoint::at_origin(ending.recovered.u.clone(), solved.x.clone(), 0, 1.0);
                point.hold(&[0, 1].map(|i| !rows.contains(&i)));
                let Faces { qp, direct, .. } = &recovery.faces;
                let face = Face::new(*qp, direct.entries, rows.clone()).unwrap().unwrap();
                let negative = NegativeMotions::of(recovery.ready);
                let face = Feedback::on(face, 0, &negative).unwrap();
                let mut finish =
                    Finish { recovery, ending: &mut ending, delicate: true, replaced: false, negative };
                finish.correct(&mut point, FaceSolver::Dense(&face)).unwrap();
                assert_eq!(finish.replaced, right, "{rows:?}");
                assert_eq!(ending.recovered.lambda == [2.0, 0.0], right, "{rows:?}");
                assert_eq!(point.active(recovery), [false, true], "{rows:?}");
            }
        });
    }

    #[test]
    fn a_force_that_rounding_has_made_negative_is_none_and_its_row_leaves() {
        two_springs(0.0, |judge, _| {
            let recovery = &judge.recovery;
            let point = SplitPoint::at_origin(vec![1.0, 1.0], vec![2.0, -1e-20], 0, 1.0);
            assert_eq!(point.forces(&[true, true]), [2.0, 0.0]);
            assert_eq!(point.active(recovery), [false, true]);
        });
    }

    #[test]
    fn a_corrected_answer_takes_no_place_where_one_entry_is_worse() {
        let of = |ratio: f64| Entry { ratio, ..Entry::default() };
        let with = |all: f64, balance: f64| Certificate {
            equilibrium: of(all),
            balance: of(balance),
            duality_gap: of(all),
            ..Certificate::default()
        };
        for (new, old, better) in [
            (with(0.09, 0.09), with(0.2, 0.2), true),    // much better
            (with(0.2, 0.21), with(0.2, 0.2), true),     // equally good up to rounding
            (with(0.0, 0.3), with(0.2, 0.2), false),     // worse in its balance
            (with(0.3, 0.0), with(0.2, 0.2), false),     // worse except in its balance
            (with(0.15, 0.15), with(0.2, 0.1), false),   // its worst entry is better, but not by much
            (with(9e-5, 9e-5), with(0.0, 1e-9), true),   // both are rounding
            (with(2.0, 2.0), with(100.0, 100.0), false), // much better, and does not pass
        ] {
            assert_eq!(is_better(&new, &old), better, "{new:?} {old:?}");
        }
    }
}
