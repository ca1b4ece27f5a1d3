//! Checks that there is memory for the vectors over unknowns, rows and modes that a call allocates. Factors and dual
//! operators are not included: each is reserved when its size is known.

use crate::error::Result;
use crate::model::{GivenBody, SolvedModel, PER_ENTRY};
use crate::platform::memory::{self, Headroom, PRODUCTS, SMALL_MATRICES};
use crate::setup::prepared::Prepared;

/// Bytes per unknown: loads, displacements, reactions and the certificate, about 16 vectors at a time.
const PER_DOF: usize = 160;
/// Bytes per row: multipliers, gradients, stored directions with their images, and the certificate.
const PER_ROW: usize = 640 + 2 * size_of::<f64>() * crate::qp::KEPT;
/// Bytes per entry of `G' = B R`, with room for growth.
const PER_COARSE_ENTRY: usize = 64;
/// Bytes for rooms requested within the call on its own thread.
const INSIDE: usize = SMALL_MATRICES;
/// Bytes per rigid mode: vectors of the coarse problem. Its matrices, sparse or dense, have separate rooms.
const PER_MODE: usize = 320;

impl Prepared {
    /// Room for setup, solve and check while the result is kept.
    pub fn working_headroom(&self, model: &SolvedModel) -> Result<Headroom> {
        let rows = model.contact.len() + model.equalities.len();
        // a body without stiffness will be refused, so its size does not matter; parts have theirs, here or on another rank
        let counts = |given: &&GivenBody| model.parts.is_some() || given.body.k().is_some();
        let dofs: usize = model.bodies.iter().filter(counts).map(|given| given.body.order).sum();
        let entries = model.contact.matrix.col.len() + model.equalities.matrix.col.len();
        let modes_of = |p: usize| self.modes(model, p);
        let modes: usize = (0..model.bodies.len()).map(modes_of).sum();
        let most = (0..model.bodies.len()).map(modes_of).max().unwrap_or(0);
        let coarse_entries = entries.saturating_mul(most).min(rows.saturating_mul(modes));
        let bytes = dofs * PER_DOF + rows * PER_ROW + entries * PER_ENTRY + modes * PER_MODE + PRODUCTS;
        let bytes = bytes.saturating_add(coarse_entries.saturating_mul(PER_COARSE_ENTRY));
        memory::headroom_with(bytes, INSIDE, "the vectors of a solve")
    }

    /// As `working_headroom`, for a call that only needs the setup: none if the setup exists.
    pub fn setup_headroom(&self, model: &SolvedModel) -> Result<Option<Headroom>> {
        if self.is_up_to_date(model) {
            return Ok(None);
        }
        self.working_headroom(model).map(Some)
    }

    /// Dimension of the null space of a body; six if it is not known yet.
    fn modes(&self, model: &SolvedModel, body: usize) -> usize {
        let found = self.inverse(model, body).map(|inverse| inverse.kplus.motions());
        let given = model.bodies[body].body.null_space.as_ref().map(|given| given.vectors.cols);
        found.or(given).unwrap_or(6)
    }
}
