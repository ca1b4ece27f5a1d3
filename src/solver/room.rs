//! Room for the vectors that a call makes over unknowns, rows and modes. Factors and dual operators are not among them:
//! each is reserved when its size is known.

use crate::error::Result;
use crate::platform::memory::{self, Room, PRODUCTS};
use crate::solver::problem::{BodySlot, Problem};

/// Bytes per unknown: loads, displacements, reactions and the certificate, about 16 vectors at a time.
const PER_DOF: usize = 160;
/// Bytes per row: multipliers, gradients, directions kept with their images, and the certificate.
const PER_ROW: usize = 640 + 2 * size_of::<f64>() * crate::qp::KEPT;
/// Bytes per entry of B and H: the host's rows, the scaled ones and those by bodies, each while it grows.
const PER_ENTRY: usize = 128;
/// Bytes per entry of `G' = B R`, while it grows.
const PER_COARSE_ENTRY: usize = 64;
/// Bytes for the rooms that parts of a call ask for on the thread that called.
const INSIDE: usize = PRODUCTS + (1 << 20);
/// Bytes per rigid mode: vectors of the coarse problem. Its matrices, sparse or dense, have rooms of their own.
const PER_MODE: usize = 320;

impl Problem {
    /// Room for setup, solve and check, for as long as the result is kept.
    pub fn working_room(&self) -> Result<Room> {
        let rows = self.contact.len() + self.equalities.len();
        // A body without stiffness is refused before anything is made of its size.
        let dofs: usize = self.bodies.iter().filter_map(|slot| slot.body.k()).map(|k| k.order()).sum();
        let entries = self.contact.matrix.col.len() + self.equalities.matrix.col.len();
        let modes: usize = self.bodies.iter().map(modes_of).sum();
        let most = self.bodies.iter().map(modes_of).max().unwrap_or(0);
        let coarse_entries = entries.saturating_mul(most).min(rows.saturating_mul(modes));
        let bytes = dofs * PER_DOF + rows * PER_ROW + entries * PER_ENTRY + modes * PER_MODE + PRODUCTS;
        let bytes = bytes.saturating_add(coarse_entries.saturating_mul(PER_COARSE_ENTRY));
        memory::room_with(bytes, INSIDE, "the vectors of a solve")
    }

    /// The same for a call that needs the setup alone: none where it is there.
    pub fn setup_room(&self) -> Result<Option<Room>> {
        if self.is_set_up() {
            return Ok(None);
        }
        self.working_room().map(Some)
    }

    /// Room for so many more rows: those that are there may move while their arrays grow.
    pub fn room_for_rows(&self, rows: usize, entries: usize) -> Result<Room> {
        let present = self.contact.matrix.col.len().max(self.equalities.matrix.col.len());
        let bytes = present.saturating_add(entries).saturating_mul(PER_ENTRY);
        memory::room(bytes.saturating_add(rows.saturating_mul(PER_ENTRY)), "constraint rows")
    }
}

/// Dimension of the null space of a body; six rigid motions where it has not been found yet.
fn modes_of(slot: &BodySlot) -> usize {
    let found = slot.inverse.as_ref().map(|inverse| inverse.kplus.null_space.cols);
    let given = slot.body.null_space.as_ref().map(|given| given.vectors.cols);
    found.or(given).unwrap_or(6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{SparseInput, Storage};

    /// Six dense matrices over the modes of all bodies, of which so many have not been found yet, would take 700 GB.
    #[test]
    fn the_room_of_many_bodies_grows_with_their_number() {
        let mut problem = Problem::new();
        for body in 0..20_000 {
            problem.add_body(1).unwrap();
            let k = SparseInput { ptr: &[0, 1], col: &[0], val: &[1.0], storage: Storage::Lower };
            problem.set_stiffness(body, k).unwrap();
        }
        assert!(problem.working_room().is_ok());
    }
}
