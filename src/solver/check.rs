//! The certificate of an answer that is there, and the problem as the certificate sees it.

use std::cell::Cell;

use crate::certificate::{certify, Answer, BodyData, Certificate, Data};
use crate::error::{Error, Kind, Result};
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
        let answer = Answer { u, lambda, mu };
        let (data, work) = (self.data()?, Cell::new(None));
        let (ready, threads) = (self.ready()?, self.threads());
        let judgement = certify(&data, answer, &mut ByInverse { data: &data, ready, threads, work: &work })?;
        Ok(judgement.certificate)
    }

    /// The problem as the certificate sees it; null spaces must have been found.
    pub(super) fn data(&self) -> Result<Data<'_>> {
        let missing = || Error::new(Kind::State, "a body has not been set up");
        let mut bodies = Vec::with_capacity(self.bodies.len());
        for (slot, range) in self.bodies.iter().zip(self.ranges()) {
            let inverse = slot.inverse.as_ref().ok_or_else(missing)?;
            bodies.push(BodyData {
                start: range.start,
                stiffness: slot.body.k().ok_or_else(missing)?,
                load: slot.body.load.as_deref(),
                null_space: &inverse.kplus.null_space,
                unit: inverse.unit,
                grounded: &inverse.grounded,
            });
        }
        let limit = self.settings.certificate_tolerance;
        let (contact, equalities, without) = (&self.contact, &self.equalities, self.unit());
        Ok(Data { bodies, contact, equalities, without, limit })
    }
}
