//! The certificate of an answer that is there, and the problem as the certificate sees it.

use std::cell::Cell;

use crate::certificate::{certify, Answer, BodyData, Certificate, Data, Entry};
use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::solver::islands::Island;
use crate::solver::problem::Problem;
use crate::solver::response::ByInverse;

impl Problem {
    /// The certificate of any answer, also another code's: u over all unknowns, multipliers of contact and
    /// equality rows. A setup that is there serves, whatever the options have become: the last answer stays.
    pub fn check(&mut self, u: &[f64], lambda: &[f64], mu: &[f64]) -> Result<Certificate> {
        if self.ready.is_none() {
            self.setup()?;
        }
        self.check_empty_rows()?;
        self.refresh_gaps();
        let counts = self.counts();
        let lengths = [("n", u, counts.dofs), ("rows", lambda, counts.rows), ("eqs", mu, counts.equalities)];
        for (argument, values, expected) in lengths {
            if values.len() != expected {
                let what = format!("the problem has {expected}, not {}", values.len());
                return Err(Error::argument(argument, what)
                    .value(values.len() as f64)
                    .limit(expected as f64));
            }
        }
        let mut all: Option<Certificate> = None;
        for ready in &self.ready()?.islands {
            let island = &ready.island;
            let own = island.gather(self, u)?;
            let (lambda, mu) = (island.contact.gather(lambda), island.equalities.gather(mu));
            let answer = Answer { u: &own, lambda: &lambda, mu: &mu };
            let (data, work) = (self.data(island)?, Cell::new(None));
            let mut response = ByInverse { data: &data, ready, threads: self.threads(), work: &work };
            let own = island.named(certify(&data, answer, &mut response)?.certificate);
            match &mut all {
                None => all = Some(own),
                Some(all) => all.merge(&own),
            }
        }
        let mut all = all.ok_or_else(|| Error::new(Kind::Internal, "a problem without bodies was set up"))?;
        all.complementarity = self.without_force(lambda, all.complementarity);
        Ok(all)
    }

    /// No force is allowed on a contact row that never closes, and none but its own, `max(0, -k c)`, on one without entries
    /// that does.
    fn without_force(&self, lambda: &[f64], worst: Entry) -> Entry {
        let rows = &self.contact;
        let wrong = |(i, force): (usize, f64)| {
            let alone = rows.is_empty_row(i) && (rows.rhs[i] > 0.0 || rows.compliance[i] > 0.0);
            let off = (lambda[i] - force).abs();
            let known = alone || !rows.is_finite(i);
            known && !(off <= self.settings.certificate_tolerance * force)
        };
        match rows.forces_without_entries(RowKind::Inequality).enumerate().find(|row| wrong(*row)) {
            Some((row, _)) => Entry { figure: f64::INFINITY, ratio: f64::INFINITY, place: Some(row) },
            None => worst,
        }
    }

    /// An island as the certificate sees it; null spaces must have been found.
    pub(super) fn data<'a>(&'a self, island: &'a Island) -> Result<Data<'a>> {
        let missing = || Error::new(Kind::State, "a body has not been set up");
        let mut bodies = Vec::with_capacity(island.bodies.len());
        for (&p, range) in island.bodies.iter().zip(&island.ranges) {
            let slot = &self.bodies[p];
            let inverse = slot.inverse.as_ref().ok_or_else(missing)?;
            bodies.push(BodyData {
                start: range.start,
                stiffness: slot.body.k().ok_or_else(missing)?,
                load: slot.body.load.as_deref(),
                null_space: &inverse.kplus.null_space,
                unit: slot.body.without(island.unit),
                grounded: &inverse.grounded,
            });
        }
        let limit = self.settings.certificate_tolerance;
        let (contact, equalities) = (&island.contact.rows, &island.equalities.rows);
        Ok(Data { bodies, contact, equalities, limit })
    }
}
