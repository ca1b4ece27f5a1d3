//! Set up, solve the dual, recover the displacements, certify: the paper in order.

use std::cell::Cell;
use std::time::{Duration, Instant};

use crate::certificate::{certify, Answer as AnswerView, Data, Judgement};
use crate::constraints::RowKind;
use crate::dual::Preconditioner;
use crate::error::{Error, Kind, Result};
use crate::linalg::memory::copied;
use crate::linalg::vector::norm;
use crate::linalg::Operator;
use crate::qp::paper::Units;
use crate::qp::{self, Direct, Judge, Qp, Solution, Verdict};
use crate::solver::diagnosis;
use crate::solver::fallback::{solve_dual, Means};
use crate::solver::findings::Findings;
use crate::solver::finish::finish;
use crate::solver::paper::{parameters, HostUnits};
use crate::solver::phases::{Phase, Phases};
use crate::solver::presolve::{presolve, Gaps};
use crate::solver::problem::Problem;
use crate::solver::report::{Outcome, Report};
use crate::solver::response::ByInverse;
use crate::solver::results::{Answer, Asked};
use crate::solver::setup::Ready;
use crate::solver::watch::{Stops, Watch};

impl Problem {
    /// Solves (10)-(11) for the present loads and gaps. An answer is kept even when it is incomplete; the
    /// report says how good it is.
    pub fn solve(&mut self) -> Result<Report> {
        self.watched(|problem, watch| {
            watch.log.begin(problem, "solve")?;
            let done = problem.solve_watched(watch);
            problem.logged("solve", done, watch)
        })
    }

    fn solve_watched(&mut self, watch: &mut Watch) -> Result<Report> {
        let started = Instant::now();
        self.answer = None;
        self.asked = Asked::default();
        let start = self.take_start();
        self.phases = Phases::default();
        self.set_up(watch)?;
        self.set_up_preconditioner(watch)?;
        watch.log.phases(&self.phases(), Phase::DualSolve as usize)?;
        self.log_method(&mut watch.log, start.name())?;
        let solving = Instant::now();
        let ready = self.ready()?;
        let dual = Scaled::new(self, ready, &watch.stops)?;
        let mut judge = Certifier::new(self, ready, &dual)?;
        let f = watch.operator(ready, &dual.gaps.bounded, self.product_threads(ready));
        let (qp, start, direct) = (dual.qp(ready, &f), start.scaled(ready)?, self.direct(ready));
        let solution = match parameters(&self.settings) {
            Some(given) if given.units == Units::Printed => {
                HostUnits::new(self, ready, &dual.gaps, given)?.solve(qp, &start, &mut judge, watch)?
            }
            _ => solve_dual(&Means { settings: &self.settings, direct }, qp, &start, &mut judge, watch)?,
        };
        let (judging, recovering) = (judge.spent, Instant::now());
        let mut ending = judge.ending(solution)?;
        let finished = self.settings.finish == c"direct" && finish(&judge, qp, direct, &mut ending)?;
        let Ending { solution, recovered, judgement } = ending;
        let outcome = self.outcome(ready, &dual, &solution)?;
        let mut answer = Answer::new(self, ready, &solution, recovered, outcome, judgement)?;
        answer.report.finished = finished;
        answer.report.seconds_setup = (solving - started).as_secs_f64();
        answer.report.seconds_solve = solving.elapsed().as_secs_f64();
        self.phases.add(Phase::DualSolve, recovering - solving);
        self.phases.ended(Phase::Recovery, recovering);
        self.phases.move_time(Phase::DualSolve, Phase::Recovery, judging);
        answer.report.phases = self.phases();
        watch.log.phases(&answer.report.phases, usize::MAX)?;
        watch.log.result(&answer.report)?;
        let report = answer.report.clone();
        self.keep(answer);
        self.findings = Some(Findings::of_report(self, &report));
        Ok(report)
    }

    pub(super) fn ready(&self) -> Result<&Ready> {
        self.ready.as_ref().ok_or_else(|| Error::new(Kind::Internal, "the setup left nothing"))
    }

    /// F for the direct method, which stays within the memory limit.
    fn direct<'a>(&self, ready: &'a Ready) -> Direct<'a> {
        let asked = usize::try_from(self.settings.direct_limit).unwrap_or(usize::MAX);
        let most = asked.min(ready.dual.order() + ready.dual.modes());
        let limit = if self.check_more(ready, Direct::bytes(most)).is_ok() { most } else { 0 };
        Direct { entries: &ready.dual, limit }
    }

    /// How the solution ended, or the named reason why there is none.
    fn outcome(&self, ready: &Ready, dual: &Scaled, solution: &Solution) -> Result<Outcome> {
        match &solution.verdict {
            Verdict::Solved => Ok(Outcome::Solved),
            Verdict::Marginal => Ok(Outcome::Marginal),
            Verdict::StepLimit => Ok(Outcome::Iterations),
            Verdict::TimeLimit => Ok(Outcome::Time),
            Verdict::Cancelled => Ok(Outcome::Cancelled),
            Verdict::Stalled => Ok(Outcome::Stalled),
            Verdict::Inaccurate => Ok(Outcome::Inaccurate),
            Verdict::Infeasible { direction, margin } => {
                Err(diagnosis::load_not_held(self, ready, direction, *margin))
            }
            Verdict::Unbounded { p } => {
                let w: Vec<f64> = p.iter().map(|p| -p).collect();
                let w = ready.rows.decoupling.solve_transposed(w);
                diagnosis::gaps_contradict(ready, &dual.gaps, &w).map_or(Ok(Outcome::Stalled), Err)
            }
        }
    }
}

/// Loads and gaps as the dual takes them.
pub(super) struct Scaled {
    /// f / 2^p
    pub load: Vec<f64>,
    pub gaps: Gaps,
    /// `B_p K_p+ f_p` of every body.
    moved: Vec<Vec<f64>>,
    d: Vec<f64>,
    e: Vec<f64>,
}

impl Scaled {
    fn new(problem: &Problem, ready: &Ready, stops: &Stops) -> Result<Self> {
        let mut load = problem.loads()?;
        load.iter_mut().for_each(|f| *f /= ready.unit);
        let gaps = presolve(problem, ready, stops)?;
        let moved = ready.moved(problem.threads(), &load)?;
        let d = ready.dual.rhs(&moved, &gaps.dual);
        let e = ready.dual.resultants(&load);
        Ok(Self { load, gaps, moved, d, e })
    }

    fn qp<'a>(&'a self, ready: &'a Ready, a: &'a dyn Operator) -> Qp<'a> {
        let g_transposed = &ready.dual.coarse;
        let preconditioner = ready.preconditioner.as_ref().map(|(_, m)| m as &dyn qp::Preconditioner);
        Qp { a, b: &self.d, g_transposed, e: &self.e, bounded: &self.gaps.bounded, preconditioner }
    }
}

impl qp::Preconditioner for Preconditioner {
    fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        Preconditioner::apply(self, held, r, z)
    }
}

/// Displacements and multipliers in the units of the host.
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

/// Judges a point of the dual by the certificate of the answer recovered from it.
pub(super) struct Certifier<'a> {
    pub ready: &'a Ready,
    pub scaled: &'a Scaled,
    pub data: Data<'a>,
    pub threads: usize,
    /// V of the certificate, force x length, once it has been asked for.
    work: Cell<Option<f64>>,
    /// The last point accepted, with its answer.
    pub accepted: Option<Accepted>,
    /// Time for answers recovered and certified.
    pub spent: Duration,
}

/// A point (x, alpha) of the dual whose answer has passed.
pub(super) struct Accepted {
    point: (Vec<f64>, Vec<f64>),
    recovered: Recovered,
    judgement: Judgement,
}

/// What a solve ends with.
pub(super) struct Ending {
    pub solution: Solution,
    pub recovered: Recovered,
    pub judgement: Judgement,
}

impl<'a> Certifier<'a> {
    fn new(problem: &'a Problem, ready: &'a Ready, scaled: &'a Scaled) -> Result<Self> {
        let (data, threads) = (problem.data()?, problem.threads());
        let work = Cell::new(None);
        Ok(Self { ready, scaled, data, threads, work, accepted: None, spent: Duration::ZERO })
    }

    /// (17), and lambda = 2^p S L'^-1 x on the rows that carry the multipliers of their groups.
    pub fn recover(&self, x: &[f64], alpha: &[f64]) -> Result<Recovered> {
        Ok(self.with_forces(self.displacement(x, alpha)?, x))
    }

    /// (17): `u = K+ (f - B'x) + R alpha`
    pub fn displacement(&self, x: &[f64], alpha: &[f64]) -> Result<Vec<f64>> {
        let mut load = copied(&self.scaled.load, "a displacement")?;
        self.ready.rows.take_forces(x, &mut load);
        self.ready.displacement(self.threads, &load, alpha)
    }

    /// An answer of u and x; springs without entries have their force from their gap.
    pub fn with_forces(&self, u: Vec<f64>, x: &[f64]) -> Recovered {
        let ready = self.ready;
        let contact = self.data.contact.forces_without_entries(RowKind::Inequality);
        let equalities = self.data.equalities.forces_without_entries(RowKind::Equality);
        let mut lambda: Vec<f64> = contact.chain(equalities).collect();
        let x = ready.rows.decoupling.solve_transposed(x.to_vec());
        for (x, &holder) in x.iter().zip(&self.scaled.gaps.holder) {
            lambda[holder] = x * ready.rows.scale[holder] * ready.unit;
        }
        let mu = lambda.split_off(ready.rows.contact);
        Recovered { u, lambda, mu }
    }

    /// The answer of a solution; that of the point just accepted is there already.
    pub fn ending(&mut self, solution: Solution) -> Result<Ending> {
        let known = self.accepted.take();
        let known = known.filter(|known| known.point.0 == solution.x && known.point.1 == solution.alpha);
        let (recovered, judgement) = match known {
            Some(known) => (known.recovered, known.judgement),
            None => self.certified(&solution.x, &solution.alpha)?,
        };
        Ok(Ending { solution, recovered, judgement })
    }

    fn certified(&self, x: &[f64], alpha: &[f64]) -> Result<(Recovered, Judgement)> {
        let recovered = self.recover(x, alpha)?;
        let judgement = self.judged(&recovered)?;
        Ok((recovered, judgement))
    }

    pub fn judged(&self, recovered: &Recovered) -> Result<Judgement> {
        let Self { data, ready, threads, work, .. } = self;
        certify(data, recovered.view(), &mut ByInverse { data, ready, threads: *threads, work })
    }
}

impl Judge for Certifier<'_> {
    /// `|sum_p |B'_p u_p|| + |c'|`: lengths, whatever the choice of K+.
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64> {
        let distances = self.ready.distances(self.threads, &self.scaled.moved, x, alpha)?;
        Ok(norm(&distances) + norm(&self.scaled.gaps.dual))
    }

    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool> {
        let begun = Instant::now();
        let (recovered, judgement) = self.certified(x, alpha)?;
        self.spent += begun.elapsed();
        let passed = judgement.certificate.passed();
        if passed {
            let point = (copied(x, "forces")?, copied(alpha, "amplitudes")?);
            self.accepted = Some(Accepted { point, recovered, judgement });
        }
        Ok(passed)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::qp::Counts;
    use crate::solver::{Modes, RowKind, RowsInput, SparseInput, Storage};

    /// Springs 1 and 1 pushed by 3 and 1 against walls at 1 and 2, each a body; `work` gets an answer whose first
    /// force, 2, is wrong by the factor 1 + `error`.
    pub fn two_springs(error: f64, work: impl Fn(&mut Certifier, Qp, Direct, &Solution)) {
        let mut problem = Problem::new();
        for load in [3.0, 1.0] {
            let body = problem.add_body(1).unwrap();
            let spring = SparseInput { ptr: &[0, 1], col: &[0], val: &[1.0], storage: Storage::Lower };
            problem.set_stiffness(body, spring).unwrap();
            problem.set_null_space(body, 1, 0, &[], 1, Modes::Exact).unwrap();
            problem.set_load(body, &[load]).unwrap();
        }
        let rows =
            RowsInput { ptr: &[0, 1, 2], body: None, dof: &[0, 1], val: &[1.0, 1.0], rhs: Some(&[1.0, 2.0]) };
        problem.add_rows(RowKind::Inequality, rows).unwrap();
        problem.set_f64("certificate_tolerance", 1e-4).unwrap();
        problem
            .watched(|problem, watch| {
                problem.set_up(watch)?;
                let ready = problem.ready()?;
                let dual = Scaled::new(problem, ready, &watch.stops)?;
                let mut judge = Certifier::new(problem, ready, &dual)?;
                let scale = 3.0;
                let (x, verdict) = (vec![2.0 * (1.0 + error), 0.0], Verdict::Solved);
                let solved =
                    Solution { x, alpha: vec![], undetermined: 0, scale, verdict, counts: Counts::default() };
                work(&mut judge, dual.qp(ready, &ready.dual), problem.direct(ready), &solved);
                Ok(())
            })
            .unwrap();
    }

    #[test]
    fn a_solution_ends_with_its_own_answer_whatever_has_been_accepted_before() {
        two_springs(1e-6, |judge, _, _, solved| {
            assert!(judge.accepts(&solved.x, &solved.alpha).unwrap());
            let other = Solution { x: vec![2.0, 0.0], ..solved.clone() };
            assert_eq!(judge.ending(other).unwrap().recovered.lambda, [2.0, 0.0]);
            assert!(judge.accepts(&solved.x, &solved.alpha).unwrap());
            assert_eq!(judge.ending(solved.clone()).unwrap().recovered.lambda, solved.x);
        });
    }

    /// Springs 1 and 1 at walls: u = (3 - 2, 1 - 0) and gaps (1, 2), all scales 1.
    #[test]
    fn the_scale_is_how_far_bodies_move_along_the_rows_and_their_gaps() {
        two_springs(0.0, |judge, _, _, solved| {
            let scale = judge.scale(&solved.x, &solved.alpha).unwrap();
            assert!((scale - (2f64.sqrt() + 5f64.sqrt())).abs() < 1e-14);
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
        let test = |problem: &mut Problem, watch: &mut Watch| {
            problem.set_up(watch)?;
            let ready = problem.ready()?;
            let dual = Scaled::new(problem, ready, &watch.stops)?;
            let mut judge = Certifier::new(problem, ready, &dual)?;
            for (x, alpha) in [([0.0, 0.0], 0.0), ([2.0, 0.0], -7.0), ([0.5, 1.5], 2.0)] {
                let u = judge.displacement(&x, &[alpha])?;
                let moved = [0, 1].map(|i| ready.rows.matrix.row_dot(i, &u));
                let expected = norm(&moved) + norm(&dual.gaps.dual);
                assert!((judge.scale(&x, &[alpha])? - expected).abs() < 1e-14 * expected, "{alpha}");
            }
            Ok(())
        };
        problem.watched(test).unwrap();
    }
}
