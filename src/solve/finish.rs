//! Option `finish`: after a solve, the residuals of the host's data correct forces and displacements together, each time
//! on the rows that these data show to be in contact, until only rounding is left.

use std::sync::Arc;

use crate::certificate::Certificate;
use crate::error::{Kind, Result};
use crate::model::{FinishBy, Method, Settings};
use crate::numbers::solve::{
    FAR, INTERIOR_FACTORS, MUCH_BETTER, NO_WORSE, RATIO_ROUNDING, SET_FACTORS, UNEVEN_DEFORMATION,
};
use crate::platform::interrupt;
use crate::qp::{Effort, Face, Rung, Verdict};
use crate::solve::feedback::{Feedback, NegativeMotions};
use crate::solve::pivots::Pivots;
use crate::solve::recovery::{Ending, Faces, Recovery};

use crate::solve::sparse_face::SparseFaces;
use crate::solve::split_point::{FaceSolver, SplitPoint, CORRECTIONS};

/// Limit of Newton steps with friction.
const STEPS: usize = 16;

/// Whether option `finish` asks for the finish of an island's answer. `automatic`: if an error that passes the
/// certificate may be large on some body, or if the way that bodies have travelled has `spoilt` the answer for the place where they
/// rest. With friction only if it is asked for: what the test refuses has been corrected.
pub fn is_to_finish(settings: &Settings, recovery: &Recovery, ending: &Ending, spoilt: bool) -> bool {
    if recovery.friction {
        return settings.finish == FinishBy::Direct;
    }
    let default = settings.method == Method::Proportioning && settings.finish == FinishBy::Automatic;
    let overlooked = ending.judgement.unevenness > UNEVEN_DEFORMATION;
    settings.finish == FinishBy::Direct
        || default && (overlooked || spoilt || is_delicate(recovery, ending)) && Rung::Finish.is_tried()
}

/// The error of an answer may be much larger than its certificate: beside soft bodies, by rows that join uneven bodies, and where
/// forces exceed those that deform as far as slides exceed deformations.
fn is_delicate(recovery: &Recovery, ending: &Ending) -> bool {
    ending.judgement.leverage >= FAR || recovery.soft || recovery.ready.rows.uneven
}

/// Factorisations that this effort takes, if it has a limit: those of the active sets, or of some twenty steps into the interior.
pub fn factorisations(effort: Effort) -> Option<f64> {
    match effort {
        Effort::FewSets => Some(SET_FACTORS),
        Effort::Interior => Some(INTERIOR_FACTORS),
        Effort::AllSets | Effort::All => None,
    }
}

/// What the finish has done.
#[derive(Default)]
pub struct Finished {
    /// A corrected answer replaced the given one: it passes and its certificate is no worse.
    pub replaced: bool,
    /// The last answer is correct up to rounding, or confirms its active set.
    pub settled: bool,
    /// No answer passes: forces of an interior point, from which the method may start again.
    pub inside: Option<Vec<f64>>,
}

/// Corrects the answer. If the host, the time limit or a lack of memory stops the finish, `ending` stays as it is. Nothing is
/// corrected where motions count as undetermined although rows of the host resist them a little: these rows would move bodies
/// along them.
pub fn finish(recovery: &Recovery, ending: &mut Ending, effort: Effort) -> Result<Finished> {
    if recovery.scaled.cleaned.is_some() {
        return Ok(Finished::default());
    }
    let negative = NegativeMotions::of(recovery.ready);
    let delicate = is_delicate(recovery, ending);
    let passed = ending.judgement.certificate.passed() && factorisations(effort).is_none();
    let mut finish = Finish { recovery, ending, delicate, passed, negative, done: Finished::default() };
    match finish.run(effort) {
        Ok(()) => {}
        Err(error) if error.kind == Kind::Memory => {}
        Err(error) => drop(Verdict::of_refusal(error)?),
    }
    let Finish { ending, done, .. } = finish;
    if done.replaced {
        recovery.bring_to_rest(ending)?;
    }
    Ok(done)
}

struct Finish<'a, 'b> {
    recovery: &'b Recovery<'a>,
    ending: &'b mut Ending,
    /// Rounding of K along motions no larger than the deformation matters, and so do errors below those of the certificate.
    delicate: bool,
    /// The given answer passes, and needs no sparse factors.
    passed: bool,
    negative: NegativeMotions,
    done: Finished,
}

impl<'a, 'b> Finish<'a, 'b> {
    /// Active sets from that of the answer on; if none of them has an answer that passes, from that of an interior point on.
    fn run(&mut self, effort: Effort) -> Result<()> {
        let Faces { qp, direct, .. } = &self.recovery.faces;
        let (mut dense, mut sets) = (direct.limit, usize::MAX);
        if let Some(factorisations) = factorisations(effort) {
            (dense, sets) = (0, factorisations as usize);
        }
        let point = SplitPoint::of(self.recovery, self.ending, if self.delicate { 1.0 } else { FAR })?;
        if self.recovery.friction {
            return self.follow_friction(point);
        }
        if effort != Effort::Interior {
            self.follow(qp.at_bound(&self.ending.solution.x), point, (dense, sets))?;
            if self.passes() || effort != Effort::All {
                return Ok(());
            }
        }
        let Some(faces) = self.sparse()? else { return Ok(()) };
        let Some(inside) = faces.inside(self.recovery.scaled)? else { return Ok(()) };
        if Rung::Interior.is_tried() {
            let point = SplitPoint::inside(self.recovery, &inside)?;
            self.follow(inside.active, point, (dense, sets))?;
        }
        self.done.inside = (!self.passes()).then_some(inside.force);
        Ok(())
    }

    fn passes(&self) -> bool {
        self.ending.judgement.certificate.passed()
    }

    /// A factor of the whole island costs as much as its setup: only an answer that does not pass is worth it.
    fn sparse(&self) -> Result<Option<&'b SparseFaces<'a>>> {
        let recovery = self.recovery;
        if self.passed {
            return Ok(None);
        }
        recovery.sparse_faces()
    }

    /// Up to `most` active sets one after the other, on up to `dense` rows and modes by dense factors, until one confirms itself. If its
    /// answer does not pass, or an answer whose forces all press misses equations that hold on every set, the point may have lost its
    /// digits: sparse factors take the place of dense ones from the beginning on.
    fn follow(
        &mut self,
        mut active: Vec<bool>,
        mut point: SplitPoint,
        (mut dense, most): (usize, usize),
    ) -> Result<()> {
        let mut start = (!self.passed && dense > 0).then(|| point.clone());
        let mut sets = Pivots::default();
        let before = self.ending.solution.counts.direct;
        while sets.go_on_with(&active) && self.ending.solution.counts.direct - before < most {
            let Some(undetermined) = self.on_face(&mut point, &active, dense)? else { break };
            self.ending.solution.counts.direct += 1;
            let next = point.active(self.recovery)?;
            let misses =
                self.keep(&point, undetermined, if next == active { is_no_worse } else { is_better })?;
            self.done.settled = next == active || self.ending.judgement.certificate.worst() <= RATIO_ROUNDING;
            if self.done.settled && next != active && !self.delicate {
                break;
            }
            let presses = active.iter().zip(&next).all(|(at_bound, leaves)| *at_bound || !leaves);
            let is_lost = if next == active { !self.passes() } else { misses && presses };
            if let Some(start) = start.take_if(|_| is_lost && Rung::SparseFaces.is_tried()) {
                (dense, point, sets) = (0, start, Pivots::default());
            } else if next != active {
                active = sets.after(&active, next);
            } else {
                break;
            }
        }
        Ok(())
    }

    /// Corrects on one face, up to `dense` rows and modes by dense factors; the number of motions that it leaves open. None: it
    /// has no factor.
    fn on_face(&mut self, point: &mut SplitPoint, active: &[bool], dense: usize) -> Result<Option<usize>> {
        let Faces { qp, direct, .. } = &self.recovery.faces;
        point.hold(active);
        let rows: Vec<usize> = (0..active.len()).filter(|&i| !active[i]).collect();
        if rows.len() + point.alpha.len() > dense {
            let Some(faces) = self.sparse()? else { return Ok(None) };
            let Some(face) = faces.on(rows)? else { return Ok(None) };
            self.correct(point, FaceSolver::Sparse(&face))?;
            return Ok(Some(face.undetermined()));
        }
        let Some(face) = Face::new(*qp, direct.entries, rows)? else { return Ok(None) };
        // else it began without forces
        if self.passed {
            point.settle(self.recovery, &face)?;
        }
        let mut feedback = Feedback::on(face, point.alpha.len(), &self.negative)?;
        self.correct(point, FaceSolver::Dense(&feedback))?;
        if feedback.face.is_truncated() && Rung::AllRows.is_tried() {
            feedback = Feedback::on(feedback.face.in_full()?, point.alpha.len(), &self.negative)?;
            self.correct(point, FaceSolver::Dense(&feedback))?;
        }
        if !self.passed {
            self.keep(point, feedback.face.undetermined(), is_better)?;
            if !self.passes() && feedback.face.left_out().next().is_some() && Rung::RowsClosed.is_tried() {
                let correct = |point: &mut SplitPoint| self.correct(point, FaceSolver::Dense(&feedback));
                point.close(self.recovery, &feedback.face, correct)?;
            }
        }
        Ok(Some(feedback.face.undetermined()))
    }

    /// Newton steps of the laws of friction, until the states are known and only rounding is left.
    fn follow_friction(&mut self, mut point: SplitPoint) -> Result<()> {
        let (mut last, mut before) = (f64::INFINITY, Vec::new());
        for _ in 0..STEPS {
            interrupt::check()?;
            let Some((size, states)) = point.step_with_friction(self.recovery)? else { break };
            self.ending.solution.counts.direct += 1;
            self.keep(&point, self.ending.solution.undetermined, is_better)?;
            let is_settled = states == before && !(size < 0.5 * last);
            if is_settled || self.passes() && self.ending.judgement.certificate.worst() <= RATIO_ROUNDING {
                break;
            }
            (last, before) = (size, states);
        }
        Ok(())
    }

    /// Corrections on one face while each is less than half the previous one.
    fn correct(&self, point: &mut SplitPoint, face: FaceSolver) -> Result<()> {
        let mut last = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            interrupt::check()?;
            let size = point.correct(self.recovery, &self.negative, face)?;
            if size >= 0.5 * last {
                break;
            }
            last = size;
        }
        Ok(())
    }

    /// Takes the answer of a point if it `replaces` the present one. Whether it misses equilibrium or equality rows, which every face has.
    fn keep(
        &mut self,
        point: &SplitPoint,
        undetermined: usize,
        replaces: fn(&Certificate, &Certificate) -> bool,
    ) -> Result<bool> {
        let x = point.forces(&self.recovery.scaled.gaps.bounded);
        let recovered = self.recovery.with_forces(point.displacement(self.recovery)?, &x.parts());
        let judgement = self.recovery.judged(&recovered)?;
        let Certificate { equilibrium, balance, equality, .. } = &judgement.certificate;
        let misses = [equilibrium, balance, equality].iter().any(|entry| entry.ratio > 1.0);
        if replaces(&judgement.certificate, &self.ending.judgement.certificate) {
            let solution = &mut self.ending.solution;
            (solution.x, solution.alpha) = (x.values(), point.alpha.clone());
            solution.undetermined = undetermined;
            (self.ending.recovered, self.ending.judgement) = (recovered, judgement);
            self.ending.deformed = Arc::new(point.deformed(self.recovery)?);
            self.done.replaced = true;
        }
        Ok(misses)
    }
}

/// It passes, and it is much better or, up to rounding, worse in no entry. On bodies that carry little, rounding of other
/// bodies may be a loss of balance.
fn is_better(new: &Certificate, old: &Certificate) -> bool {
    let mut entries = new.entries().into_iter().zip(old.entries());
    let much = new.worst() <= MUCH_BETTER * old.worst();
    new.passed()
        && (!old.passed()
            || much
            || entries.all(|(new, old)| new.ratio <= (NO_WORSE * old.ratio).max(RATIO_ROUNDING)))
}

/// It passes, and in sum it is no worse: enough on the rows that signs confirm, which those of the other answer may not be.
fn is_no_worse(new: &Certificate, old: &Certificate) -> bool {
    new.passed() && new.worst() <= (NO_WORSE * old.worst()).max(RATIO_ROUNDING)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Kept;
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
                assert!(finish(recovery, &mut ending, Effort::All).unwrap().replaced, "{x:?}");
                assert_eq!(ending.solution.x, [2.0, 0.0]);
                assert_eq!(
                    (ending.recovered.u.at_rows.as_slice(), ending.recovered.lambda.as_slice()),
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
                let u = Arc::clone(&ending.recovered.u);
                let mut point = SplitPoint::at_origin(recovery, &u.of, (solved.x.clone(), 0), 1.0).unwrap();
                point.hold(&[0, 1].map(|i| !rows.contains(&i)));
                let Faces { qp, direct, .. } = &recovery.faces;
                let face = Face::new(*qp, direct.entries, rows.clone()).unwrap().unwrap();
                let negative = NegativeMotions::of(recovery.ready);
                let face = Feedback::on(face, 0, &negative).unwrap();
                let mut finish = Finish {
                    recovery,
                    ending: &mut ending,
                    delicate: true,
                    passed: true,
                    negative,
                    done: Finished::default(),
                };
                finish.correct(&mut point, FaceSolver::Dense(&face)).unwrap();
                finish.keep(&point, 0, is_better).unwrap();
                assert_eq!(finish.done.replaced, right, "{rows:?}");
                assert_eq!(ending.recovered.lambda == [2.0, 0.0], right, "{rows:?}");
                assert_eq!(point.active(recovery).unwrap(), [false, true], "{rows:?}");
            }
        });
    }

    #[test]
    fn a_force_that_rounding_has_made_negative_is_none_and_its_row_leaves() {
        two_springs(0.0, |judge, _| {
            let recovery = &judge.recovery;
            let u = Kept::of(vec![vec![1.0, 1.0]]);
            let point = SplitPoint::at_origin(recovery, &u, (vec![2.0, -1e-20], 0), 1.0).unwrap();
            assert_eq!(point.forces(&[true, true]).values(), [2.0, 0.0]);
            assert_eq!(point.active(recovery).unwrap(), [false, true]);
        });
    }

    /// The last row penetrates by 45 eps: in two doubles that is no rounding.
    #[test]
    fn a_row_joins_as_soon_as_its_gap_exceeds_the_rounding_of_its_own_data() {
        two_springs(0.0, |judge, _| {
            for (beyond, open) in [(0.0, true), (1e-14, false), (-1e-14, true)] {
                let recovery = &judge.recovery;
                let u = Kept::of(vec![vec![1.0, 2.0 + beyond]]);
                let point = SplitPoint::at_origin(recovery, &u, (vec![2.0, 0.0], 0), 1.0).unwrap();
                assert_eq!(point.active(recovery).unwrap(), [false, open], "{beyond}");
            }
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
