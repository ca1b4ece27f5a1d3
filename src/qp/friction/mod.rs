//! Contact with friction, Tresca's and Coulomb's: a semismooth Newton method on kept images, with one product with F per step.
//!
//! ```text
//! r = F x - d - G'a,   G x = e,   r = 0 on free rows,   x = NAT(x - rho r) on the nodes
//! NAT(n, t) = (n+, min(|t|, b) t/|t|),   b = bound + mu n+
//! ```
//!
//! r has the gap g in normal rows and minus the slip in tangential ones. F never changes, so every pair (v, F v) stays valid for all
//! states, slip directions, coefficients, bounds and loads.

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
mod smooth;
mod start;
mod supports;
mod unheld;

pub use cones::{Cones, Force, Node, Place};
pub use coordinates::{Coordinate, Law};
pub use end::{friction, known_face};
pub use face::{Face, State};
pub use pairs::{DualAnswer, Pairs, PairsBetween};
pub use supports::Supported;
pub use unheld::unheld;

use crate::error::Result;
use crate::linalg::{Csr, Operator};
use crate::qp::{Counts, Direct, Verdict};

/// The problem in scaled quantities; `G` is given as `G'`, m x r, as in `Qp`.
#[derive(Clone, Copy)]
pub struct FrictionProblem<'a> {
    /// F, with the compliance of all rows.
    pub a: &'a dyn Operator,
    /// d
    pub b: &'a [f64],
    pub g_transposed: &'a Csr,
    /// First columns of the blocks of G, ascending. Empty: each column by itself.
    pub blocks: &'a [usize],
    /// A motion a is free when `|G a| <= rounding |G| |a|`.
    pub rounding: f64,
    pub e: &'a [f64],
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

/// When to end, and what may be tried before.
#[derive(Clone, Copy)]
pub struct FrictionLimits<'a> {
    /// Of `|P d|`, the gaps of all rows without any force.
    pub tolerance: f64,
    /// Products with F at most.
    pub products: usize,
    /// Dense systems of all rows and modes, where they are not more than its limit.
    pub direct: Option<Direct<'a>>,
}

/// Where to begin. Pairs of other F, G or rows must not be handed on.
#[derive(Default)]
pub struct FrictionStart<'a> {
    pub x: Option<&'a [f64]>,
    pub alpha: Option<&'a [f64]>,
    pub pairs: Pairs,
}

/// Sees the method after every product; an error ends it, with the point reached where it says `Cancelled` or `TimeOver`.
pub trait FrictionObserver {
    fn step(&mut self, now: &FrictionReport) -> Result<()>;
}

/// Where the method stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionReport {
    pub products: usize,
    pub newton: usize,
    /// How far the laws are from being met, and the norm that counts as zero: lengths.
    pub merit: f64,
    pub small: f64,
    pub closed: usize,
    pub sticking: usize,
    pub slipping: usize,
}

/// What has been tried.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tried {
    /// Newton steps, each with its face.
    pub newton: usize,
    /// Starts with another rho.
    pub restarts: usize,
    /// Paths along smoothed laws, by pairs and by dense matrices.
    pub paths: usize,
    pub dense_paths: usize,
    /// Starts from the answer without friction, and from that with all closed nodes sticking.
    pub frictionless: bool,
    pub sticking: bool,
}

impl Tried {
    /// Ways that were begun, the first one included.
    pub fn starts(&self) -> usize {
        let others = self.restarts + self.paths + self.dense_paths;
        1 + others + usize::from(self.frictionless) + usize::from(self.sticking)
    }
}

/// A verdict of `Infeasible` means here: PROJ_C found no force within the cones that balances the load; no proof.
pub struct FrictionSolution {
    pub x: Vec<f64>,
    pub alpha: Vec<f64>,
    /// Of each node.
    pub states: Vec<State>,
    /// `|P d|`, what lengths are measured against.
    pub scale: f64,
    /// How far x is from the laws, of `scale`.
    pub merit: f64,
    pub verdict: Verdict,
    pub counts: Counts,
    pub tried: Tried,
    /// For later solves with the same F, G and rows.
    pub pairs: Pairs,
}
