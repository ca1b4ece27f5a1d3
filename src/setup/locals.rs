//! The bodies of an island, each where it is.

use std::collections::HashMap;
use std::sync::{Arc, PoisonError};

use crate::body::{HostLoad, Kept, Local, Locals, Seen};
use crate::certificate::{LoadOfWhole, SizeOfLoad};
use crate::error::{Error, Kind, Result};
use crate::linalg::hash::{hash, START};
use crate::linalg::vector::weighted_norm;
use crate::model::SolvedModel;
use crate::setup::given::without_ranks;
use crate::setup::islands::Island;
use crate::setup::prepared::{Prepared, There};
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
                said: body.null_space.as_deref(),
                soft: inverse.kplus.is_soft(),
                unit: body.without(*unit),
                grounded: inverse.grounded.as_deref().ok_or_else(missing)?,
                touched: touched.on(k),
                dual: Some(ready.dual.local(k, *unit, ready.metric.on(k))),
            }))
        };
        Ok(Locals::new(bodies.iter().enumerate().map(seen).collect::<Result<_>>()?, model.threads()))
    }

    /// The loads of these bodies; one of rank 0 that another rank does not have yet is sent.
    pub fn loads(
        &self,
        model: &SolvedModel,
        (bodies, locals): (&[usize], &Locals),
    ) -> Result<Kept<HostLoad>> {
        let given = |k: usize| model.bodies[bodies[k]].body.load.as_deref();
        let load = |k: usize| given(k).map(Arc::from);
        let there = |k: usize| self.bodies[bodies[k]].there.as_deref();
        let known = |there: &There| there.load.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let (mut questions, mut new) = (Vec::new(), HashMap::new());
        let given_there = |k: usize| model.bodies[bodies[k]].body.load_there();
        for (k, there) in (0..bodies.len()).filter_map(|k| Some((k, there(k)?))) {
            if given_there(k).is_some() {
                continue;
            }
            let key = given(k).map(|f| hash(START, f.iter().map(|f| f.to_bits())));
            if known(there).is_none_or(|known| known.0 != key) {
                let (asking, name) = there.of.giving_load(load(k));
                questions.push((k, asking));
                new.insert(k, (key, name));
            }
        }
        for (k, answer) in self.ask(questions)?.answers::<()>()? {
            answer.map_err(|e| e.body(bodies[k]))?;
            let of = there(k).ok_or_else(without_ranks)?;
            *of.load.lock().unwrap_or_else(PoisonError::into_inner) = new.remove(&k);
        }
        let name = |k: usize| match given_there(k) {
            Some(load) => Ok(Arc::clone(&load.name)),
            None => Ok(known(there(k).ok_or_else(without_ranks)?).ok_or_else(without_ranks)?.1),
        };
        locals.kept(|k| HostLoad(load(k)), name)
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
            let locals = self.locals(model, ready)?;
            let given = self.loads(model, (bodies, &locals))?;
            let sizes = locals.ask(|_| SizeOfLoad, &given)?;
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
