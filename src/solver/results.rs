//! What the host reads after a solve, and the operators it may validate.

use crate::certificate::{Certificate, RowJudgement};
use crate::constraints::{RowKind, RowSet};
use crate::error::{Error, Kind, Result};
use crate::linalg::Operator;
use crate::platform::memory::zeros;
use crate::solver::call::Ends;
use crate::solver::certifier::{Ending, Recovered};
use crate::solver::diagnosis::in_stack;
use crate::solver::islands::Members;
use crate::solver::problem::{Inverse, Problem};
use crate::solver::report::{Report, RowState};
use crate::solver::setup::Ready;
use crate::solver::solve::Solved;

/// The answer of the last solve, in the units of the host. Not a number where a group of bodies has none.
pub(super) struct Answer {
    pub report: Report,
    u: Vec<f64>,
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
    /// Amplitudes of the rigid modes of every body.
    alpha: Vec<Vec<f64>>,
    /// c + C lambda - B u, length.
    gaps: Vec<f64>,
    states: Vec<RowState>,
    /// Estimated relative error of the forces on every body, no unit.
    pub force_errors: Vec<f64>,
    /// Islands without an answer.
    pub failed: Vec<bool>,
}

/// What was made of the answer once somebody has asked.
#[derive(Default)]
pub(super) struct Asked {
    /// Motions that it leaves open, over the modes of one island each.
    pub open_motions: Option<Vec<(usize, Vec<f64>)>>,
    /// Forces of the rows of one kind, or of both, on all bodies.
    reactions: Option<(Option<RowKind>, Vec<f64>)>,
}

impl Answer {
    /// None where no island has an answer.
    pub fn new(problem: &Problem, ends: Ends) -> Result<Option<Self>> {
        if ends.iter().all(std::result::Result::is_err) {
            return Ok(None);
        }
        let counts = problem.counts();
        let rows = [&problem.contact, &problem.equalities];
        let alone = [RowKind::Inequality, RowKind::Equality]
            .map(|kind| rows[kind as usize].forces_without_entries(kind));
        let [lambda, mu] = alone.map(Iterator::collect);
        let mut answer = Self {
            report: Report::new(problem)?,
            u: zeros(counts.dofs, "an answer")?,
            lambda,
            mu,
            alpha: vec![Vec::new(); counts.bodies],
            gaps: Vec::new(),
            states: vec![RowState::Open; counts.rows],
            force_errors: vec![f64::NAN; counts.bodies],
            failed: ends.iter().map(std::result::Result::is_err).collect(),
        };
        let mut all: Option<Certificate> = None;
        for (ready, end) in problem.ready()?.islands.iter().zip(ends) {
            match end {
                Ok(solved) => {
                    let own = ready.island.named(solved.ending.judgement.certificate);
                    match &mut all {
                        None => all = Some(own),
                        Some(all) => all.merge(&own),
                    }
                    answer.take_in(problem, ready, solved);
                }
                Err(_) => answer.leave_out(problem, ready),
            }
        }
        answer.report.body.take_if(|_| answer.failed.len() == 1);
        let mut certificate = all.unwrap_or_default();
        certificate.energy += answer.take_in_rows_alone(problem);
        (answer.report.certificate, answer.report.energy) = (certificate, certificate.energy);
        let gap = |i: usize| problem.contact.open_gap(i, &answer.u, answer.lambda[i]);
        answer.gaps = (0..counts.rows).map(gap).collect();
        answer.report.active = answer.states.iter().filter(|state| **state == RowState::Closed).count();
        Ok(Some(answer))
    }

    /// The answer of an island, and what it took.
    fn take_in(&mut self, problem: &Problem, ready: &Ready, solved: Solved) {
        let Solved { ending, outcome, finished, unheld, .. } = solved;
        let Ending { solution, recovered, judgement, .. } = ending;
        let island = &ready.island;
        let states = states(ready, &recovered, &judgement.contact);
        island.scatter(problem, &recovered.u, &mut self.u);
        island.contact.scatter(&recovered.lambda, &mut self.lambda);
        island.contact.scatter(&states, &mut self.states);
        island.equalities.scatter(&recovered.mu, &mut self.mu);
        let alpha = ready.dual.amplitudes(&solution.alpha);
        for (k, &p) in island.bodies.iter().enumerate() {
            self.alpha[p] = alpha[ready.dual.modes_of(k)].to_vec();
            self.force_errors[p] = judgement.bodies[k].force_error;
        }
        let report = &mut self.report;
        if outcome > report.outcome {
            (report.outcome, report.body) = (outcome, island.bodies.first().copied());
        }
        report.undetermined += solution.undetermined;
        report.finished |= finished;
        report.unheld = report.unheld.max(unheld);
        report.count(&solution.counts);
        let scale = solution.scale * island.unit.sqrt();
        report.gap_scale = report.gap_scale.hypot(scale);
    }

    /// States of contact rows without entries; gives the energy of the springs among the rows of both kinds.
    fn take_in_rows_alone(&mut self, problem: &Problem) -> f64 {
        let contact = &problem.contact;
        for i in (0..contact.len()).filter(|&i| contact.is_empty_row(i)) {
            self.states[i] = match (self.lambda[i] > 0.0, contact.rhs[i] > 0.0) {
                (true, _) => RowState::Closed,
                (false, true) => RowState::Open,
                (false, false) => RowState::Weak,
            };
        }
        let stored = |rows: &RowSet, forces: &[f64]| {
            let alone = (0..rows.len()).filter(|&i| rows.is_empty_row(i));
            alone.map(|i| 0.5 * rows.compliance[i] * forces[i] * forces[i]).sum::<f64>()
        };
        stored(contact, &self.lambda) + stored(&problem.equalities, &self.mu)
    }

    fn leave_out(&mut self, problem: &Problem, ready: &Ready) {
        let island = &ready.island;
        island.scatter(problem, &vec![f64::NAN; island.unknowns()], &mut self.u);
        let none = |members: &Members| vec![f64::NAN; members.numbers.len()];
        island.contact.scatter(&none(&island.contact), &mut self.lambda);
        island.equalities.scatter(&none(&island.equalities), &mut self.mu);
        island.contact.scatter(&vec![RowState::Unknown; island.contact.numbers.len()], &mut self.states);
        for (k, &p) in island.bodies.iter().enumerate() {
            self.alpha[p] = vec![f64::NAN; ready.dual.modes_of(k).len()];
        }
    }
}

/// By what the certificate takes for zero at every row: closed with a force, open with a gap, weak with neither.
fn states(ready: &Ready, answer: &Recovered, zero: &[RowJudgement]) -> Vec<RowState> {
    let (Recovered { u, lambda, .. }, rows) = (answer, &ready.island.contact.rows);
    let state = |(i, zero): (usize, &RowJudgement)| {
        if lambda[i] > zero.force {
            RowState::Closed
        } else if rows.open_gap(i, u, lambda[i]) > zero.gap {
            RowState::Open
        } else {
            RowState::Weak
        }
    };
    zero.iter().enumerate().map(state).collect()
}

impl Problem {
    fn answer(&self) -> Result<&Answer> {
        let what = "there is no answer yet: solve first (a change of bodies or rows drops the last one)";
        self.answer.as_deref().ok_or_else(|| Error::new(Kind::State, what))
    }

    /// The same for what belongs to one body, whose group must have an answer.
    fn answer_on(&self, body: usize) -> Result<&Answer> {
        self.slot(body)?;
        let answer = self.answer()?;
        if answer.failed[self.ready()?.island_of[body]] {
            let what = "the group of bodies that this one belongs to has no answer";
            return Err(Error::new(Kind::State, what).body(body));
        }
        Ok(answer)
    }

    /// u of one body, length.
    pub fn displacement(&self, body: usize) -> Result<&[f64]> {
        Ok(&self.answer_on(body)?.u[self.range(body)])
    }

    /// u of all bodies one after the other, length.
    pub fn displacements(&self) -> Result<&[f64]> {
        Ok(&self.answer()?.u)
    }

    /// Force of the rows on the body: `-B'lambda`, `-H'mu`, or both, so that `K u = f + r`.
    /// Those on all bodies are kept for the next body.
    pub fn reaction(&mut self, kind: Option<RowKind>, body: usize, r: &mut [f64]) -> Result<()> {
        self.check_length(body, "n", r.len())?;
        self.answer_on(body)?;
        let kept = self.asked.reactions.take().filter(|(of, _)| *of == kind);
        let all = kept.map_or_else(|| self.reactions(kind), |(_, all)| Ok(all))?;
        r.copy_from_slice(&all[self.range(body)]);
        self.asked.reactions = Some((kind, all));
        Ok(())
    }

    /// The same on all bodies one after the other.
    pub fn reactions(&self, kind: Option<RowKind>) -> Result<Vec<f64>> {
        let answer = self.answer()?;
        let mut all = zeros(answer.u.len(), "a reaction")?;
        for (of, multipliers) in [(RowKind::Inequality, &answer.lambda), (RowKind::Equality, &answer.mu)] {
            if kind.is_none_or(|kind| kind == of) {
                self.rows(of).matrix.mul_transposed_add(-1.0, multipliers, &mut all);
            }
        }
        Ok(all)
    }

    /// Amplitudes alpha of the null space of one body, in the basis `null_space` gives.
    pub fn amplitudes(&self, body: usize) -> Result<&[f64]> {
        Ok(&self.answer_on(body)?.alpha[body])
    }

    /// lambda >= 0 or mu, force.
    pub fn multipliers(&self, kind: RowKind) -> Result<&[f64]> {
        let answer = self.answer()?;
        Ok(match kind {
            RowKind::Inequality => &answer.lambda,
            RowKind::Equality => &answer.mu,
        })
    }

    /// Open gaps c + C lambda - B u, length.
    pub fn gaps(&self) -> Result<&[f64]> {
        Ok(&self.answer()?.gaps)
    }

    pub fn active(&self) -> Result<&[RowState]> {
        Ok(&self.answer()?.states)
    }

    fn inverse(&mut self, body: usize) -> Result<&Inverse> {
        self.slot(body)?;
        self.setup()?;
        let missing = || Error::new(Kind::Internal, "the setup left a body without factors");
        self.bodies[body].inverse.as_ref().ok_or_else(missing)
    }

    /// Dimension r of the null space of a body and its basis as the library uses it: n x r column-major,
    /// orthonormal in the metric of diag K / 2^p.
    pub fn null_space(&mut self, body: usize) -> Result<(usize, &[f64])> {
        let basis = &self.inverse(body)?.kplus.null_space;
        Ok((basis.cols, &basis.data))
    }

    /// How far the null space the library found stands apart: softest other motion against the stiffest of it, in the
    /// metric of diag K, both at least 1e-14 of the largest; none where the host gave vectors or coordinates.
    pub fn null_space_gap(&mut self, body: usize) -> Result<Option<f64>> {
        Ok(self.inverse(body)?.kplus.gap)
    }

    /// The r dofs held in K+ of (14)-(15); in that of the host it is not for the library to know.
    pub fn fixing_dofs(&mut self, body: usize) -> Result<&[usize]> {
        if self.slot(body)?.body.operator.is_some() {
            let what = "K+ of this body is the host's: the library holds no dofs in it";
            return Err(Error::new(Kind::Unsupported, what).body(body));
        }
        Ok(&self.inverse(body)?.kplus.fixing)
    }

    /// `y = K_p+ x`, x force, y length.
    pub fn kplus(&mut self, body: usize, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.check_length(body, "n", x.len())?;
        self.check_length(body, "n", y.len())?;
        let inverse = self.inverse(body)?;
        inverse.kplus.apply(x, y)?;
        y.iter_mut().for_each(|y| *y /= inverse.unit);
        Ok(())
    }

    /// `y = F x` of (12), compliance of the rows included, contact rows first; x force, y length. Rows that never close
    /// carry no force and move nothing: 0.
    pub fn dual_apply(&mut self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.check_rows(x.len())?;
        self.check_rows(y.len())?;
        self.setup()?;
        let compliance = self.contact.compliance.iter().chain(&self.equalities.compliance);
        y.iter_mut().zip(x).zip(compliance).for_each(|((y, x), c)| *y = c * x);
        for ready in &self.ready()?.islands {
            let rows = &ready.rows;
            let place = |i: usize| in_stack(self, ready, i);
            let mut groups = vec![0.0; rows.groups()];
            for (i, (group, sign)) in rows.grouping.members() {
                groups[group] += sign * x[place(i)] / (ready.island.unit * rows.scale[i]);
            }
            let mut image = zeros(groups.len(), "a product with F")?;
            ready.dual.try_apply(&rows.decoupling.apply_transposed(&groups), &mut image)?;
            let image = rows.decoupling.apply(&image);
            for (i, (group, sign)) in rows.grouping.members() {
                y[place(i)] = sign * image[group] / rows.scale[i];
            }
        }
        Ok(())
    }

    /// `d = B K+ f - c` of (13), contact rows first, length; -infinity for rows that never close.
    pub fn dual_rhs(&mut self, d: &mut [f64]) -> Result<()> {
        self.check_rows(d.len())?;
        self.setup()?;
        let gaps = self.contact.rhs.iter().chain(&self.equalities.rhs);
        d.iter_mut().zip(gaps).for_each(|(d, c)| *d = -c);
        for ready in &self.ready()?.islands {
            let rows = &ready.rows;
            let mut load = ready.island.loads(self)?;
            load.iter_mut().for_each(|f| *f /= ready.island.unit);
            let moved = ready.moved(self.threads(), &load)?;
            let moved = rows.decoupling.apply(&ready.dual.rhs(&moved, &vec![0.0; rows.groups()]));
            for (i, (group, sign)) in rows.grouping.members() {
                d[in_stack(self, ready, i)] += sign * moved[group] / rows.scale[i];
            }
        }
        Ok(())
    }

    fn check_rows(&self, m: usize) -> Result<()> {
        let expected = self.contact.len() + self.equalities.len();
        if m == expected {
            return Ok(());
        }
        let what = format!("the problem has {expected} rows, not {m}");
        Err(Error::argument("m", what).value(m as f64).limit(expected as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{RowsInput, SparseInput, Storage};

    /// Two springs 1 against walls at 1.
    fn two_springs() -> Problem {
        let mut problem = Problem::new();
        for _ in 0..2 {
            let body = problem.add_body(1).unwrap();
            let k = SparseInput { ptr: &[0, 1], col: &[0], val: &[1.0], storage: Storage::Lower };
            problem.set_stiffness(body, k).unwrap();
        }
        let walls =
            RowsInput { ptr: &[0, 1, 2], body: None, dof: &[0, 1], val: &[1.0; 2], rhs: Some(&[1.0; 2]) };
        problem.add_rows(RowKind::Inequality, walls).unwrap();
        problem
    }

    /// The options ask for another setup, or for one that the memory does not allow.
    #[test]
    fn an_answer_outlives_the_check_of_another_under_other_options() {
        let mut problem = two_springs();
        problem.set_load(0, &[3.0]).unwrap();
        problem.solve().unwrap();
        let answer = problem.displacements().unwrap().to_vec();
        problem.set_str("method", "paper-feasible").unwrap();
        problem.set_i64("memory_limit", 1).unwrap();
        assert!(problem.check(&answer, &[2.0, 0.0], &[]).unwrap().passed());
        assert!(!problem.check(&answer, &[0.0, 0.0], &[]).unwrap().passed());
        assert_eq!(problem.displacements().unwrap(), answer);
        assert_eq!(problem.solve().unwrap_err().kind, Kind::Memory);
    }

    /// The second spring touches nothing: it has neither forces nor violations.
    #[test]
    fn the_error_of_the_forces_on_a_body_is_known_with_an_answer() {
        let mut problem = two_springs();
        problem.set_load(0, &[3.0]).unwrap();
        assert_eq!(problem.body_facts(0).unwrap().force_error, None);
        problem.solve().unwrap();
        assert!(problem.body_facts(0).unwrap().force_error.is_some_and(|error| error <= 1e-12));
        assert_eq!(problem.body_facts(1).unwrap().force_error, Some(0.0));
        assert_eq!(problem.active().unwrap(), [RowState::Closed, RowState::Open]);
    }

    /// Loads 3 and 2, then 5 and 2.
    #[test]
    fn the_force_on_a_body_is_that_of_the_present_answer_and_of_the_kind_asked_for() {
        let mut problem = two_springs();
        let reaction = |problem: &mut Problem, kind, body| {
            let mut r = [7.0];
            problem.reaction(kind, body, &mut r).map(|()| r[0])
        };
        let (all, contact, ties) = (None, Some(RowKind::Inequality), Some(RowKind::Equality));
        assert_eq!(reaction(&mut problem, all, 0).unwrap_err().kind, Kind::State);
        for load in [3.0, 5.0] {
            problem.set_load(0, &[load]).unwrap();
            problem.set_load(1, &[2.0]).unwrap();
            problem.solve().unwrap();
            for (kind, expected) in
                [(all, [1.0 - load, -1.0]), (ties, [0.0; 2]), (contact, [1.0 - load, -1.0])]
            {
                for body in [0, 1] {
                    let found = reaction(&mut problem, kind, body).unwrap();
                    assert!((found - expected[body]).abs() < 1e-12, "{kind:?} {body}: {found}");
                }
            }
        }
    }
}
