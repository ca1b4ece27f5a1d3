//! Data that one solve passes to the next, with other loads and gaps: the part of the coarse problems that all faces of
//! one G share, and the directions of its steps with their images.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::linalg::Csr;
use crate::qp::conjugate::Conjugate;
use crate::qp::space::Space;

/// Storage while no method uses the data. A, the blocks of G and the rounding of G must not change.
#[derive(Default)]
pub struct BetweenSolves {
    space: Mutex<Option<Space>>,
    directions: Mutex<Option<Conjugate>>,
}

impl BetweenSolves {
    /// Takes the stored space if it belongs to these rows.
    pub fn take_space(&self, g_transposed: &Csr, bounded: &[bool]) -> Option<Space> {
        locked(&self.space).take_if(|space| space.bounded == bounded && space.rows.is_of(g_transposed))
    }

    pub fn keep(&self, space: Space) {
        *locked(&self.space) = Some(space);
    }

    pub fn take_directions(&self) -> Option<Conjugate> {
        locked(&self.directions).take()
    }

    pub fn keep_directions(&self, directions: Conjugate) {
        *locked(&self.directions) = Some(directions);
    }
}

pub fn locked<T>(kept: &Mutex<T>) -> MutexGuard<'_, T> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}
