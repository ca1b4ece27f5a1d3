//! Carried unknowns: bodies of a few unknowns that rows hold far better than K, such as pilots with dummy stiffness. Their
//! unknowns are held, K+ = 0, and their motions are soft motions, as in [`soft`](crate::body::soft), with `R'D~R = I` and
//! S = R'K R. Otherwise u would be the difference of forces that nearly cancel, divided by a stiffness that means nothing.

use std::sync::Arc;

use crate::body::known::Known;
use crate::body::null_space::ROUNDING;
use crate::body::plan::Plan;
use crate::error::Result;
use crate::linalg::{Matrix, Multiple};

/// The metric D~ of all unknowns of a body that rows carry, in the unit of its K; none of other bodies.
pub type Pilots = Option<Arc<[f64]>>;

impl Plan {
    /// The plan of a body whose unknowns are carried; its null space need not be known.
    pub fn of_pilots(k: Multiple, metric: &Arc<[f64]>) -> Result<Self> {
        let n = k.order();
        let motions = Matrix::from_fn(n, n, |i, j| if i == j { metric[i].sqrt().recip() } else { 0.0 })?;
        let known = Known::of(k, motions, ROUNDING, (0..n).collect(), false);
        Ok(Self::Known(Known { soft: true, weights: Some(Arc::clone(metric)), ..known }))
    }
}
