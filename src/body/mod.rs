//! One body: stiffness `K_p`, load `f_p`, null space `R_p`, fixing dofs and the generalised inverse `K_p+`
//! of (14)-(15).

mod alike;
mod assembled;
mod borrowed;
mod boundary;
mod candidates;
mod carried;
mod coarse;
mod digits;
mod elsewhere;
mod fixing;
mod form;
mod generalized_inverse;
mod given;
mod grounded;
mod held;
mod hints;
mod host;
mod host_probe;
mod in_order;
mod judged;
mod known;
mod last;
mod layout;
mod lent;
mod local;
mod misfit;
mod null_space;
mod part;
mod pilots;
mod plan;
mod planning;
mod probe;
mod rigid_modes;
mod rounded;
mod search;
mod skyline;
mod soft;
mod spectrum;
mod stiffness;
mod storage;
mod store;
mod triplets;
mod values;

pub(crate) use crate::ranks::{wire_struct, wire_unit};
pub use crate::ranks::{Token, Wire};
use alike::keys;
pub use alike::{
    input_key, pattern_key, same_body, same_matrix, same_matrix_of, same_pattern, same_pattern_of,
    same_vectors, value_key,
};
pub use assembled::Assembled;
pub use borrowed::{from_borrowed, Columns};
pub use boundary::{boundary, diagonal, dirichlet_bytes, Inside};
pub use coarse::Coarse;
pub use digits::Digits;
pub use elsewhere::{
    ask, Asking, Away, BodyElsewhere, BodyThere, Elsewhere, Entered, Facts, FormElsewhere, GivenThere,
    HostLoad, InIsland, Joining, LoadThere, Name, Owed, PartThere, ABOUT_BODIES,
};
pub use form::Form;
pub use generalized_inverse::{Factorised, GeneralizedInverse};
pub use given::Stiffness;
pub use grounded::grounded;
pub use host::{HostFunctions, HostMultiple, HostOperator, HostProduct, TOGETHER};
pub use layout::{Layout, Symbolic};
pub use lent::{asked, Analysis, Answering, Bodies, Lending, Made, NewKplus, PlanAway, Planned};
#[cfg(feature = "loopback")]
pub use local::answers;
pub use local::{Bring, Distributed, Home, Kept, Local, LocalDual, Locals, Put, Question, Section, Seen};
pub use misfit::Misfit;
pub use null_space::{Modes, NullSpaceInput};
pub use pilots::{Carried, Pilots};
pub use plan::Plan;
pub use planning::Planning;
pub use rigid_modes::Coordinates;
pub use rounded::Precision;
pub use skyline::{Direction, Skyline, SkylineInput};
pub use spectrum::Doubt;
pub use stiffness::{check_diagonal, check_finite, from_dense, from_sparse, from_split};
pub use storage::{SparseInput, Storage};
pub use triplets::{TripletInput, Triplets};
pub use values::Places;

use std::sync::Arc;

use crate::linalg::vector::{norm_max, power_of_two_below};
use crate::linalg::Symmetric;

/// `K_p` that is not one matrix here.
#[derive(Debug, Clone)]
pub enum OtherForm {
    /// Products with a `K_p` that stays with the host.
    Operator(Arc<HostOperator>),
    /// The sum of the matrices of pieces.
    Assembled(Arc<Assembled>),
    /// Another rank has it, with all that the host has told of it.
    Elsewhere(BodyThere),
    /// The host has given it on another rank.
    Given(Box<GivenThere>),
}

/// The input of the host for one body, in the host's units.
#[derive(Debug, Default)]
pub struct Body {
    /// Number of unknowns n.
    pub order: usize,
    /// `K_p`, n x n, force / length.
    pub stiffness: Option<Arc<Symmetric>>,
    /// Alternative forms of `K_p`, which few bodies have.
    pub other: Option<Box<OtherForm>>,
    /// `R_p` or vectors that may span it; if neither vectors nor coordinates are given, the library finds it.
    pub null_space: Option<Box<NullSpaceInput>>,
    /// Positions of the dofs: candidates for the null space if none is given.
    pub coordinates: Option<Box<Coordinates>>,
    /// The meaning of the rigid motions of the coordinates.
    pub coordinate_modes: Modes,
    /// Dofs held in `K_p+`; chosen by the library if not given.
    pub fixing: Option<Box<[usize]>>,
    /// `f_p`, length n, force; zero until given.
    pub load: Option<Box<[f64]>>,
}

impl Body {
    /// `K_p` in the form given by the host, if given.
    pub fn k(&self) -> Option<Stiffness<'_>> {
        let matrix = self.stiffness.as_deref().map(Stiffness::Matrix);
        matrix.or_else(|| match self.other.as_deref()? {
            OtherForm::Operator(k) => Some(Stiffness::Host(k)),
            OtherForm::Assembled(k) => Some(Stiffness::Assembled(k)),
            OtherForm::Elsewhere(_) | OtherForm::Given(_) => None,
        })
    }

    pub fn operator(&self) -> Option<&Arc<HostOperator>> {
        match self.other.as_deref() {
            Some(OtherForm::Operator(k)) => Some(k),
            _ => None,
        }
    }

    pub fn assembled(&self) -> Option<&Arc<Assembled>> {
        match self.other.as_deref() {
            Some(OtherForm::Assembled(k)) => Some(k),
            _ => None,
        }
    }

    pub fn elsewhere(&self) -> Option<&Arc<BodyElsewhere>> {
        match self.other.as_deref() {
            Some(OtherForm::Elsewhere(there)) => Some(&there.of),
            _ => None,
        }
    }

    /// What the host has given on another rank.
    pub fn given_there(&self) -> Option<&GivenThere> {
        match self.other.as_deref() {
            Some(OtherForm::Given(there)) => Some(there),
            _ => None,
        }
    }

    /// The host has given it, or the body of which it is a part, on another rank.
    pub fn is_given_there(&self) -> bool {
        self.given_there().is_some() || self.load_there().is_some()
    }

    /// Its load, if the host has given it on another rank.
    pub fn load_there(&self) -> Option<&LoadThere> {
        match self.other.as_deref() {
            Some(OtherForm::Elsewhere(there)) => there.load.as_ref(),
            _ => None,
        }
    }

    /// `max |f_j|`, force; none without a load.
    pub fn largest_load(&self) -> Option<f64> {
        match self.other.as_deref() {
            Some(OtherForm::Elsewhere(BodyThere { load: Some(load), .. })) => load.largest,
            Some(OtherForm::Given(there)) => there.largest_load(),
            _ => self.load.as_deref().map(norm_max),
        }
    }

    /// The host has given soft motions.
    pub fn has_soft_motions(&self) -> bool {
        match &self.null_space {
            Some(given) => given.modes == Modes::Soft,
            None => self.coordinates.is_some() && self.coordinate_modes == Modes::Soft,
        }
    }

    /// The largest power of two that does not exceed the largest `K_ii`, 1 if there is no stiffness, force / length:
    /// division by it is exact, so powers of two in the host's units do not change any bit of the results.
    pub fn unit(&self) -> f64 {
        power_of_two_below(self.largest_diagonal())
    }

    /// `max K_ii`, 0 without stiffness, force / length.
    pub fn largest_diagonal(&self) -> f64 {
        match self.elsewhere() {
            Some(there) => there.facts.largest,
            None => self.k().map_or(0.0, |k| k.largest_diagonal()),
        }
    }

    /// Number of entries of its matrix, here or on another rank; none if the host keeps them.
    pub fn entries(&self) -> Option<usize> {
        let here = self.stiffness.as_ref().map(|k| k.col.len());
        here.or_else(|| self.elsewhere().map(|there| there.facts.entries))
    }

    /// The length of its coordinates; 0 without.
    pub fn length(&self) -> f64 {
        match self.elsewhere() {
            Some(there) => there.facts.length,
            None => self.coordinates.as_ref().map_or(0.0, |given| given.length()),
        }
    }

    /// What the last digit of its coordinates makes uncertain ([`Coordinates::last_digit`]); 0 without.
    pub fn last_digit(&self) -> f64 {
        match self.elsewhere() {
            Some(there) => there.facts.last_digit,
            None => self.coordinates.as_ref().map_or(0.0, |given| given.last_digit()),
        }
    }

    /// Of the pattern of its matrix, of the values, and of what else the host has told ([`Facts`]); none if the host keeps the entries.
    fn keys(&self) -> Option<[u64; 3]> {
        let there = self.elsewhere().map(|there| there.facts.keys);
        there.or_else(|| Some(keys(self.stiffness.as_deref()?, self)))
    }

    /// Nothing but the load remains of a body that another rank has.
    pub fn let_go(&mut self, there: Arc<BodyElsewhere>) {
        let (order, load) = (self.order, self.load.take());
        let other = Some(Box::new(OtherForm::Elsewhere(BodyThere { of: there, load: None })));
        *self = Self { order, load, other, ..Self::default() };
    }

    /// The same body without its load, of which the matrix and functions are shared.
    pub fn without_load(&self) -> Self {
        let Self { order, stiffness, other, null_space, coordinates, coordinate_modes, fixing, .. } = self;
        Self {
            order: *order,
            stiffness: stiffness.clone(),
            other: other.clone(),
            null_space: null_space.clone(),
            coordinates: coordinates.clone(),
            coordinate_modes: *coordinate_modes,
            fixing: fixing.clone(),
            ..Self::default()
        }
    }

    /// The value used in the metric where `K_ii` is 0: the unit, or `others` if the body has no stiffness.
    pub fn without(&self, others: f64) -> f64 {
        if self.largest_diagonal() > 0.0 {
            self.unit()
        } else {
            others
        }
    }
}
