//! Contact with Tresca or Coulomb friction: a semismooth Newton method on stored images, with one product with F per
//! step.
//!
//! ```text
//! r = F x - d - G'a,   G x = e,   r = 0 on free rows,   x = NAT(x - rho r) on the nodes
//! NAT(n, t) = (n+, min(|t|, b) t/|t|),   b = bound + mu n+
//! ```
//!
//! r is the gap g in normal rows and minus the slip in tangential rows. F does not change, so every pair (v, F v) stays
//! valid for all states, slip directions, coefficients, bounds and loads.

mod combinations;
mod cones;
mod coordinates;
mod direct;
mod end;
mod face;
mod motions;
mod nearest;
mod newton;
mod otherwise;
mod pairs;
mod path;
mod slides;
mod smooth;
mod start;
mod supports;
mod unheld;

pub use cones::{Cones, Force, Node, Place};
pub use coordinates::{Coordinate, Law};
pub use direct::{newton_step, slipping, without_force, Corrected};
pub use end::{friction, known_face};
pub use face::{Face, State};
pub use pairs::{DualAnswer, Pairs, PairsBetween};
pub use supports::Supported;
pub use unheld::unheld;

use crate::error::Result;
use crate::qp::{Counts, Direct, Qp, Verdict};

/// The problem in scaled quantities.
#[derive(Clone, Copy)]
pub struct FrictionProblem<'a> {
    /// F, including the compliance of all rows, d, G' and e; `cones` replaces its bounds, and `preconditioner` its own.
    pub qp: Qp<'a>,
    pub cones: &'a Cones,
    pub preconditioner: Option<&'a dyn FacePreconditioner>,
}

/// An approximation of the inverse of `W'F W + D` on the free coordinates of a face.
pub trait FacePreconditioner: Sync {
    /// `M = H^-1 (W'(B K_d^-1 S K_d^-1 B' + C)W + D) H^-1`, `H = W'(B K_d^-1 B' + C)W + D`, factorised for this face.
    fn on<'a>(&'a self, face: &Face) -> Result<Box<dyn OnFace + 'a>>;
}

/// M of one face.
pub trait OnFace {
    /// `z = M q` over all m coordinates of the face; q and z are 0 where a value is held.
    fn apply(&self, q: &[f64], z: &mut [f64]) -> Result<()>;
}

impl<F: Fn(&[f64], &mut [f64]) -> Result<()>> OnFace for F {
    fn apply(&self, q: &[f64], z: &mut [f64]) -> Result<()> {
        self(q, z)
    }
}

/// Limits, and alternatives that may be tried.
#[derive(Clone, Copy)]
pub struct FrictionLimits<'a> {
    /// Relative to `|P d|`, the gaps of all rows without forces.
    pub tolerance: f64,
    /// Limit of products with F.
    pub products: usize,
    /// Permits dense systems of all rows and modes, up to their limit.
    pub direct: Option<Direct<'a>>,
}

/// The start. Pairs of another F, G or set of rows must not be passed.
#[derive(Default)]
pub struct FrictionStart<'a> {
    pub x: Option<&'a [f64]>,
    pub alpha: Option<&'a [f64]>,
    pub pairs: Pairs,
}

/// A steady slide: the forces at their bounds hold only a part of the load.
#[derive(Debug, Clone)]
pub struct Slide {
    /// Amplitudes of its motion.
    pub alpha: Vec<f64>,
    /// Part of the load along the motion that friction holds, no unit.
    pub capacity: f64,
}

/// Here a verdict `Infeasible` means that PROJ_C found no forces within the cones that balance the load; it is no proof.
pub struct FrictionSolution {
    pub x: Vec<f64>,
    pub alpha: Vec<f64>,
    /// One state per node.
    pub states: Vec<State>,
    /// `|P d|`, to which lengths are relative.
    pub scale: f64,
    /// Violation of the laws by x, relative to `scale`.
    pub merit: f64,
    pub verdict: Verdict,
    pub counts: Counts,
    /// A slide that weak supports have shown, if no rest was found beside it.
    pub slide: Option<Slide>,
    /// For later solves with the same F, G and rows.
    pub pairs: Pairs,
}
