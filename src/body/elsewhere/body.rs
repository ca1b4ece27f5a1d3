//! A body that another rank has, and what rank 0 knows of it without its entries.

use std::fmt;
use std::sync::Arc;

use crate::body::alike::keys;
use crate::body::elsewhere::asking::{Asking, Name};
use crate::body::Body;
use crate::ranks::{wire_struct, Token};

/// What is known of a body without its entries.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Of K.
    pub entries: usize,
    /// `max K_ii`, force / length.
    pub largest: f64,
    /// Of its coordinates; 0 without.
    pub length: f64,
    pub last_digit: f64,
    /// Of the pattern of K, of its values, and of what else the host has told: equal for equal bodies, and two different bodies have
    /// equal ones about once in 2^64 pairs.
    pub keys: [u64; 3],
}

/// A body that another rank has.
pub struct BodyElsewhere {
    pub name: Token,
    pub facts: Facts,
}

impl fmt::Debug for BodyElsewhere {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        write!(to, "{:?} on rank {}", self.facts, self.name.rank)
    }
}

/// Keeps this body.
pub struct Give {
    pub name: u64,
    pub body: Body,
}

/// Keeps a body in an island: the t unknowns that rows touch, ascending, and the metric of dofs without stiffness, force / length.
/// Answer: `Entered`.
pub struct Enter {
    pub member: u64,
    pub body: u64,
    pub touched: Vec<u32>,
    pub unit: f64,
}

/// What rank 0 has to know of it: D where rows touch, t, 0 without stiffness; the largest D of the body; force / length.
pub struct Entered {
    pub diagonal: Vec<f64>,
    pub stiffest: f64,
}

/// f_p, n, force, as the host has given it; zero if absent.
#[derive(Clone, Default)]
pub struct HostLoad(pub Option<Arc<[f64]>>);

/// Keeps the load of a body.
pub struct GiveLoad {
    pub name: u64,
    pub load: Option<Arc<[f64]>>,
}

wire_struct!(Give { name, body });
wire_struct!(GiveLoad { name, load });
wire_struct!(Enter { member, body, touched, unit });
wire_struct!(Entered { diagonal, stiffest });

/// A body of an island on another rank.
pub struct Away {
    pub name: Token,
    /// Number of unknowns n, and of entries of K.
    pub order: usize,
    pub entries: usize,
    /// The metric of dofs without stiffness, force / length.
    pub unit: f64,
    /// As in `Entered`.
    pub diagonal: Vec<f64>,
    pub stiffest: f64,
}

impl Facts {
    /// None for a body without a matrix here.
    pub fn of(body: &Body) -> Option<Self> {
        let k = body.stiffness.as_deref()?;
        let (length, last_digit) = (body.length(), body.last_digit());
        Some(Self {
            entries: k.col.len(),
            largest: k.largest_diagonal(),
            length,
            last_digit,
            keys: keys(k, body),
        })
    }
}

impl BodyElsewhere {
    /// The question for the body in an island, and its name there.
    pub fn entering(&self, touched: &[u32], unit: f64) -> (Asking, Token) {
        let member = self.token();
        let of = Enter { member: member.number, body: self.name.number, touched: touched.to_vec(), unit };
        (Asking::new(self.name.rank, Name::Enter, of), member)
    }

    /// The body in an island, of so many unknowns.
    pub fn entered(&self, name: Token, order: usize, unit: f64, of: Entered) -> Away {
        let Entered { diagonal, stiffest } = of;
        Away { name, order, entries: self.facts.entries, unit, diagonal, stiffest }
    }

    /// The question that gives the load of the body, and its name there.
    pub fn giving_load(&self, load: Option<Arc<[f64]>>) -> (Asking, Arc<Token>) {
        let name = Arc::new(self.token());
        (Asking::new(name.rank, Name::GiveLoad, GiveLoad { name: name.number, load }), name)
    }

    pub(in crate::body) fn token(&self) -> Token {
        self.name.ranks.token(self.name.rank)
    }
}
