//! Quadratic programming with bounds and equalities, after Sections 4 and 5:
//!
//! ```text
//! theta(x) = 1/2 x'A x - b'x -> min   subject to   x_i >= 0 (i bounded)   and   G x = e
//! ```
//!
//! A is only applied matrix-free; this layer does not know bodies.

mod acceptance;
mod between_solves;
mod coarse;
mod conjugate;
mod face;
pub mod friction;
mod gradient;
mod interior;
mod nearest;
mod projection;
mod proportioning;
mod restricted;
mod rungs;
mod space;

pub use acceptance::{
    AcceptanceTest, Effort, Limits, Mended, Observer, Solution, StepKind, StepReport, Verdict,
};
pub use between_solves::BetweenSolves;
pub use coarse::{AnswerFace, Coarse};
pub use conjugate::MOST as KEPT;
pub use face::{Direct, Face};
pub use gradient::{at_bound, feasible_step, Split};
pub use interior::{Interior, Inverse, Point, Stiffness};
pub use nearest::{nearest_point, Nearest, Polyhedron};
pub use proportioning::minimise;
pub use restricted::{DirectOnRows, Judged, Restricted};
pub use rungs::{during, Rung, Tries};

use crate::error::Result;
use crate::linalg::{Csr, Operator};
use crate::numbers::rounding;

/// The problem; `G` is given as `G'`, m x r; the modes of each body are divided by one number so that `|G_p|` = 1.
#[derive(Clone, Copy)]
pub struct Qp<'a> {
    pub a: &'a dyn Operator,
    pub b: &'a [f64],
    pub g_transposed: &'a Csr,
    /// First columns of the blocks of G, ascending: modes that belong together. Empty: each column is a block.
    pub blocks: &'a [usize],
    /// A motion a is free if `|G_F a| <= rounding |G| |a|`: accuracy of G, at least 64 eps.
    pub rounding: f64,
    pub e: &'a [f64],
    pub bounded: &'a [bool],
    pub preconditioner: Option<&'a dyn Preconditioner>,
    /// Data passed to the next method and the next solve: the common part of the faces of this G, and directions with
    /// their images.
    pub kept: Option<&'a BetweenSolves>,
}

impl<'a> Qp<'a> {
    /// With single columns as blocks, G accurate to 1e-14, no preconditioner and nothing kept.
    pub fn plain(
        a: &'a dyn Operator,
        b: &'a [f64],
        g_transposed: &'a Csr,
        e: &'a [f64],
        bounded: &'a [bool],
    ) -> Self {
        let (blocks, rounding) = (&[], rounding::SUM);
        Self { a, b, g_transposed, blocks, rounding, e, bounded, preconditioner: None, kept: None }
    }
}

impl Qp<'_> {
    /// `e - G x`
    pub fn left(&self, x: &[f64]) -> Vec<f64> {
        let mut left = self.e.to_vec();
        self.g_transposed.mul_transposed_add(-1.0, x, &mut left);
        left
    }

    /// (21): bounded rows of x at zero.
    pub fn at_bound(&self, x: &[f64]) -> Vec<bool> {
        gradient::at_bound(self.bounded, x)
    }
}

/// An approximation of the inverse of A on a face.
pub trait Preconditioner: Sync {
    /// `z = M_F r` for the rows that are not held; 0 on the others.
    fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()>;
}

/// Counts of the work of the method.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Products with A.
    pub products: usize,
    pub conjugate_gradient: usize,
    pub expansions: usize,
    /// Proportioning steps.
    pub releases: usize,
    /// Systems solved with `W_F = G_F G_F'`.
    pub coarse_solves: usize,
    /// Factorisations of `W_F`.
    pub coarse_factorisations: usize,
    /// Applications of the preconditioner.
    pub preconditioned: usize,
    /// Faces solved directly.
    pub direct: usize,
    /// Problems with bounds only: outer iterations of an augmented Lagrangian method.
    pub outer: usize,
    /// Newton steps for friction, and number of starts.
    pub newton: usize,
    pub starts: usize,
}

impl std::ops::Add for Counts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            products: self.products + other.products,
            conjugate_gradient: self.conjugate_gradient + other.conjugate_gradient,
            expansions: self.expansions + other.expansions,
            releases: self.releases + other.releases,
            coarse_solves: self.coarse_solves + other.coarse_solves,
            coarse_factorisations: self.coarse_factorisations + other.coarse_factorisations,
            preconditioned: self.preconditioned + other.preconditioned,
            direct: self.direct + other.direct,
            outer: self.outer + other.outer,
            newton: self.newton + other.newton,
            starts: self.starts + other.starts,
        }
    }
}

impl Counts {
    pub fn steps(&self) -> usize {
        self.conjugate_gradient + self.expansions + self.releases + self.newton
    }
}
