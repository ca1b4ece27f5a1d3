//! What rank 0 and another rank say to each other in a call that all make.

use std::sync::Arc;

use crate::body::{wire_struct, Facts};
use crate::gathering::{Copies, Revised, Told, Values};
use crate::ranks::wire_enum;
use crate::solver::together::failure::Failure;
use crate::solver::together::share::Share;

/// Requests beside those about bodies.
pub const BEGIN: u32 = crate::serving::BEGIN;
pub const NUMBERS: u32 = 3;
pub const TOUCH: u32 = 4;
pub const LOADS: u32 = 5;
pub const FINISH: u32 = 6;

/// A call that all ranks make.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Call {
    Setup,
    Solve,
}

impl Call {
    pub fn name(self) -> &'static str {
        match self {
            Self::Setup => "feti_setup",
            Self::Solve => "feti_solve",
        }
    }
}

/// Which call rank 0 is in, and what it knows of the part of this rank.
pub struct Begin {
    pub problem: u64,
    pub call: Call,
    pub known: Option<Revised>,
}

/// Which call this rank is in, and what rank 0 does not know of its part.
pub struct Begun {
    pub problem: u64,
    pub call: Call,
    pub refused: Option<Failure>,
    pub told: Option<Told>,
    pub values: Option<Values>,
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
    pub failure: Option<Failure>,
    pub share: Option<Share>,
}

wire_enum!(Call { Setup, Solve });
wire_struct!(Begin { problem, call, known });
wire_struct!(Begun { problem, call, refused, told, values });
wire_struct!(Touch { numbers, first });
wire_struct!(Touched { copies, bodies });
wire_struct!(PartsTold { parts, loose });
wire_struct!(PartTold { order, dofs, facts });
wire_struct!(Facts { entries, largest, length, last_digit, keys });
wire_struct!(Finish { failure, share });
