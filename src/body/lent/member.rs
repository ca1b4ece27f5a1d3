//! A body of an island on the rank that has its K and K+.

use std::sync::Arc;

use crate::body::elsewhere::{InIsland, Join, Joined};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::given::Stiffness;
use crate::body::local::{Local, LocalDual};
use crate::error::Result;
use crate::linalg::{Csr, Symmetric};
use crate::platform::memory::zeros;
use crate::ranks::damaged;

/// A K+, and the K from which it was made.
pub struct WithMatrix {
    pub kplus: Arc<GeneralizedInverse>,
    pub k: Arc<Symmetric>,
    /// Grounded unknowns of K, ascending.
    pub grounded: Vec<u32>,
}

pub(super) struct Member {
    of: Arc<WithMatrix>,
    rows: Arc<Csr>,
    by: f64,
    size: f64,
    island: InIsland,
    /// Grounded unknowns that rows do not carry, ascending.
    grounded: Vec<u32>,
    /// `D~ / 2^p`, n.
    metric: Vec<f64>,
}

impl Member {
    /// With what rank 0 has to know of it.
    pub fn new(of: Arc<WithMatrix>, Join { rows, by, of: island, .. }: Join) -> Result<(Self, Joined)> {
        let (k, n) = (&of.k, of.k.order());
        let is_inside = |dofs: &[u32]| dofs.iter().all(|dof| (*dof as usize) < n);
        let fits = rows.cols == n && island.metric.len() == island.touched.len();
        if !(fits && is_inside(&island.touched) && is_inside(&island.carried)) {
            return Err(damaged());
        }
        let mut metric = zeros(n, "the metric of a body")?;
        metric.iter_mut().enumerate().for_each(|(i, d)| *d = k.metric(i, island.unit) / island.island);
        island.touched.iter().zip(&island.metric).for_each(|(dof, d)| metric[*dof as usize] = *d);
        let is_carried = |dof: &&u32| island.carried.binary_search(dof).is_ok();
        let grounded = of.grounded.iter().filter(|dof| !is_carried(dof)).copied().collect();
        let coarse = of.kplus.coarse(&rows, by);
        let size = if island.balanced { coarse.size } else { 1.0 };
        let member = Self { of, rows, by, size, island, grounded, metric };
        let local = member.local();
        let (entries, diagonal, stiffest) =
            (local.stiffness.entries(), local.diagonal(), local.stiffness.stiffest());
        Ok((member, Joined { coarse, entries, diagonal, stiffest }))
    }

    pub fn local(&self) -> Local<'_> {
        let (kplus, InIsland { touched, unit, island, .. }) = (&*self.of.kplus, &self.island);
        let Self { rows, by, size, metric, .. } = self;
        Local {
            stiffness: Stiffness::Matrix(&self.of.k),
            null_space: &kplus.null_space,
            soft: kplus.is_soft(),
            unit: *unit,
            grounded: &self.grounded,
            touched,
            dual: Some(LocalDual { kplus, rows, metric, island: *island, by: *by, size: *size }),
        }
    }
}
