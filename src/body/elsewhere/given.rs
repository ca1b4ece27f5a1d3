//! Bodies that the host has given on another rank, as rank 0 knows them.

use std::sync::Arc;

use crate::body::elsewhere::BodyElsewhere;
use crate::ranks::Token;

/// A body on another rank.
#[derive(Debug, Clone)]
pub struct BodyThere {
    pub of: Arc<BodyElsewhere>,
    /// None: rank 0 has it, and sends it.
    pub load: Option<LoadThere>,
}

/// A load that the host has given on another rank: its name there.
#[derive(Clone)]
pub struct LoadThere {
    pub name: Arc<Token>,
    /// `max |f_j|`, force; none without a load.
    pub largest: Option<f64>,
}

/// A body of the host on another rank: its parts there.
#[derive(Debug, Clone, Default)]
pub struct GivenThere {
    pub parts: Vec<PartThere>,
    /// Unknowns that are in no part, ascending.
    pub loose: Vec<u32>,
}

/// A part of it.
#[derive(Debug, Clone)]
pub struct PartThere {
    pub order: usize,
    /// Its unknowns within the body, ascending; none: all.
    pub dofs: Option<Arc<[u32]>>,
    pub there: BodyThere,
}

impl GivenThere {
    /// `max |f_j|`, force; none without a load.
    pub fn largest_load(&self) -> Option<f64> {
        self.parts.iter().filter_map(|part| part.there.load.as_ref()?.largest).reduce(f64::max)
    }
}

impl std::fmt::Debug for LoadThere {
    fn fmt(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(to, "a load up to {:?} on rank {}", self.largest, self.name.rank)
    }
}
