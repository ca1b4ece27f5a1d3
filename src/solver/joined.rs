//! What a rank keeps of a problem to which several have given bodies and rows.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::decomposition::{Connected, Decomposition};
use crate::gathering::{Order, Revised, Told};
use crate::model::{BodyRevisions, Revisions, Sizes};
use crate::serving::Rank;
use crate::solve::Answer;

/// The part of this rank in a problem of several.
pub struct Joined {
    pub rank: Arc<Rank>,
    /// Number of the problem on this rank, in the order of creation.
    pub problem: u64,
    pub role: Role,
    /// The model of this rank to which its answer belongs.
    pub answered: Option<Revisions>,
    /// Of the problem of all ranks, after a call that has put it together.
    pub sizes: Option<Sizes>,
}

pub enum Role {
    Leads(Box<Leader>),
    Follows(Box<Follower>),
}

/// What rank 0 knows of the parts of all ranks.
#[derive(Default)]
pub struct Leader {
    pub order: Arc<Order>,
    /// Of every body of rank 0 its number in that order.
    pub own: Vec<usize>,
    /// What each rank has told last; none: nothing is known.
    pub told: Option<Vec<Told>>,
    /// The revisions from which the problem of all ranks has been made.
    pub made_from: Vec<Revised>,
    /// Numbers that several ranks have, ascending, and these ranks.
    pub shared: Vec<(usize, Vec<usize>)>,
    /// Ranks that serve, and have no part of the problem.
    pub serve: Vec<bool>,
    /// Ranks whose problem is known.
    pub paired: Vec<bool>,
    pub states: BTreeMap<usize, SavedByAll>,
    /// The order to which a restored answer belongs.
    pub expected: Option<Arc<Order>>,
}

/// What rank 0 keeps of a state of all ranks.
pub struct SavedByAll {
    pub order: Arc<Order>,
    pub previous: Option<Arc<Answer>>,
}

/// What another rank keeps for its part.
pub struct Follower {
    pub rank: Arc<Rank>,
    /// Number of the problem on rank 0, once known.
    pub leads: Option<u64>,
    pub connected: Connected,
    /// The parts of its bodies.
    pub parts: Option<Decomposition>,
    /// What rank 0 has made of each of its bodies, by the revisions of their data.
    pub made: Vec<(BodyRevisions, BodyMade)>,
    /// Its numbers, ascending, and how many of them rank 0 has, during a call.
    pub numbers: Option<(Vec<usize>, usize)>,
}

/// What rank 0 has made of a body on another rank.
#[derive(Debug, Clone, Default)]
pub struct BodyMade {
    /// Of every part the name of its K+ there, and its unit.
    pub kplus: Vec<(u64, f64)>,
    /// Bytes of the dual operator; none if it is not assembled.
    pub operator: Option<usize>,
}

impl Follower {
    pub fn new(rank: Arc<Rank>) -> Self {
        Self {
            rank,
            leads: None,
            connected: Connected::default(),
            parts: None,
            made: Vec::new(),
            numbers: None,
        }
    }
}

impl Drop for Joined {
    fn drop(&mut self) {
        self.rank.drop_problem(self.problem);
    }
}
