//! Data that one solve passes to the next, with other loads and gaps: the part of the coarse problems that all faces of
//! one G share, and the directions of its steps with their images.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::Result;
use crate::linalg::semidefinite::clusters::Blocks;
use crate::linalg::semidefinite::faces::FaceFactors;
use crate::linalg::vector::{norm_max, power_of_two_below};
use crate::linalg::{Csr, Runs};
use crate::qp::conjugate::Conjugate;

/// Depends on G and on which rows faces may hold, not on loads and gaps.
#[derive(Default)]
pub struct Space {
    /// `G'`, m x r.
    pub rows: Runs,
    /// The power of two s for which W is divided by s^2.
    pub unit: f64,
    /// Diagonal of `G G' / s^2` with all rows: its largest entry is in [1, 4).
    pub whole: Vec<f64>,
    /// Rows that faces may hold.
    pub bounded: Vec<bool>,
    /// None without modes.
    pub factors: Option<FaceFactors>,
    /// Made for the first face that leaves many motions free.
    pub by_blocks: Option<Blocks>,
}

/// Storage while no method uses the data. A, the blocks of G and the rounding of G must not change.
#[derive(Default)]
pub struct BetweenSolves {
    space: Mutex<Option<Space>>,
    directions: Mutex<Option<Conjugate>>,
}

impl Space {
    pub fn new(g_transposed: &Csr, bounded: &[bool]) -> Result<Self> {
        let mut whole = vec![0.0; g_transposed.cols];
        for (&k, v) in g_transposed.col.iter().zip(&g_transposed.val) {
            whole[k] += v * v;
        }
        let unit = power_of_two_below(norm_max(&whole).sqrt());
        whole.iter_mut().for_each(|v| *v /= unit * unit);
        let factors = match whole.len() {
            0 => None,
            _ => Some(FaceFactors::new(g_transposed, bounded.to_vec())?),
        };
        Ok(Self {
            rows: Runs::of(g_transposed)?,
            unit,
            whole,
            bounded: bounded.to_vec(),
            factors,
            by_blocks: None,
        })
    }
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

fn locked<T>(kept: &Mutex<T>) -> MutexGuard<'_, T> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}
