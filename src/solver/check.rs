//! The certificate of an existing answer.

use std::sync::Arc;

use crate::body::{Home, Token};
use crate::certificate::{self, certify, Certificate, Entry};
use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::model::HostModel;
use crate::solve::{named, Case};
use crate::solver::call::Call;
use crate::solver::decomposed::{of_host, solved};
pub use crate::solver::joints::left_over;
use crate::solver::joints::with_glue;
use crate::solver::problem::Problem;

/// An answer over all unknowns and rows.
#[derive(Clone, Copy)]
pub struct Candidate<'a> {
    /// n, length.
    pub u: &'a [f64],
    /// m, force.
    pub lambda: &'a [f64],
    /// q, force.
    pub mu: &'a [f64],
    /// t, force.
    pub tangential: &'a [f64],
}

impl Problem {
    /// The certificate of any answer without friction, for example the answer of another code.
    pub fn check(&mut self, u: &[f64], lambda: &[f64], mu: &[f64]) -> Result<Certificate> {
        let tangential = vec![0.0; self.model.friction.rows.len()];
        self.check_with_friction(Candidate { u, lambda, mu, tangential: &tangential })
    }

    /// The certificate of any answer: u over all unknowns, multipliers of contact, equality and tangential rows; the
    /// forces of glue are chosen for the best equilibrium. An existing setup is used even if the options have changed:
    /// the last answer stays valid.
    pub fn check_with_friction(&mut self, answer: Candidate) -> Result<Certificate> {
        self.checked_together(Call::Check, |problem| problem.check_lengths(answer))?;
        match self.check_together(answer)? {
            Some(certificate) => Ok(certificate),
            None => self.check_alone_with(answer, &|_| None, |host, u, unknowns| {
                let left = left_over(host, u)?;
                Ok(unknowns.iter().map(|j| left[*j]).collect())
            }),
        }
    }

    fn check_lengths(&self, Candidate { u, lambda, mu, tangential }: Candidate) -> Result<()> {
        let counts = self.model.sizes();
        let lengths = [
            ("n", u, counts.dofs),
            ("rows", lambda, counts.rows),
            ("eqs", mu, counts.equalities),
            ("nodes", tangential, counts.tangential),
        ];
        for (argument, values, expected) in lengths {
            if values.len() != expected {
                let what = format!("the problem has {expected}, not {}", values.len());
                let error = Error::argument(argument, what);
                return Err(error.value(values.len() as f64).limit(expected as f64));
            }
        }
        Ok(())
    }

    /// u of bodies here; `there`: what that of a part is called on the rank that has it. `left`: `f - K u` of some unknowns.
    pub(super) fn check_alone_with(
        &mut self,
        Candidate { u, lambda, mu, tangential }: Candidate,
        there: &dyn Fn(usize) -> Option<Arc<Token>>,
        left: impl FnOnce(&HostModel, &[f64], &[usize]) -> Result<Vec<f64>>,
    ) -> Result<Certificate> {
        if self.prepared.duals(&self.model).is_none() {
            self.setup()?;
        }
        self.decompose()?;
        let Self { model: host, decomposition, prepared, .. } = self;
        let model = solved(host, decomposition);
        let told = |error| of_host(host, decomposition, error);
        let lengths = prepared.lengths(model).map_err(told)?;
        lengths.check_empty_rows().map_err(told)?;
        prepared.refresh(&lengths)?;
        let mu = &with_glue(host, |unknowns| left(host, u, unknowns), [lambda, mu, tangential])?[..];
        let starts = host.starts();
        let own = |part: usize| match (there(part), &model.parts) {
            (Some(token), _) => Home::There(token),
            (None, None) => Home::Here(u[model.range(part)].to_vec()),
            (None, Some(parts)) => {
                Home::Here(parts.gather(part, &u[starts[parts.parts[part].body]..]).collect())
            }
        };
        let mut all: Option<Certificate> = None;
        for ready in &prepared.done(model)?.islands {
            let island = &ready.island;
            let equalities = ready.whole().map_or(&island.equalities, |whole| &whole.island.equalities);
            let (lambda, mu) = (island.contact.gather(lambda), equalities.gather(mu));
            let tangential = island.friction.tangential.gather(tangential);
            let case = Case { model, prepared, ready, method: None };
            let data = case.data(case.loads()?)?;
            let own = data.bodies.placed(island.bodies.iter().map(|part| own(*part)).collect())?;
            let (u, at_rows) = (&own.of, &own.at_rows[..]);
            let answer =
                certificate::Candidate { u, at_rows, lambda: &lambda, mu: &mu, tangential: &tangential };
            let judged = match ready.whole() {
                None => certify(&data, answer)?,
                Some(whole) => whole.judged(model, &data, answer)?,
            };
            let own = named(model, ready, judged.certificate);
            match &mut all {
                None => all = Some(own),
                Some(all) => all.merge(&own),
            }
        }
        let mut all = all.ok_or_else(|| Error::new(Kind::Internal, "a problem without bodies was set up"))?;
        all.complementarity = without_force(host, lambda, all.complementarity);
        Ok(all)
    }
}

/// A contact row that never closes must have no force; a contact row without entries must have its own force, `max(0, -k
/// c)`.
fn without_force(host: &HostModel, lambda: &[f64], worst: Entry) -> Entry {
    let rows = &host.contact;
    let wrong = |(i, force): (usize, f64)| {
        let alone = rows.is_empty_row(i) && (rows.rhs[i] > 0.0 || rows.compliance[i] > 0.0);
        let off = (lambda[i] - force).abs();
        let known = alone || !rows.is_finite(i);
        known && !(off <= host.settings.certificate_tolerance * force)
    };
    match rows.forces_without_entries(RowKind::Inequality).enumerate().find(|row| wrong(*row)) {
        Some((row, _)) => Entry { figure: f64::INFINITY, ratio: f64::INFINITY, place: Some(row), rank: 0 },
        None => worst,
    }
}
