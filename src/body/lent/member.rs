//! A body of an island on the rank that has its K and K+.

use std::sync::Arc;

use crate::body::coarse::Coarse;
use crate::body::elsewhere::{Enter, Entered, InIsland, Join};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::local::{Local, LocalDual};
use crate::body::Body;
use crate::error::{Error, Kind, Result};
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
    body: Arc<Body>,
    touched: Arc<[u32]>,
    unit: f64,
    /// None until it joins.
    dual: Option<InDual>,
}

/// Its part of the dual problem.
struct InDual {
    of: Arc<WithMatrix>,
    rows: Arc<Csr>,
    by: f64,
    size: f64,
    island: f64,
    /// Grounded unknowns that rows do not carry, ascending.
    grounded: Vec<u32>,
    /// `D~ / 2^p`, n.
    metric: Vec<f64>,
}

impl Member {
    /// A body that enters an island, and what rank 0 has to know of it.
    pub fn new(body: Arc<Body>, Enter { touched, unit, .. }: Enter) -> Result<(Self, Entered)> {
        if touched.iter().any(|dof| *dof as usize >= body.order) {
            return Err(damaged());
        }
        let member = Self { body, touched: touched.into(), unit, dual: None };
        let local = member.local()?;
        let entered = Entered { diagonal: local.diagonal(), stiffest: local.stiffness.stiffest() };
        Ok((member, entered))
    }

    /// With its part of the dual problem, and its part of G.
    pub fn joined(&self, of: Arc<WithMatrix>, join: Join) -> Result<(Self, Coarse)> {
        let Join { rows, by, of: InIsland { carried, metric: at_rows, island, balanced }, .. } = join;
        let (k, n, touched) = (&of.k, of.k.order(), &self.touched);
        if rows.cols != n || self.body.order != n || at_rows.len() != touched.len() {
            return Err(damaged());
        }
        let mut metric = zeros(n, "the metric of a body")?;
        metric.iter_mut().enumerate().for_each(|(i, d)| *d = k.metric(i, self.unit) / island);
        touched.iter().zip(&at_rows).for_each(|(dof, d)| metric[*dof as usize] = *d);
        let is_carried = |dof: &&u32| carried.binary_search(dof).is_ok();
        let grounded = of.grounded.iter().filter(|dof| !is_carried(dof)).copied().collect();
        let coarse = of.kplus.coarse(&rows, by);
        let size = if balanced { coarse.size } else { 1.0 };
        let dual = Some(InDual { of, rows, by, size, island, grounded, metric });
        let (body, touched) = (Arc::clone(&self.body), Arc::clone(touched));
        Ok((Self { body, touched, unit: self.unit, dual }, coarse))
    }

    pub fn local(&self) -> Result<Local<'_>> {
        let missing = || Error::new(Kind::Internal, "a body without stiffness was given to a rank");
        let Self { body, touched, unit, dual } = self;
        let local = Local::of_matrix(body.k().ok_or_else(missing)?, *unit, touched);
        let Some(InDual { of, rows, by, size, island, grounded, metric }) = dual else { return Ok(local) };
        let (kplus, said) = (&*of.kplus, body.null_space.as_deref());
        let dual = Some(LocalDual { kplus, rows, metric, island: *island, by: *by, size: *size });
        Ok(Local { null_space: &kplus.null_space, said, soft: kplus.is_soft(), grounded, dual, ..local })
    }
}
