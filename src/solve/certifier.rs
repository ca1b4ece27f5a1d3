//! The acceptance test of the methods: recovers the answer for a point of the dual problem of one island and evaluates
//! its certificate.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::body::Distributed;
use crate::certificate::Judgement;
use crate::error::{Kind, Result};
use crate::linalg::vector::norm;
use crate::numbers::solve::{JUMPS, SETTLED};
use crate::platform::interrupt;
use crate::platform::memory::copied;
use crate::qp::{AcceptanceTest, Effort, Mended, Rung, Solution, Verdict};
use crate::solve::finish::{factorisations, finish, Finished};
use crate::solve::gaps::Gaps;
use crate::solve::recovery::{Ending, Recovered, Recovery};

/// What the certificate says about a point.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Judged {
    /// Nothing was judged, or the answer passes.
    #[default]
    Passed,
    Missed,
    /// Rows left out of the dual problem that the answer violates.
    RowsReached(Vec<usize>),
    /// The amplitudes of the motions with negative stiffness differ from those from which e was computed.
    AmplitudesMoved,
}

/// What a run of the method assumes, and what its end point has to meet.
#[derive(Default)]
pub struct Assumed {
    /// Rows left out of the dual problem.
    pub far: Vec<bool>,
    /// Amplitudes of the motions with negative stiffness from which e was computed.
    pub amplitudes: Vec<f64>,
    /// Amplitudes must have settled, even if the certificate passes.
    pub is_strict: bool,
}

/// Judges a point of the dual by the certificate of the answer recovered from it.
pub struct Certifier<'a> {
    pub recovery: Recovery<'a>,
    /// The last point accepted, with its answer.
    accepted: Option<Accepted>,
    /// Time spent on recovery and certification.
    pub spent: Duration,
    pub assumed: Assumed,
    /// Of the last point.
    pub judged: Judged,
    /// Ratio of the worst entry of the certificate of the last point that was refused.
    missed: Option<f64>,
}

/// A point (x, alpha) of the dual problem whose answer has passed.
struct Accepted {
    point: (Vec<f64>, Vec<f64>),
    deformed: Arc<Distributed>,
    recovered: Recovered,
    judgement: Judgement,
}

impl<'a> Certifier<'a> {
    pub fn new(recovery: Recovery<'a>) -> Self {
        let (assumed, judged) = (Assumed::default(), Judged::default());
        Self { recovery, accepted: None, spent: Duration::ZERO, assumed, judged, missed: None }
    }

    /// The answer of a solution; the answer of the point accepted last is not computed again.
    pub fn ending(&mut self, solution: Solution) -> Result<Ending> {
        let known = self.accepted.take();
        let known = known.filter(|known| known.point.0 == solution.x && known.point.1 == solution.alpha);
        if let Some(Accepted { deformed, recovered, judgement, .. }) = known {
            return Ok(Ending { solution, deformed, recovered, judgement });
        }
        self.recovery.ending(solution)
    }

    /// Whether the amplitudes of motions with negative stiffness differ from those from which e was computed.
    fn differ(&self, alpha: &[f64]) -> bool {
        let negative = &self.recovery.ready.dual.negative;
        let (mut change, mut size) = (0.0, 0.0);
        for ((mode, stiffness), was) in negative.iter().zip(&self.assumed.amplitudes) {
            change -= stiffness * (alpha[*mode] - was).powi(2);
            size -= stiffness * alpha[*mode].powi(2);
        }
        change > SETTLED * SETTLED * size
    }

    /// The rows left out that the displacement u, where rows touch, violates.
    fn beyond(&self, u: &[f64]) -> Vec<usize> {
        let (rows, gaps) = (&self.recovery.ready.rows.scaled, &self.recovery.scaled.gaps.value);
        let far = self.assumed.far.iter().enumerate().filter(|(_, far)| **far);
        far.map(|(i, _)| i).filter(|&i| rows.row_dot(i, u) > gaps[i]).collect()
    }

    /// The answer of the point is kept if it passes.
    fn judge(&mut self, x: &[f64], alpha: &[f64]) -> Result<Judged> {
        let recovery = &self.recovery;
        let deformed = Arc::new(recovery.deformed(x)?);
        let recovered = recovery.recover(&deformed, x, alpha)?;
        let judgement = recovery.judged(&recovered)?;
        if !judgement.certificate.passed() {
            let reached = self.beyond(&recovered.u.at_rows);
            self.missed = Some(judgement.certificate.worst());
            return Ok(match reached.is_empty() {
                // violated rows join first: without them no other improvement helps
                false => Judged::RowsReached(reached),
                true if self.differ(alpha) => Judged::AmplitudesMoved,
                true => Judged::Missed,
            });
        }
        self.missed = None;
        let point = (copied(x, "forces")?, copied(alpha, "amplitudes")?);
        self.accepted = Some(Accepted { point, deformed, recovered, judgement });
        let unsettled = self.assumed.is_strict && self.differ(alpha);
        Ok(if unsettled { Judged::AmplitudesMoved } else { Judged::Passed })
    }
}

impl AcceptanceTest for Certifier<'_> {
    /// `|sum_p |B'_p u_p|| + |c'|`: lengths, independent of the choice of K+. Gaps count only up to the motion of the
    /// bodies, which includes the motion that rows demand: so a gap that never closes does not enlarge the scale. Rows
    /// left out do not count.
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64> {
        // as expensive as a product with F
        interrupt::check()?;
        let recovery = &self.recovery;
        let mut distances = recovery.ready.distances(recovery.threads, &recovery.scaled.moved, x, alpha)?;
        let Gaps { dual, bounded, .. } = &recovery.scaled.gaps;
        let mut gaps = dual.clone();
        for (i, _) in self.assumed.far.iter().enumerate().filter(|(_, far)| **far) {
            (distances[i], gaps[i]) = (0.0, 0.0);
        }
        let demanded = gaps.iter().zip(bounded).map(|(c, bounded)| if *bounded { c.min(0.0) } else { *c });
        let reach = norm(&distances) + norm(&demanded.collect::<Vec<_>>());
        Ok(norm(&distances) + norm(&gaps).min(reach))
    }

    /// Where bodies are cut, jumps between pieces are the largest error: averaged they leave forces without balance, which the
    /// certificate relates to all forces on the body, all in the energy norm.
    fn share_of_energy(&self) -> f64 {
        let recovery = &self.recovery;
        recovery.ready.whole().map_or(0.0, |_| JUMPS * recovery.data.limit)
    }

    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool> {
        interrupt::check()?;
        let begun = Instant::now();
        self.judged = self.judge(x, alpha)?;
        self.spent += begun.elapsed();
        Ok(self.judged != Judged::Missed)
    }

    fn missed(&self) -> Option<f64> {
        self.missed
    }

    /// The certificate of whole bodies detects losses in pieces with soft and stiff parts; the dual problem does not.
    fn has_better_data(&self) -> bool {
        self.recovery.ready.whole().is_some()
    }

    fn pays_after(&self, effort: Effort) -> Option<usize> {
        let (dual, faces) = (&self.recovery.ready.dual, &self.recovery.faces);
        let work = faces.sparse_work().unwrap_or_else(|| dual.factorisation_work());
        let steps = factorisations(effort)? * work / dual.step_work();
        let can = faces.direct.limit > 0 && self.recovery.scaled.cleaned.is_none() && Rung::Faces.is_tried();
        (can && steps < f64::INFINITY).then(|| steps.ceil() as usize)
    }

    fn mended(&mut self, solution: &Solution, effort: Effort) -> Result<Mended> {
        let begun = Instant::now();
        let is_limited = factorisations(effort).is_some();
        if is_limited {
            match self.recovery.sparse_faces() {
                Err(error) if error.kind != Kind::Memory => return Err(error),
                Err(_) | Ok(None) => return Ok(Mended::Failed),
                Ok(Some(_)) if self.pays_after(effort) > Some(solution.counts.steps()) => {
                    return Ok(Mended::Dear);
                }
                Ok(Some(_)) => {}
            }
        }
        let mut ending = self.ending(solution.clone())?;
        self.recovery.bring_to_rest(&mut ending)?;
        let Finished { replaced, settled, inside } = finish(&self.recovery, &mut ending, effort)?;
        self.spent += begun.elapsed();
        let is_answer = match is_limited {
            true => replaced && settled,
            false => replaced || ending.judgement.certificate.passed(),
        };
        if !is_answer {
            interrupt::check()?;
            return Ok(inside.map_or(Mended::Failed, Mended::Near));
        }
        let Ending { solution, deformed, recovered, judgement } = ending;
        let point = (copied(&solution.x, "forces")?, copied(&solution.alpha, "amplitudes")?);
        self.accepted = Some(Accepted { point, deformed, recovered, judgement });
        self.judged = Judged::Passed;
        Ok(Mended::Accepted(Solution { verdict: Verdict::Solved, ..solution }))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::body::{Modes, SparseInput, Storage};
    use crate::constraints::{RowKind, RowsInput};
    use crate::model::{HostModel, SolvedModel};
    use crate::progress::{Host, Phases};
    use crate::qp::Counts;
    use crate::setup::Prepared;
    use crate::solve::case::Case;
    use crate::solve::island::{direct, scaled};
    use crate::solve::recovery::Faces;

    /// Springs 1 and 1 pushed by 3 and 1 against walls at 1 and 2, one body; `work` receives an answer whose first force,
    /// 2, has the relative error `error`.
    pub fn two_springs(error: f64, work: impl Fn(&mut Certifier, &Solution)) {
        let mut model = HostModel::new();
        let body = model.add_body(2).unwrap();
        let springs = SparseInput { ptr: &[0, 1, 2], col: &[0, 1], val: &[1.0; 2], storage: Storage::Lower };
        model.set_stiffness(body, springs).unwrap();
        model.set_null_space(body, 2, 0, &[], 2, Modes::Exact).unwrap();
        model.set_load(body, &[3.0, 1.0]).unwrap();
        let rows =
            RowsInput { ptr: &[0, 1, 2], body: None, dof: &[0, 1], val: &[1.0, 1.0], rhs: Some(&[1.0, 2.0]) };
        model.add_rows(RowKind::Inequality, rows).unwrap();
        model.set_f64("certificate_tolerance", 1e-4).unwrap();
        let (x, verdict) = (vec![2.0 * (1.0 + error), 0.0], Verdict::Solved);
        let solved =
            Solution { x, alpha: vec![], undetermined: 0, scale: 3.0, verdict, counts: Counts::default() };
        judging(&model, |judge| work(judge, &solved));
    }

    /// Runs `work` with the certifier of the first island.
    fn judging(model: &SolvedModel, work: impl Fn(&mut Certifier)) {
        let (mut prepared, mut watch) =
            (Prepared::default(), Host::default().watch(1e300, Phases::default()));
        prepared.set_up(model, &mut watch).unwrap();
        let ready = &prepared.done(model).unwrap().islands[0];
        let case = Case { model, prepared: &prepared, ready, method: None };
        let dual = scaled(case).unwrap();
        let (qp, direct) = (dual.qp(ready, &*ready.dual), direct(case).unwrap());
        let recovery = Recovery::new(case, &dual, Faces::new(qp, direct)).unwrap();
        work(&mut Certifier::new(recovery));
    }

    #[test]
    fn a_solution_ends_with_its_own_answer_whatever_has_been_accepted_before() {
        two_springs(1e-6, |judge, solved| {
            assert!(judge.accepts(&solved.x, &solved.alpha).unwrap());
            let other = Solution { x: vec![2.0, 0.0], ..solved.clone() };
            assert_eq!(judge.ending(other).unwrap().recovered.lambda, [2.0, 0.0]);
            assert!(judge.accepts(&solved.x, &solved.alpha).unwrap());
            assert_eq!(judge.ending(solved.clone()).unwrap().recovered.lambda, solved.x);
        });
    }

    /// Springs 1 and 1 at walls: u = (3 - 2, 1 - 0), all scales 1; the gaps (1, 2) are larger than these motions.
    #[test]
    fn the_scale_is_how_far_bodies_move_along_the_rows_and_their_gaps() {
        two_springs(0.0, |judge, solved| {
            let scale = judge.scale(&solved.x, &solved.alpha).unwrap();
            assert!((scale - 2.0 * 2f64.sqrt()).abs() < 1e-14);
        });
    }

    /// A free spring between dofs 0 and 1, rows on both: compared with the displacements of (17).
    #[test]
    fn the_scale_counts_the_rigid_motion() {
        let mut model = HostModel::new();
        let body = model.add_body(2).unwrap();
        let (ptr, col, val) = ([0, 1, 3], [0, 0, 1], [1.0, -1.0, 1.0]);
        let spring = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
        model.set_stiffness(body, spring).unwrap();
        model.set_load(body, &[3.0, 1.0]).unwrap();
        let rows = RowsInput {
            ptr: &[0, 1, 2],
            body: None,
            dof: &[0, 1],
            val: &[1.0, -2.0],
            rhs: Some(&[1.0, 2.0]),
        };
        model.add_rows(RowKind::Inequality, rows).unwrap();
        judging(&model, |judge| {
            for (x, alpha) in [([0.0, 0.0], 0.0), ([2.0, 0.0], -7.0), ([0.5, 1.5], 2.0)] {
                let recovery = &judge.recovery;
                let u = recovery.recover(&recovery.deformed(&x).unwrap(), &x, &[alpha]).unwrap().u;
                let moved = [0, 1].map(|i| recovery.ready.rows.matrix.row_dot(i, &u.at_rows));
                let expected = norm(&moved) + norm(&recovery.scaled.gaps.dual).min(norm(&moved));
                let scale = judge.scale(&x, &[alpha]).unwrap();
                assert!((scale - expected).abs() <= 1e-14 * expected, "{alpha}");
            }
        });
    }
}
