//! The forces on held unknowns: their rows of the stiffness matrix over the free unknowns.

use crate::error::Result;
use crate::mesh::connectivity::{Connectivity, Place};
use crate::platform::memory::{filled, reserved};

const WHAT: &str = "the rows of held unknowns";

/// `K_hf`, held unknowns by unknowns of the body, force / length.
#[derive(Debug, Default)]
pub struct HeldRows {
    ptr: Vec<usize>,
    col: Vec<u32>,
    val: Vec<f64>,
}

impl HeldRows {
    /// The matrix with the pattern of the held rows, all zero.
    pub fn new(all: &Connectivity) -> Result<Self> {
        let touching = (0..all.elements()).filter(|&e| all.free(e).count() < all.size(e));
        let held = |e: usize| all.size(e) - all.free(e).count();
        let mut pairs: Vec<(u32, u32)> =
            reserved(touching.clone().map(|e| held(e) * all.free(e).count()).sum(), WHAT)?;
        for e in touching {
            let held = all.places(e).filter_map(|place| match place {
                Place::Held(k) => Some(k as u32),
                Place::Free(_) => None,
            });
            held.for_each(|k| pairs.extend(all.free(e).map(|dof| (k, dof))));
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut ptr = filled(all.held().len() + 1, 0, WHAT)?;
        pairs.iter().for_each(|(k, _)| ptr[*k as usize + 1] += 1);
        (0..all.held().len()).for_each(|k| ptr[k + 1] += ptr[k]);
        let mut col = reserved(pairs.len(), WHAT)?;
        col.extend(pairs.iter().map(|(_, dof)| *dof));
        Ok(Self { ptr, val: filled(col.len(), 0.0, WHAT)?, col })
    }

    /// Adds the held rows of `(ke + ke') / 2`, `ke(i, j)` over the rows and columns of the element.
    pub fn add(&mut self, places: &[Place], ke: impl Fn(usize, usize) -> f64) {
        for (i, k) in places.iter().enumerate() {
            let Place::Held(k) = *k else { continue };
            let row = self.ptr[k]..self.ptr[k + 1];
            for (j, dof) in places.iter().enumerate() {
                let Place::Free(dof) = *dof else { continue };
                if let Ok(at) = self.col[row.clone()].binary_search(&(dof as u32)) {
                    self.val[row.start + at] += 0.5 * ke(i, j) + 0.5 * ke(j, i);
                }
            }
        }
    }

    pub fn clear(&mut self) {
        self.val.fill(0.0);
    }

    /// `K_hf u` of held unknown k, force.
    pub fn force(&self, k: usize, u: &[f64]) -> f64 {
        let row = self.ptr[k]..self.ptr[k + 1];
        self.col[row.clone()].iter().zip(&self.val[row]).map(|(&j, v)| v * u[j as usize]).sum()
    }
}
