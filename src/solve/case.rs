//! One island with the data of the host.

use std::sync::Arc;

use crate::body::{Kept, Local, Locals};
use crate::certificate::{Data, Lend, Load};
use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::norm_max;
use crate::model::SolvedModel;
use crate::platform::memory::zeros;
use crate::setup::{Island, Prepared, Ready};
use crate::solve::method::DualMethod;

/// All inputs for the solution of one island: the data of the host and the results of setup.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    pub model: &'a SolvedModel,
    pub prepared: &'a Prepared,
    pub ready: &'a Ready,
    /// The method for option `method` other than `proportioning`.
    pub method: Option<&'a dyn DualMethod>,
}

impl<'a> Case<'a> {
    pub fn island(&self) -> &'a Island {
        &self.ready.island
    }

    pub fn threads(&self) -> usize {
        self.model.threads()
    }

    /// Some node has friction.
    pub fn has_friction(&self) -> bool {
        self.island().has_friction()
    }

    /// A motion of the island over all unknowns of the model, its largest entry 1 in size, and the body and dof of this entry.
    pub fn fastest<O: AsRef<[f64]>>(
        &self,
        own: impl IntoIterator<Item = O>,
    ) -> Result<(Vec<f64>, usize, usize)> {
        let mut v = zeros(self.model.sizes().dofs, "a motion")?;
        self.island().scatter(self.model, own, &mut v);
        let largest = norm_max(&v);
        v.iter_mut().for_each(|v| *v /= largest);
        let fastest = (0..v.len()).fold(0, |best, i| if v[i].abs() > v[best].abs() { i } else { best });
        let body = self.model.offsets[1..].partition_point(|end| *end <= fastest);
        Ok((v, body, fastest - self.model.offsets[body]))
    }

    /// The bodies of the island.
    pub fn locals(&self) -> Result<Locals<'a>> {
        let missing = || Error::new(Kind::State, "a body has not been set up");
        let Self { model, prepared, ready, .. } = *self;
        let Island { bodies, touched, unit, .. } = &*ready.island;
        let local = |(k, &p): (usize, &usize)| {
            let (body, inverse) = (&model.bodies[p].body, prepared.inverse(model, p).ok_or_else(missing)?);
            Ok(Local {
                stiffness: body.k().ok_or_else(missing)?,
                null_space: &inverse.kplus.null_space,
                soft: inverse.kplus.is_soft(),
                unit: body.without(*unit),
                grounded: &inverse.grounded,
                touched: touched.on(k),
                dual: Some(ready.dual.local(k, *unit, ready.metric.on(k))),
            })
        };
        let bodies = bodies.iter().enumerate().map(local).collect::<Result<_>>()?;
        Ok(Locals::new(bodies, ready.elsewhere(), self.threads()))
    }

    /// The loads of the bodies.
    pub fn loads(&self) -> Result<Kept<Load>> {
        let load = |k: usize| {
            let p = self.island().bodies[k];
            let own = self.model.bodies[p].body.load.as_deref().map(Arc::from);
            Lend { load: Load { own, whole: self.prepared.load_of_whole(self.model, p) } }
        };
        Ok(self.locals()?.make(load, ())?.1)
    }

    /// The data of the island for the certificate, with these loads.
    pub fn data(&self, loads: Kept<Load>) -> Result<Data<'a>> {
        let (model, island) = (self.model, self.island());
        let (limit, accuracy) = (model.settings.certificate_tolerance, model.settings.data_accuracy);
        let [contact, equalities, tangential] = RowKind::ALL.map(|kind| &island.members(kind).rows);
        Ok(Data {
            bodies: self.locals()?,
            loads,
            touched: &island.touched,
            contact,
            equalities,
            tangential,
            nodes: &island.friction.nodes,
            limit,
            accuracy,
            unit: None,
        })
    }
}
