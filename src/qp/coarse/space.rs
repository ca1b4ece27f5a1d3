//! What the coarse problems of all faces of one G share, and where it is kept from one solve to the next.

use std::sync::{Mutex, PoisonError};

use crate::error::Result;
use crate::linalg::semidefinite::clusters::Blocks;
use crate::linalg::semidefinite::faces::FaceFactors;
use crate::linalg::vector::{norm_max, power_of_two_below};
use crate::linalg::{Csr, Runs};

/// Depends on G and on which rows faces may hold, not on loads and gaps.
#[derive(Default)]
pub struct Space {
    /// `G'`, m x r.
    pub rows: Runs,
    /// The power of two s that W is divided by twice.
    pub unit: f64,
    /// Diagonal of the whole `G G' / s^2`: the largest entry in [1, 4).
    pub whole: Vec<f64>,
    /// Rows that faces may hold.
    pub bounded: Vec<bool>,
    /// None where there are no modes.
    pub factors: Option<FaceFactors>,
    /// Made for the first face that leaves much of the space free.
    pub by_blocks: Option<Blocks>,
}

/// The space of a problem while no method uses it: what it is given for, its blocks and its rounding, must not change.
#[derive(Default)]
pub struct KeptSpace(Mutex<Option<Space>>);

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

impl KeptSpace {
    /// Takes the space that is kept, if it is that of these rows.
    pub fn take(&self, g_transposed: &Csr, bounded: &[bool]) -> Option<Space> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.take_if(|space| space.bounded == bounded && space.rows.is_of(g_transposed))
    }

    pub fn keep(&self, space: Space) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(space);
    }
}
