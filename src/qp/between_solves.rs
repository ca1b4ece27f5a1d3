//! Data that one solve passes to the next, with other loads and gaps: the part of the coarse problems that all faces of
//! one G share, and the directions of its steps with their images.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::linalg::semidefinite::clusters::Blocks;
use crate::linalg::Csr;
use crate::qp::conjugate::Conjugate;
use crate::qp::space::Space;

/// Storage while no method uses the data. A, the blocks of G and the rounding of G must not change.
#[derive(Default)]
pub struct BetweenSolves {
    space: Mutex<Option<Box<Space>>>,
    directions: Mutex<Option<Box<Conjugate>>>,
}

impl BetweenSolves {
    /// Takes the stored space if it belongs to these rows.
    pub fn take_space(&self, g_transposed: &Csr, bounded: &[bool]) -> Option<Space> {
        let fits = |space: &mut Box<Space>| space.bounded == bounded && space.rows.is_of(g_transposed);
        locked(&self.space).take_if(fits).map(|space| *space)
    }

    /// Without modes there is nothing to keep. The next solve does not know the faces of this one, so it has the same bits.
    pub fn keep(&self, mut space: Space) {
        space.by_blocks.iter_mut().for_each(Blocks::forget_face);
        *locked(&self.space) = space.factors.is_some().then(|| Box::new(space));
    }

    pub fn take_directions(&self) -> Option<Conjugate> {
        locked(&self.directions).take().map(|kept| *kept)
    }

    pub fn keep_directions(&self, directions: Conjugate) {
        *locked(&self.directions) = Some(Box::new(directions));
    }
}

pub fn locked<T>(kept: &Mutex<T>) -> MutexGuard<'_, T> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}
