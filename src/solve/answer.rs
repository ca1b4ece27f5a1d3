//! Combines the answers of all islands.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::Duration;

use crate::body::{Home, Token};
use crate::certificate::{Certificate, FrictionState, RowJudgement};
use crate::constraints::{RowKind, RowSet};
use crate::error::{Error, Result};
use crate::linalg::Csr;
use crate::model::SolvedModel;
use crate::platform::memory::zeros;
use crate::setup::{Members, Prepared, Ready};
use crate::solve::island::Solved;
use crate::solve::recovery::{Ending, Recovered};
use crate::solve::report::{Outcome, Report, RowState};
use crate::solve::slides::Slide;

/// The answer of the last solve, in the units of the host. Entries are NaN for bodies of an island without an answer.
pub struct Answer {
    pub report: Report,
    /// Without bodies that the host has given on other ranks.
    pub u: Vec<f64>,
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
    /// Tangential forces, (dim, nodes).
    pub tangential: Vec<f64>,
    /// Slips `T u - s_old - C_t lambda_t`, length, (dim, nodes).
    pub slips: Vec<f64>,
    pub friction: Vec<FrictionState>,
    /// Amplitudes of the rigid modes of every body.
    pub alpha: Vec<Vec<f64>>,
    /// c + C lambda - B u, length.
    pub gaps: Vec<f64>,
    pub states: Vec<RowState>,
    /// Estimated relative error of the forces on every body, no unit.
    pub force_errors: Vec<f64>,
    /// Islands without an answer.
    pub failed: Vec<bool>,
    /// G' of each island without resistance that is noise of the data, if it differs.
    pub cleaned: Vec<Option<Box<Csr>>>,
    /// Bodies of the host in islands without an answer.
    pub without: Vec<bool>,
    /// If other ranks have bodies and rows, too.
    pub of_others: Option<Box<OfOthers>>,
}

/// What one rank cannot tell from its own bodies and rows.
#[derive(Clone, Default)]
pub struct OfOthers {
    /// What contact, equality and tangential rows do to unknowns, forces times entries, row after row.
    pub of_rows: Vec<Vec<(usize, f64)>>,
    /// The same of the glue of unknowns with one number.
    pub of_glue: Vec<(usize, f64)>,
    /// `T u - C_t lambda_t` of its nodes, length, (dim, nodes).
    pub reached: Vec<f64>,
}

/// Displacements of bodies that the host has given on other ranks.
#[derive(Default)]
pub struct Stays {
    /// Bodies of the model, and what their displacements are called on their ranks.
    pub names: Vec<(usize, Arc<Token>)>,
    /// Unknowns of the model that rows touch, ascending, and their displacements.
    pub at: Vec<(usize, f64)>,
}

/// The displacements that are known of the unknowns of a model.
pub struct Shown<'a> {
    offsets: &'a [usize],
    starts: Cow<'a, [usize]>,
    u: &'a [f64],
    stays: &'a Stays,
}

impl<'a> Shown<'a> {
    pub fn new(model: &'a SolvedModel, u: &'a [f64], stays: &'a Stays) -> Self {
        Self { offsets: &model.offsets, starts: model.starts(), u, stays }
    }

    /// Of an unknown that rows touch, or of a body here; 0 where only rows that never close touch a body elsewhere.
    pub fn at(&self, j: usize) -> f64 {
        if let Cow::Borrowed(_) = self.starts {
            return self.u[j];
        }
        let body = self.offsets[1..].partition_point(|end| *end <= j);
        if self.starts[body] < self.starts[body + 1] {
            return self.u[self.starts[body] + j - self.offsets[body]];
        }
        let at = self.stays.at.binary_search_by_key(&j, |of| of.0);
        at.map_or(0.0, |at| self.stays.at[at].1)
    }
}

/// How the islands ended, each with an answer or with the named reason why it has none; of the answers only what
/// [`Answer`] keeps.
pub struct Ends<'a> {
    model: &'a SolvedModel,
    prepared: &'a Prepared,
    islands: &'a [Ready],
    answer: Answer,
    /// First displacement of every body in the answer, and the end.
    starts: Cow<'a, [usize]>,
    stays: Stays,
    certificate: Option<Certificate>,
    /// The first reason.
    pub failure: Option<Error>,
    /// Time for recovery and certification.
    pub recovery: Duration,
}

impl<'a> Ends<'a> {
    pub fn new(model: &'a SolvedModel, prepared: &'a Prepared) -> Result<Self> {
        let counts = model.sizes();
        let (rows, starts) = ([&model.contact, &model.equalities], model.starts());
        let alone = [RowKind::Inequality, RowKind::Equality]
            .map(|kind| rows[kind as usize].forces_without_entries(kind));
        let [lambda, mu] = alone.map(Iterator::collect);
        let answer = Answer {
            report: Report::new(model, prepared)?,
            u: zeros(starts[counts.bodies], "an answer")?,
            lambda,
            mu,
            tangential: zeros(counts.tangential, "an answer")?,
            slips: Vec::new(),
            friction: vec![FrictionState::Open; counts.nodes],
            alpha: vec![Vec::new(); counts.bodies],
            gaps: Vec::new(),
            states: vec![RowState::Open; counts.rows],
            force_errors: vec![f64::NAN; counts.bodies],
            failed: Vec::new(),
            cleaned: Vec::new(),
            without: Vec::new(),
            of_others: None,
        };
        let (islands, recovery) = (&prepared.done(model)?.islands[..], Duration::ZERO);
        let stays = Stays::default();
        Ok(Self {
            model,
            prepared,
            islands,
            answer,
            starts,
            stays,
            certificate: None,
            failure: None,
            recovery,
        })
    }

    /// Takes in the end of the next island.
    pub fn take_in(&mut self, end: Result<Solved>) {
        let Self { model, answer, starts, stays, .. } = self;
        let ready = &self.islands[answer.failed.len()];
        answer.failed.push(end.is_err());
        match end {
            Ok(mut solved) => {
                answer.cleaned.push(solved.cleaned.take());
                self.recovery += solved.recovery;
                let own = named(model, ready, solved.ending.judgement.certificate);
                if solved.outcome == Outcome::Marginal && solved.ending.judgement.travelled {
                    answer.report.travelled = own.equilibrium.place;
                }
                match &mut self.certificate {
                    None => self.certificate = Some(own),
                    Some(all) => all.merge(&own),
                }
                answer.take_in(model, ready, solved, (starts, stays));
            }
            Err(error) => {
                answer.cleaned.push(None);
                answer.leave_out(ready, starts);
                self.failure.get_or_insert(error);
            }
        }
    }

    /// Brings displacements of bodies elsewhere where nodes touch them that carry no force: their slips are told, too.
    fn bring_idle(&mut self) -> Result<()> {
        let Self { model, prepared, islands, stays, .. } = self;
        let names: HashMap<usize, &Token> = stays.names.iter().map(|(body, name)| (*body, &**name)).collect();
        let mut is_idle = vec![!names.is_empty(); model.friction.len()];
        islands
            .iter()
            .flat_map(|ready| &ready.island.friction.numbers)
            .for_each(|node| is_idle[*node] = false);
        let mut unknowns = BTreeMap::<usize, Vec<u32>>::new();
        for node in (0..is_idle.len()).filter(|node| is_idle[*node]) {
            let rows = model.friction.nodes[node].rows();
            for (j, _) in rows.flat_map(|row| model.friction.rows.matrix.row(row)) {
                let body = model.offsets[1..].partition_point(|end| *end <= j);
                if names.contains_key(&body) {
                    unknowns.entry(body).or_default().push((j - model.offsets[body]) as u32);
                }
            }
        }
        let of = &prepared.done(model)?.island_of;
        for (body, at) in unknowns {
            let ready = &islands[of[body]];
            let k = ready.island.bodies.iter().position(|p| *p == body).unwrap_or(0);
            let values = prepared.locals(model, ready)?.values(k, names[&body], at.clone())?;
            let unknowns = at.into_iter().map(|dof| model.offsets[body] + dof as usize);
            stays.at.extend(unknowns.zip(values));
        }
        Ok(())
    }

    /// The answer, and what stays on other ranks; none if no island has one.
    pub fn answer(mut self) -> Result<Option<(Answer, Stays)>> {
        self.bring_idle()?;
        let Self { model, mut answer, mut stays, certificate, .. } = self;
        let Some(mut certificate) = certificate else { return Ok(None) };
        stays.at.sort_unstable_by_key(|of| of.0);
        let counts = model.sizes();
        answer.report.body.take_if(|_| answer.failed.len() == 1);
        certificate.energy += answer.take_in_rows_alone(model);
        (answer.report.certificate, answer.report.energy) = (certificate, certificate.energy);
        let shown = Shown::new(model, &answer.u, &stays);
        let gap = |i: usize| model.contact.open_gap_at(i, |j| shown.at(j), answer.lambda[i]);
        answer.gaps = (0..counts.rows).map(gap).collect();
        let count = |state| answer.friction.iter().filter(|own| **own == state).count();
        (answer.report.newton, answer.report.starts) =
            (answer.report.counts.newton, answer.report.counts.starts);
        answer.report.sticking = count(FrictionState::Stick);
        answer.report.slipping = count(FrictionState::Slip);
        answer.slips = answer.slips_of(model, |j| shown.at(j));
        answer.report.active = answer.states.iter().filter(|state| **state == RowState::Closed).count();
        Ok(Some((answer, stays)))
    }
}

impl Answer {
    /// lambda, mu or lambda_t, force.
    pub fn forces(&self, kind: RowKind) -> &[f64] {
        match kind {
            RowKind::Inequality => &self.lambda,
            RowKind::Equality => &self.mu,
            RowKind::Tangential => &self.tangential,
        }
    }

    /// Adds the answer of an island and its work counts.
    fn take_in(
        &mut self,
        model: &SolvedModel,
        ready: &Ready,
        solved: Solved,
        (starts, stays): (&[usize], &mut Stays),
    ) {
        let Solved { ending, u, outcome, finished, unheld, slide, tries, .. } = solved;
        let Ending { solution, recovered, judgement, .. } = ending;
        let island = &ready.island;
        let states = states(ready, &recovered, &judgement.contact);
        for (k, (&p, u)) in island.bodies.iter().zip(u).enumerate() {
            match u {
                Home::Here(u) => self.u[starts[p]..starts[p + 1]].copy_from_slice(&u),
                Home::There(name) => {
                    stays.names.push((p, name));
                    let unknowns = island.touched.on(k).iter().map(|dof| model.offsets[p] + *dof as usize);
                    let values = &recovered.u.at_rows[island.touched.range(k)];
                    stays.at.extend(unknowns.zip(values.iter().copied()));
                }
            }
        }
        island.contact.scatter(&recovered.lambda, &mut self.lambda);
        island.contact.scatter(&states, &mut self.states);
        island.equalities.scatter(&recovered.mu, &mut self.mu);
        island.friction.tangential.scatter(&recovered.tangential, &mut self.tangential);
        for (&number, state) in island.friction.numbers.iter().zip(&judgement.nodes) {
            self.friction[number] = *state;
        }
        let alpha = ready.dual.amplitudes(&solution.alpha);
        for (k, &p) in island.bodies.iter().enumerate() {
            self.alpha[p] = alpha[ready.dual.modes_of(k)].to_vec();
            let judged = ready.whole().map_or(k, |whole| whole.body_of[k]);
            self.force_errors[p] = judgement.bodies[judged].force_error;
        }
        let report = &mut self.report;
        if outcome > report.outcome {
            (report.outcome, report.body) = (outcome, island.bodies.first().copied());
        }
        report.undetermined += solution.undetermined;
        report.finished |= finished;
        report.unheld = report.unheld.max(unheld);
        if let Some(slide) = slide.filter(|own| report.slide.is_none_or(|slide| own.travel > slide.travel)) {
            report.slide = Some(Slide { body: model.name(island.bodies[slide.body]), ..slide });
        }
        report.counts = report.counts + solution.counts;
        report.tries = report.tries + tries;
        let scale = solution.scale * island.unit.sqrt();
        report.gap_scale = report.gap_scale.hypot(scale);
    }

    /// States of contact rows without entries. Returns the energy of the springs of such contact and equality rows.
    fn take_in_rows_alone(&mut self, model: &SolvedModel) -> f64 {
        let contact = &model.contact;
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
        stored(contact, &self.lambda) + stored(&model.equalities, &self.mu)
    }

    /// `T u - s_old - C_t lambda_t` of all tangential rows, for the current displacements.
    pub fn slips_of(&self, model: &SolvedModel, u: impl Fn(usize) -> f64) -> Vec<f64> {
        let rows = &model.friction.rows;
        (0..rows.len()).map(|i| -rows.open_gap_at(i, &u, self.tangential[i])).collect()
    }

    fn leave_out(&mut self, ready: &Ready, starts: &[usize]) {
        let island = &ready.island;
        island.bodies.iter().for_each(|&p| self.u[starts[p]..starts[p + 1]].fill(f64::NAN));
        let none = |members: &Members| vec![f64::NAN; members.numbers.len()];
        island.contact.scatter(&none(&island.contact), &mut self.lambda);
        island.equalities.scatter(&none(&island.equalities), &mut self.mu);
        island.friction.tangential.scatter(&none(&island.friction.tangential), &mut self.tangential);
        island.friction.numbers.iter().for_each(|&node| self.friction[node] = FrictionState::Unknown);
        island.contact.scatter(&vec![RowState::Unknown; island.contact.numbers.len()], &mut self.states);
        for (k, &p) in island.bodies.iter().enumerate() {
            self.alpha[p] = vec![f64::NAN; ready.dual.modes_of(k).len()];
        }
    }
}

/// Replaces the numbers of the island in a certificate by those of the host; rows that join pieces have no number.
pub fn named(model: &SolvedModel, ready: &Ready, own: Certificate) -> Certificate {
    let mut named = match ready.whole() {
        Some(whole) => whole.island.named(own),
        None => ready.island.named(own),
    };
    if ready.whole().is_none() {
        for entry in [&mut named.equilibrium, &mut named.balance] {
            entry.place.iter_mut().for_each(|body| *body = model.name(*body));
        }
    }
    if let Some(parts) = &model.parts {
        named.equality.place.take_if(|row| *row >= parts.equalities);
    }
    named
}

/// States by the zero tolerances of the certificate: closed if the force exceeds it, open if the gap does, weak if
/// neither does.
fn states(ready: &Ready, answer: &Recovered, zero: &[RowJudgement]) -> Vec<RowState> {
    let (Recovered { u, lambda, .. }, rows) = (answer, &ready.island.contact.rows);
    let u = &u.at_rows[..];
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
