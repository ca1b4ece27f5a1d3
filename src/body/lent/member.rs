//! A body of an island on the rank that has its K and K+.

use std::sync::Arc;

use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::given::Stiffness;
use crate::body::local::{Local, LocalDual};
use crate::error::Result;
use crate::linalg::{Csr, Symmetric};
use crate::platform::memory::zeros;
use crate::ranks::{damaged, wire_struct};

/// A K+, and the K from which it was made.
pub struct WithMatrix {
    pub kplus: Arc<GeneralizedInverse>,
    pub k: Arc<Symmetric>,
}

/// The question for a body of an island with this K+: as a `Local`.
pub struct Join {
    pub member: u64,
    pub kplus: u64,
    pub unit: f64,
    pub grounded: Arc<[u32]>,
    pub touched: Vec<u32>,
    pub rows: Arc<Csr>,
    /// `D~ / 2^p` where rows touch.
    pub metric: Vec<f64>,
    pub island: f64,
    pub by: f64,
    pub size: f64,
}

wire_struct!(Join { member, kplus, unit, grounded, touched, rows, metric, island, by, size });

pub(super) struct Member {
    of: Arc<WithMatrix>,
    asked: Join,
    /// `D~ / 2^p`, n.
    metric: Vec<f64>,
}

impl Member {
    pub fn new(of: Arc<WithMatrix>, asked: Join) -> Result<Self> {
        let n = of.k.order();
        let is_inside = |dofs: &[u32]| dofs.iter().all(|dof| (*dof as usize) < n);
        let fits = asked.rows.cols == n && asked.metric.len() == asked.touched.len();
        if !(fits && is_inside(&asked.touched) && is_inside(&asked.grounded)) {
            return Err(damaged());
        }
        let mut metric = zeros(n, "the metric of a body")?;
        metric.iter_mut().enumerate().for_each(|(i, d)| *d = of.k.metric(i, asked.unit) / asked.island);
        asked.touched.iter().zip(&asked.metric).for_each(|(dof, d)| metric[*dof as usize] = *d);
        Ok(Self { of, asked, metric })
    }

    pub fn local(&self) -> Local<'_> {
        let (kplus, Join { unit, grounded, touched, rows, island, by, size, .. }) =
            (&*self.of.kplus, &self.asked);
        let dual = LocalDual { kplus, rows, metric: &self.metric, island: *island, by: *by, size: *size };
        Local {
            stiffness: Stiffness::Matrix(&self.of.k),
            null_space: &kplus.null_space,
            soft: kplus.is_soft(),
            unit: *unit,
            grounded,
            touched,
            dual: Some(dual),
        }
    }
}
