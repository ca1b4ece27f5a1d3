//! One island with the data of the host.

use crate::certificate::{BodyData, Data};
use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::norm_max;
use crate::linalg::ByBody;
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
    pub fn fastest(&self, own: &ByBody) -> Result<(Vec<f64>, usize, usize)> {
        let mut v = zeros(self.model.sizes().dofs, "a motion")?;
        self.island().scatter(self.model, own, &mut v);
        let largest = norm_max(&v);
        v.iter_mut().for_each(|v| *v /= largest);
        let fastest = (0..v.len()).fold(0, |best, i| if v[i].abs() > v[best].abs() { i } else { best });
        let body = self.model.offsets[1..].partition_point(|end| *end <= fastest);
        Ok((v, body, fastest - self.model.offsets[body]))
    }

    /// The data of the island for the certificate.
    pub fn data(&self) -> Result<Data<'a>> {
        let missing = || Error::new(Kind::State, "a body has not been set up");
        let (model, island) = (self.model, self.island());
        let mut bodies = Vec::with_capacity(island.bodies.len());
        for &p in &island.bodies {
            let body = &model.bodies[p].body;
            let inverse = self.prepared.inverse(model, p).ok_or_else(missing)?;
            bodies.push(BodyData {
                stiffness: body.k().ok_or_else(missing)?,
                load: body.load.as_deref(),
                whole: self.prepared.load_of_whole(model, p),
                null_space: &inverse.kplus.null_space,
                soft: inverse.kplus.is_soft(),
                unit: body.without(island.unit),
                grounded: &inverse.grounded,
            });
        }
        let (limit, accuracy) = (model.settings.certificate_tolerance, model.settings.data_accuracy);
        let [contact, equalities, tangential] = RowKind::ALL.map(|kind| &island.members(kind).rows);
        let (ranges, touched, nodes) = (&island.ranges, &*island.touched, &island.friction.nodes[..]);
        Ok(Data { bodies, ranges, touched, contact, equalities, tangential, nodes, limit, accuracy })
    }
}
