//! The bodies of an island, each where it is.

use std::sync::Arc;

use crate::body::{Local, Locals, Seen};
use crate::certificate::{LoadOfWhole, SizeOfLoad};
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::weighted_norm;
use crate::model::SolvedModel;
use crate::setup::islands::Island;
use crate::setup::prepared::Prepared;
use crate::setup::ready::Ready;

impl Prepared {
    /// The bodies of an island.
    pub fn locals<'a>(&'a self, model: &'a SolvedModel, ready: &'a Ready) -> Result<Locals<'a>> {
        let missing = || Error::new(Kind::State, "a body has not been set up");
        let Island { bodies, touched, unit, .. } = &*ready.island;
        let seen = |(k, &p): (usize, &usize)| {
            if let Some(away) = ready.away(k) {
                return Ok(Seen::Away(away, touched.on(k)));
            }
            let (body, inverse) = (&model.bodies[p].body, self.inverse(model, p).ok_or_else(missing)?);
            Ok(Seen::Here(Local {
                stiffness: body.k().ok_or_else(missing)?,
                null_space: inverse.kplus.null_space()?,
                soft: inverse.kplus.is_soft(),
                unit: body.without(*unit),
                grounded: inverse.grounded.as_deref().ok_or_else(missing)?,
                touched: touched.on(k),
                dual: Some(ready.dual.local(k, *unit, ready.metric.on(k))),
            }))
        };
        Ok(Locals::new(bodies.iter().enumerate().map(seen).collect::<Result<_>>()?, model.threads()))
    }

    /// `Duals::loads`
    pub(super) fn loads_of_hosts(&self, model: &SolvedModel, islands: &[Ready]) -> Result<Vec<LoadOfWhole>> {
        let Some(parts) = &model.parts else { return Ok(Vec::new()) };
        let mut of_parts = vec![LoadOfWhole::default(); model.bodies.len()];
        for ready in islands {
            let bodies = &ready.island.bodies;
            if bodies.iter().all(|&p| parts.only(parts.parts[p].body).is_some()) {
                continue;
            }
            let load =
                |k: usize| SizeOfLoad { load: model.bodies[bodies[k]].body.load.as_deref().map(Arc::from) };
            let sizes = self.locals(model, ready)?.ask(load, ())?;
            bodies.iter().zip(sizes).for_each(|(&p, size)| of_parts[p] = size);
        }
        let of_host = |body: usize| match parts.only(body) {
            Some(_) => LoadOfWhole::default(),
            None => {
                let own = &of_parts[parts.of(body)];
                let sizes: Vec<f64> = own.iter().map(|of| of.size).collect();
                let largest = own.iter().fold(0.0, |most: f64, of| most.max(of.largest));
                LoadOfWhole { size: weighted_norm(&sizes, |_| 1.0), largest }
            }
        };
        Ok((0..parts.offsets.len() - 1).map(of_host).collect())
    }
}
