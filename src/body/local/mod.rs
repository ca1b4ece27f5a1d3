//! The bodies of an island and what is asked about them. What belongs to one body stays with it: its K, K+, null space, and whatever is
//! kept of a solve over its unknowns. Questions bring it sizes, amplitudes and values where rows touch it, and it answers with such.

#[cfg(feature = "loopback")]
pub mod answers;
mod brought;
mod kept;
mod locals;
mod seen;

pub use brought::{Bring, Put, Section};
pub use kept::{Distributed, Given, Kept};
pub use locals::{Home, Locals};
pub use seen::Seen;

use crate::body::elsewhere::Name;
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::given::Stiffness;
use crate::body::null_space::NullSpaceInput;
use crate::error::{Error, Kind, Result};
use crate::linalg::{Csr, Matrix};
use crate::platform::memory::zeros;
use crate::ranks::{wire_struct, Wire};

/// One body of an island, n unknowns.
#[derive(Clone, Copy)]
pub struct Local<'a> {
    /// K_p, n x n, force / length.
    pub stiffness: Stiffness<'a>,
    /// R_p, n x r, no unit, with `R'DR = unit`.
    pub null_space: &'a Matrix,
    /// The null space as the host has given it.
    pub said: Option<&'a NullSpaceInput>,
    /// K has positive or negative stiffness along motions of R, which are exact: `(K R)'u` is part of their balance.
    pub soft: bool,
    /// Force / length, also the metric of dofs without stiffness.
    pub unit: f64,
    /// Unknowns of the body held so stiffly that neighbours are negligible, ascending: see `grounded`.
    pub grounded: &'a [u32],
    /// The t unknowns that rows touch, ascending.
    pub touched: &'a [u32],
    /// Its part of the dual problem; none if only its answer is judged.
    pub dual: Option<LocalDual<'a>>,
}

/// A body in the dual problem of its island.
#[derive(Clone, Copy)]
pub struct LocalDual<'a> {
    pub kplus: &'a GeneralizedInverse,
    /// The rows of the dual that touch the body, over its unknowns.
    pub rows: &'a Csr,
    /// `D~ / 2^p`, n.
    pub metric: &'a [f64],
    /// 2^p of the island, force / length.
    pub island: f64,
    /// Power of two by which K+ is multiplied.
    pub by: f64,
    /// The number by which R is divided in G and e.
    pub size: f64,
}

/// What is asked about a body; one code answers it wherever the body is.
pub trait Question: Wire + Send + Sync + 'static {
    const NAME: Name;
    type Answer: Wire + Send;
    /// What it makes or changes, and what it reads, of all that is kept of the body.
    type Kept: Clone + Default + Send + Sync + 'static;
    type Given: Given;

    fn answer(
        self,
        body: &Local,
        kept: &mut Self::Kept,
        given: <Self::Given as Given>::Of<'_>,
    ) -> Result<Self::Answer>;
}

/// A question on its way to the rank of its body, before what is asked.
pub struct Heading {
    /// Names: of the body; of what is made or changed, and of what it is a changed copy of; of what is read.
    pub body: u64,
    pub kept: Option<u64>,
    pub from: Option<u64>,
    pub given: Vec<u64>,
}

wire_struct!(Heading { body, kept, from, given });

impl<'a> Local<'a> {
    /// A body of which only K is asked.
    pub fn of_matrix(stiffness: Stiffness<'a>, unit: f64, touched: &'a [u32]) -> Self {
        const NONE: &Matrix = &Matrix { rows: 0, cols: 0, data: Vec::new() };
        Self {
            stiffness,
            null_space: NONE,
            said: None,
            soft: false,
            unit,
            grounded: &[],
            touched,
            dual: None,
        }
    }

    pub fn order(&self) -> usize {
        self.stiffness.order()
    }

    /// Its part of the dual problem.
    pub fn dual(&self) -> Result<&LocalDual<'a>> {
        self.dual.as_ref().ok_or_else(|| Error::new(Kind::Internal, "a body without a dual problem"))
    }

    /// `K v` and the terms to which its rounding is relative, `|K||v|`.
    pub fn products(&self, v: &[f64], what: &str) -> Result<(Vec<f64>, Vec<f64>)> {
        let (mut image, mut terms) = (zeros(v.len(), what)?, zeros(v.len(), what)?);
        self.stiffness.mul_with_terms(v, &mut image, &mut terms)?;
        Ok((image, terms))
    }

    /// The values where rows touch the body.
    pub fn at_rows<T: Copy>(&self, v: &[T]) -> Vec<T> {
        self.touched.iter().map(|dof| v[*dof as usize]).collect()
    }

    /// D where rows touch, t, 0 without stiffness, force / length.
    pub fn diagonal(&self) -> Vec<f64> {
        self.stiffness.diagonal_at(self.touched)
    }

    /// Replaces the values where rows touch the body.
    pub fn set_at_rows<T: Copy>(&self, values: &[T], v: &mut [T]) {
        self.touched.iter().zip(values).for_each(|(dof, value)| v[*dof as usize] = *value);
    }

    /// Functions of the host compute its products, on the thread that calls the library.
    pub(super) fn on_caller(&self) -> bool {
        self.stiffness.on_caller() || self.dual.as_ref().is_some_and(|dual| dual.kplus.on_caller())
    }
}
