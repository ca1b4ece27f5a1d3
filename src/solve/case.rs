//! One island with the data of the host.

use std::borrow::Cow;

use crate::body::{Kept, Locals};
use crate::certificate::{Data, Lend, Load};
use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::vector::{self, norm_max};
use crate::model::SolvedModel;
use crate::platform::memory::zeros;
use crate::setup::{Island, Prepared, Ready};
use crate::solve::local::Along;
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
        let fastest = vector::fastest(&v);
        let body = self.model.offsets[1..].partition_point(|end| *end <= fastest);
        Ok((v, body, fastest - self.model.offsets[body]))
    }

    /// The bodies of the island.
    pub fn locals(&self) -> Result<Locals<'a>> {
        self.prepared.locals(self.model, self.ready)
    }

    /// `R a`, over the unknowns of all bodies: for the host.
    pub fn rigid_motion(&self, a: &[f64]) -> Result<Vec<Vec<f64>>> {
        let (bodies, dual) = (self.locals()?, &self.ready.dual);
        let (_, v) = bodies.make(|p| Along { a: Some(a[dual.modes_of(p)].to_vec()) }, ())?;
        Ok(bodies.bring(&v)?.into_iter().map(Cow::into_owned).collect())
    }

    /// The loads of the bodies.
    pub fn loads(&self) -> Result<Kept<Load>> {
        let (locals, bodies) = (self.locals()?, &self.island().bodies);
        let whole = |k: usize| Lend { whole: self.prepared.load_of_whole(self.model, bodies[k]) };
        let given = self.prepared.loads(self.model, (bodies, &locals))?;
        Ok(locals.make(whole, &given)?.1)
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
