//! What rank 0 and another rank say to each other in a call that all make.

use std::sync::Arc;

use crate::body::{wire_struct, Facts};
use crate::certificate::Certificate;
use crate::gathering::{Copies, Revised, Told, Values};
use crate::model::Sizes;
use crate::solver::call::Call;
use crate::solver::joined::BodyMade;
use crate::solver::together::failure::Failure;
use crate::solver::together::share::Share;

/// Names of what a rank keeps, from the first on.
pub const BLOCK: u64 = 1 << 40;

/// Requests beside those about bodies.
pub const BEGIN: u32 = crate::serving::BEGIN;
pub const NUMBERS: u32 = 3;
pub const TOUCH: u32 = 4;
pub const LOADS: u32 = 5;
pub const FINISH: u32 = 6;
/// Of a problem file: bytes of the sections of every body; one section of a body, by these numbers.
pub const LENGTHS: u32 = 7;
pub const SECTION_OF_FILE: u32 = 8;
/// An answer to be checked: `Candidates`.
pub const CANDIDATES: u32 = 9;

/// A call with the number that all ranks have to give: of a state or a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Called {
    pub call: Call,
    pub number: u64,
}

/// Which call rank 0 is in, and what it knows of the part of this rank.
pub struct Begin {
    /// Its number on rank 0.
    pub problem: u64,
    pub called: Called,
    pub known: Option<Revised>,
}

/// Which call this rank is in, and what rank 0 does not know of its part.
pub struct Begun {
    /// The number of its problem here, and on rank 0 once known.
    pub problem: u64,
    pub leads: Option<u64>,
    pub called: Called,
    pub refused: Option<Failure>,
    pub told: Option<Told>,
    pub values: Option<Values>,
    /// Forces of an answer to be checked, of contact, equality and tangential rows.
    pub forces: Option<Vec<Vec<f64>>>,
    /// The answer of the state is that of its data.
    pub fits: bool,
}

/// What the displacements of the answer to be checked are called, those of other parts following the first.
pub struct Candidates {
    pub first: u64,
    /// Bodies and dofs of which `f - K u` is asked for.
    pub left_at: Vec<(usize, usize)>,
}

/// Numbers that rows of other ranks name, or that other ranks have, ascending, and the name of the first part, those of others following.
pub struct Touch {
    pub numbers: Vec<usize>,
    pub first: u64,
}

/// Which of its unknowns have these numbers; the parts of every body.
pub struct Touched {
    /// Numbers: those asked for, and those that several of its own bodies have.
    pub copies: Copies,
    pub bodies: Vec<PartsTold>,
}

pub struct PartsTold {
    pub parts: Vec<PartTold>,
    pub loose: Vec<u32>,
}

pub struct PartTold {
    pub order: usize,
    pub dofs: Option<Arc<[u32]>>,
    pub facts: Facts,
}

/// The end of a call.
#[derive(Default)]
pub struct Finish {
    /// The number of the problem on rank 0; none if it is not this one.
    pub leads: Option<u64>,
    pub failure: Option<Failure>,
    pub share: Option<Share>,
    /// What has been made of the bodies of this rank, if a setup is done.
    pub made: Option<Vec<BodyMade>>,
    /// Of a check.
    pub certificate: Option<Certificate>,
    /// An open motion on the bodies of this rank, and its fastest body, if this rank has it.
    pub motion: Option<(Vec<f64>, Option<usize>)>,
    /// Rows of this rank.
    pub rows: Vec<usize>,
    /// An answer that was saved is that of the present data.
    pub fits: bool,
    /// Of the problem of all ranks, once it is put together.
    pub sizes: Option<Sizes>,
}

wire_struct!(Called { call, number });
wire_struct!(Begin { problem, called, known });
wire_struct!(Begun { problem, leads, called, refused, told, values, forces, fits });
wire_struct!(Candidates { first, left_at });
wire_struct!(Touch { numbers, first });
wire_struct!(Touched { copies, bodies });
wire_struct!(PartsTold { parts, loose });
wire_struct!(PartTold { order, dofs, facts });
wire_struct!(Facts { entries, largest, length, last_digit, keys });
wire_struct!(BodyMade { kplus, operator });
wire_struct!(Finish { leads, failure, share, made, certificate, motion, rows, fits, sizes });
