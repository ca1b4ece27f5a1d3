//! Judges points of the dual of one island by the certificate of the answers that they give.

use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

use crate::certificate::{certify, Answer as AnswerView, Data, Judgement, Unasked};
use crate::error::Result;
use crate::linalg::vector::{axpy, norm};
use crate::platform::memory::copied;
use crate::qp::{Direct, Judge, Qp, Solution, Verdict};
use crate::solver::finish::finish;
use crate::solver::presolve::Gaps;
use crate::solver::problem::Problem;
use crate::solver::response::ByInverse;
use crate::solver::rigid::Cleaner;
use crate::solver::scaled::Scaled;
use crate::solver::setup::Ready;
use crate::solver::watch::Stops;

/// Displacements and multipliers in the units of the host.
#[derive(Clone)]
pub(super) struct Recovered {
    pub u: Vec<f64>,
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
}

impl Recovered {
    pub fn view(&self) -> AnswerView<'_> {
        AnswerView { u: &self.u, lambda: &self.lambda, mu: &self.mu }
    }
}

/// What solutions on faces of the dual are made with, and when that has to end.
pub(super) struct Faces<'a> {
    pub qp: Qp<'a>,
    pub direct: Direct<'a>,
    pub stops: &'a Stops,
}

/// Judges a point of the dual by the certificate of the answer recovered from it.
pub(super) struct Certifier<'a> {
    pub ready: &'a Ready,
    pub scaled: &'a Scaled,
    pub data: Data<'a>,
    pub threads: usize,
    pub faces: Faces<'a>,
    /// V of the loads, once it has been asked for.
    work: Cell<Option<f64>>,
    /// What cleans the motions of every body, once it has been asked for.
    pub cleaners: RefCell<Vec<Option<Cleaner>>>,
    /// The last point accepted, with its answer.
    pub accepted: Option<Accepted>,
    /// Time for answers recovered and certified.
    pub spent: Duration,
    /// Rows of the dual that are left out, and those of them that the last point goes through.
    pub far: Vec<bool>,
    pub reached: Vec<usize>,
    /// Ratio of the worst entry of the point refused last.
    missed: Option<f64>,
    /// Rounding grows by more than 1 / `SOFT` in K+ of a body.
    pub soft: bool,
}

/// Least `softness` of a K+ whose losses do not matter.
const SOFT: f64 = 1e-4;

/// A point (x, alpha) of the dual whose answer has passed, and its amplitudes where it had to be brought to rest.
pub(super) struct Accepted {
    point: (Vec<f64>, Vec<f64>),
    alpha_at_rest: Option<Vec<f64>>,
    deformed: Vec<f64>,
    recovered: Recovered,
    judgement: Judgement,
}

/// What a solve ends with.
pub(super) struct Ending {
    pub solution: Solution,
    /// u but for a motion by R, length.
    pub deformed: Vec<f64>,
    pub recovered: Recovered,
    pub judgement: Judgement,
}

impl<'a> Certifier<'a> {
    pub fn new(problem: &'a Problem, ready: &'a Ready, scaled: &'a Scaled, faces: Faces<'a>) -> Result<Self> {
        let (mut data, threads) = (problem.data(&ready.island)?, problem.threads());
        if let Some(load) = scaled.unheld.as_ref().and_then(|taken| taken.load.as_ref()) {
            data.bodies.iter_mut().for_each(|body| body.load = Some(&load[body.range()]));
        }
        let work = Cell::new(None);
        let cleaners = RefCell::new(data.bodies.iter().map(|_| None).collect());
        let (far, reached, spent) = (Vec::new(), Vec::new(), Duration::ZERO);
        let (accepted, missed) = (None, None);
        let is_soft = |p: &usize| {
            let inverse = problem.bodies[*p].inverse.as_ref();
            inverse.is_some_and(|inverse| inverse.kplus.softness < SOFT)
        };
        let soft = ready.island.bodies.iter().any(is_soft);
        Ok(Self {
            ready,
            scaled,
            data,
            threads,
            faces,
            work,
            cleaners,
            accepted,
            spent,
            far,
            reached,
            missed,
            soft,
        })
    }

    /// (17) and lambda = 2^p S L'^-1 x on the rows that carry the multipliers of their groups, for u but for its motion.
    pub fn recover(&self, deformed: &[f64], x: &[f64], alpha: &[f64]) -> Recovered {
        let mut u = self.ready.dual.rigid_motion(alpha, deformed.len());
        axpy(1.0, deformed, &mut u);
        self.with_forces(u, x)
    }

    /// `K+ (f - B'x)`; where K+ is soft what it has lost is added, lest it be taken for a motion.
    pub fn deformed(&self, x: &[f64]) -> Result<Vec<f64>> {
        let mut load = copied(&self.scaled.load, "a displacement")?;
        self.ready.rows.take_forces(x, &mut load);
        let mut deformed = self.inverse(&load)?;
        if self.soft {
            let lost = self.inverse(&self.load_left(&deformed, x)?)?;
            axpy(1.0, &lost, &mut deformed);
        }
        Ok(deformed)
    }

    /// `K+ f`
    pub fn inverse(&self, load: &[f64]) -> Result<Vec<f64>> {
        self.ready.displacement(self.threads, load)
    }

    /// An answer of u and x.
    pub fn with_forces(&self, u: Vec<f64>, x: &[f64]) -> Recovered {
        let (lambda, mu) = self.forces_of_host(x);
        Recovered { u, lambda, mu }
    }

    /// `lambda = 2^p S L'^-1 x` and mu, on the rows that carry the multipliers of their groups.
    pub fn forces_of_host(&self, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let ready = self.ready;
        let mut lambda = vec![0.0; ready.rows.scale.len()];
        let x = ready.rows.decoupling.solve_transposed(x.to_vec());
        for (x, &holder) in x.iter().zip(&self.scaled.gaps.holder) {
            lambda[holder] = x * ready.rows.scale[holder] * ready.island.unit;
        }
        let mu = lambda.split_off(ready.rows.contact);
        (lambda, mu)
    }

    /// The answer of a solution; that of the point just accepted is there already.
    pub fn ending(&mut self, mut solution: Solution) -> Result<Ending> {
        let known = self.accepted.take();
        let known = known.filter(|known| known.point.0 == solution.x && known.point.1 == solution.alpha);
        if let Some(Accepted { alpha_at_rest, deformed, recovered, judgement, .. }) = known {
            solution.alpha = alpha_at_rest.unwrap_or(solution.alpha);
            return Ok(Ending { solution, deformed, recovered, judgement });
        }
        let deformed = self.deformed(&solution.x)?;
        let recovered = self.recover(&deformed, &solution.x, &solution.alpha);
        let judgement = self.judged(&recovered)?;
        Ok(Ending { solution, deformed, recovered, judgement })
    }

    /// The same where rounding of the loads excuses nothing, and K+ is not asked.
    fn judged_strictly(&self, answer: &Recovered) -> Result<Judgement> {
        certify(&self.data, answer.view(), &mut Unasked)
    }

    /// The rows left out that a displacement goes through.
    fn beyond(&self, u: &[f64]) -> Vec<usize> {
        let (rows, gaps) = (&self.ready.rows.scaled, &self.scaled.gaps.value);
        (0..self.far.len()).filter(|&i| self.far[i] && rows.row_dot(i, u) > gaps[i]).collect()
    }

    /// The judgement of an answer.
    pub fn judged(&self, answer: &Recovered) -> Result<Judgement> {
        self.judged_on(&self.data, answer)
    }

    /// The same by data with other loads, but for rounding of those.
    pub fn judged_on(&self, data: &Data, answer: &Recovered) -> Result<Judgement> {
        let Self { ready, threads, work, .. } = self;
        certify(data, answer.view(), &mut ByInverse { data, ready, threads: *threads, work })
    }
}

impl Judge for Certifier<'_> {
    /// `|sum_p |B'_p u_p|| + |c'|`: lengths, whatever the choice of K+. Gaps count up to how far bodies move, and are moved
    /// by rows that demand it: no gap that is never closed makes others seem small, and rows left out do not count.
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64> {
        let mut distances = self.ready.distances(self.threads, &self.scaled.moved, x, alpha)?;
        let Gaps { dual, bounded, .. } = &self.scaled.gaps;
        let mut gaps = dual.clone();
        for (i, _) in self.far.iter().enumerate().filter(|(_, far)| **far) {
            (distances[i], gaps[i]) = (0.0, 0.0);
        }
        let demanded = gaps.iter().zip(bounded).map(|(c, bounded)| if *bounded { c.min(0.0) } else { *c });
        let reach = norm(&distances) + norm(&demanded.collect::<Vec<_>>());
        Ok(norm(&distances) + norm(&gaps).min(reach))
    }

    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool> {
        let begun = Instant::now();
        let deformed = self.deformed(x)?;
        let mut recovered = self.recover(&deformed, x, alpha);
        // more steps may do what K+ would have to explain
        let first = self.missed.is_none();
        let mut judgement = if first { self.judged_strictly(&recovered)? } else { self.judged(&recovered)? };
        let (mut alpha_at_rest, mut reached) = (None, Vec::new());
        if !judgement.certificate.passed() {
            // a travel that nothing resists may hide the rest
            if let Some((rested, amplitudes)) = self.at_rest(&recovered, x, &deformed, false)? {
                let at_rest = self.judged(&rested)?;
                if at_rest.certificate.passed() {
                    (recovered, judgement, alpha_at_rest) = (rested, at_rest, Some(amplitudes));
                } else {
                    reached = self.beyond(&rested.u);
                }
            } else {
                reached = self.beyond(&recovered.u);
            }
        }
        self.spent += begun.elapsed();
        let passed = judgement.certificate.passed();
        self.missed = Some(judgement.certificate.worst()).filter(|_| !passed);
        if passed {
            let point = (copied(x, "forces")?, copied(alpha, "amplitudes")?);
            self.accepted = Some(Accepted { point, alpha_at_rest, deformed, recovered, judgement });
        }
        self.reached = reached;
        // those rows come first: without them there is nothing to make better
        Ok(passed || !self.reached.is_empty())
    }

    fn missed(&self) -> Option<f64> {
        self.missed
    }

    fn mended(&mut self, solution: &Solution) -> Result<Option<Solution>> {
        let begun = Instant::now();
        let mut ending = self.ending(solution.clone())?;
        self.bring_to_rest(&mut ending, false)?;
        let mended = finish(self, &mut ending)?;
        self.spent += begun.elapsed();
        if !mended && !ending.judgement.certificate.passed() {
            return Ok(None);
        }
        let Ending { solution, deformed, recovered, judgement } = ending;
        let point = (copied(&solution.x, "forces")?, copied(&solution.alpha, "amplitudes")?);
        self.accepted = Some(Accepted { point, alpha_at_rest: None, deformed, recovered, judgement });
        self.reached.clear();
        Ok(Some(Solution { verdict: Verdict::Solved, ..solution }))
    }

    fn length(&self) -> Option<f64> {
        let unit = self.ready.island.unit.sqrt();
        let accepted = self.accepted.as_ref().filter(|_| self.reached.is_empty());
        accepted.map(|accepted| accepted.judgement.length / unit)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::qp::Counts;
    use crate::solver::watch::Watch;
    use crate::solver::{Modes, RowKind, RowsInput, SparseInput, Storage};

    /// Springs 1 and 1 pushed by 3 and 1 against walls at 1 and 2, one body; `work` gets an answer whose first
    /// force, 2, is wrong by the factor 1 + `error`.
    pub fn two_springs(error: f64, work: impl Fn(&mut Certifier, &Solution)) {
        let mut problem = Problem::new();
        let body = problem.add_body(2).unwrap();
        let springs = SparseInput { ptr: &[0, 1, 2], col: &[0, 1], val: &[1.0; 2], storage: Storage::Lower };
        problem.set_stiffness(body, springs).unwrap();
        problem.set_null_space(body, 2, 0, &[], 2, Modes::Exact).unwrap();
        problem.set_load(body, &[3.0, 1.0]).unwrap();
        let rows =
            RowsInput { ptr: &[0, 1, 2], body: None, dof: &[0, 1], val: &[1.0, 1.0], rhs: Some(&[1.0, 2.0]) };
        problem.add_rows(RowKind::Inequality, rows).unwrap();
        problem.set_f64("certificate_tolerance", 1e-4).unwrap();
        let (x, verdict) = (vec![2.0 * (1.0 + error), 0.0], Verdict::Solved);
        let solved =
            Solution { x, alpha: vec![], undetermined: 0, scale: 3.0, verdict, counts: Counts::default() };
        judging(&mut problem, |judge| work(judge, &solved));
    }

    /// `work` with the judge of the first island.
    fn judging(problem: &mut Problem, work: impl Fn(&mut Certifier)) {
        let test = |problem: &mut Problem, watch: &mut Watch| {
            problem.set_up(watch)?;
            let setup = problem.ready()?;
            let ready = &setup.islands[0];
            let dual = Scaled::new(problem, ready, &watch.stops)?;
            let (qp, direct) = (dual.qp(ready, &ready.dual), problem.direct(setup, ready));
            let faces = Faces { qp, direct, stops: &watch.stops };
            work(&mut Certifier::new(problem, ready, &dual, faces)?);
            Ok(())
        };
        problem.watched(test).unwrap();
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

    /// Springs 1 and 1 at walls: u = (3 - 2, 1 - 0), all scales 1; gaps (1, 2) are farther than that.
    #[test]
    fn the_scale_is_how_far_bodies_move_along_the_rows_and_their_gaps() {
        two_springs(0.0, |judge, solved| {
            let scale = judge.scale(&solved.x, &solved.alpha).unwrap();
            assert!((scale - 2.0 * 2f64.sqrt()).abs() < 1e-14);
        });
    }

    /// A free spring between dofs 0 and 1, rows on both: against the displacements that (17) gives.
    #[test]
    fn the_scale_counts_the_rigid_motion() {
        let mut problem = Problem::new();
        let body = problem.add_body(2).unwrap();
        let (ptr, col, val) = ([0, 1, 3], [0, 0, 1], [1.0, -1.0, 1.0]);
        let spring = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
        problem.set_stiffness(body, spring).unwrap();
        problem.set_load(body, &[3.0, 1.0]).unwrap();
        let rows = RowsInput {
            ptr: &[0, 1, 2],
            body: None,
            dof: &[0, 1],
            val: &[1.0, -2.0],
            rhs: Some(&[1.0, 2.0]),
        };
        problem.add_rows(RowKind::Inequality, rows).unwrap();
        judging(&mut problem, |judge| {
            for (x, alpha) in [([0.0, 0.0], 0.0), ([2.0, 0.0], -7.0), ([0.5, 1.5], 2.0)] {
                let u = judge.recover(&judge.deformed(&x).unwrap(), &x, &[alpha]).u;
                let moved = [0, 1].map(|i| judge.ready.rows.matrix.row_dot(i, &u));
                let expected = norm(&moved) + norm(&judge.scaled.gaps.dual).min(norm(&moved));
                let scale = judge.scale(&x, &[alpha]).unwrap();
                assert!((scale - expected).abs() <= 1e-14 * expected, "{alpha}");
            }
        });
    }
}
