//! The bodies that are solved in place of the host's. A connected component of the K of a body is a body of its own: a
//! body of the host is a numbering and a name. Bodies given by elements are cut into pieces, which equality rows glue together (the
//! secondary decomposition of the paper, Section 2). The host sees only its bodies. Unknowns of several bodies to which the
//! host gave the same number are also glued; their rows join bodies of the host, and the certificate includes them.

mod back;
mod bodies;
mod components;
mod copies;
mod rows;

use std::sync::Arc;

use crate::body::BodyElsewhere;
use crate::error::Result;
use crate::model::{GivenBody, HostModel, Revisions, SolvedModel};

pub use back::of_host;
use bodies::{loads, parts, touched};
pub use components::{Components, Connected};
use copies::Copies;
use rows::rows;

/// The problem of a host with parts in place of its bodies.
pub struct Decomposition {
    /// The model that is solved. Its revisions are those of the host's model.
    pub model: SolvedModel,
    /// For bodies that are cut.
    copies: Vec<Option<Copies>>,
    of: Revisions,
    /// All parts have their matrices.
    pub has_matrices: bool,
}

impl Decomposition {
    /// Some body has several parts, or unknowns of several bodies are glued; otherwise the host's model itself is solved.
    pub fn is_due(host: &HostModel, connected: &Connected) -> bool {
        let has_parts =
            |GivenBody { body, .. }: &GivenBody| body.assembled().is_some() || body.given_there().is_some();
        host.has_joints() || !connected.all_connected() || host.bodies.iter().any(has_parts)
    }

    pub fn of(host: &HostModel, connected: &Connected) -> Result<Self> {
        let joints = host.joints()?;
        let touched = touched(host, &joints)?;
        let (bodies, mut all) = parts(host, connected, &|j| touched[j])?;
        all.equalities = host.equalities.len();
        all.joints = joints.iter().map(|joint| joint.number).collect();
        let copies =
            (0..host.bodies.len()).map(|body| Copies::of(host, &all, body).map_err(|e| e.body(body)));
        let mut copies = copies.collect::<Result<Vec<_>>>()?;
        let mut model = SolvedModel::new();
        model.offsets.clone_from(&all.starts);
        model.bodies = bodies;
        (model.contact, model.equalities, model.friction) = rows(host, &joints, &all, &copies)?;
        copies.iter_mut().enumerate().for_each(|(body, own)| drop(own.take_if(|_| !all.is_cut(body))));
        model.revisions = host.revisions;
        model.given_by.clone_from(&host.given_by);
        model.parts = Some(Arc::new(all));
        let mut made = Self { model, copies, of: host.revisions, has_matrices: true };
        made.refresh(host)?;
        Ok(made)
    }

    /// The parts of bodies without rows: rows of other ranks touch unknowns, too. `places`: those they touch, among all unknowns.
    pub fn of_part(
        host: &HostModel,
        connected: &Connected,
        places: impl Iterator<Item = usize>,
    ) -> Result<Self> {
        let mut touched = touched(host, &host.joints()?)?;
        places.for_each(|j| touched[j] = true);
        let (bodies, all) = parts(host, connected, &|j| touched[j])?;
        let copies = host.bodies.iter().map(|_| None).collect();
        let mut model = SolvedModel::new();
        model.offsets.clone_from(&all.starts);
        (model.bodies, model.parts) = (bodies, Some(Arc::new(all)));
        Ok(Self { model, copies, of: host.revisions, has_matrices: true })
    }

    /// Takes over the loads of the host.
    pub fn refresh_loads(&mut self, host: &HostModel) -> Result<()> {
        let Some(parts) = self.model.parts.clone() else { return Ok(()) };
        loads(host, &parts, &self.copies, &mut self.model)
    }

    /// Whether bodies and rows are still those of the host, and no load acts on an unknown that is in no part.
    pub fn is_of(&self, host: &HostModel) -> bool {
        let loose = self.model.parts.iter().flat_map(|parts| &parts.loose);
        self.of == host.revisions && loose.into_iter().all(|&j| host.load(j) == 0.0)
    }

    /// Nothing but the loads remains of parts that other ranks have.
    pub fn let_go(&mut self, gone: Vec<(usize, Arc<BodyElsewhere>)>) {
        self.has_matrices &= gone.is_empty();
        gone.into_iter().for_each(|(part, there)| self.model.bodies[part].body.let_go(there));
    }

    /// Takes over data that may change without a new setup: options, loads, right-hand sides, laws of friction.
    pub fn refresh(&mut self, host: &HostModel) -> Result<()> {
        let Some(parts) = self.model.parts.clone() else { return Ok(()) };
        self.model.settings = host.settings.clone();
        self.model.contact.rhs.copy_from_slice(&host.contact.rhs);
        self.model.equalities.rhs[..parts.equalities].copy_from_slice(&host.equalities.rhs);
        self.model.friction.rows.rhs.copy_from_slice(&host.friction.rows.rhs);
        self.model.friction.nodes.clone_from(&host.friction.nodes);
        self.refresh_loads(host)
    }
}
