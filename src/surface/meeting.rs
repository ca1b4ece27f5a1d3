//! What the nodes of a slave have met, by either method.

use crate::surface::find::Partner;
use crate::surface::mortar::Mortar;
use crate::surface::rows::{rows, tie, Opposite, Rows, Slave};

#[derive(Debug, Clone)]
pub enum Meeting {
    /// By node-to-face, in the order of the slave's nodes.
    Feet(Vec<Option<Partner>>),
    Mortar(Mortar),
}

impl Meeting {
    /// The rows of slave node `node`, the one with number k; none without partner.
    pub fn rows(&self, slave: &Slave, master: &Opposite, k: usize, node: u32) -> Option<Rows> {
        match self {
            Self::Feet(partners) => rows(slave, master, node, partners[k].as_ref()?),
            Self::Mortar(mortar) => mortar.rows(slave, master, node),
        }
    }

    /// The rows of a tie, along the master's frame at the foot; by mortar as the others, which turn with nodes of the slave alone.
    pub fn tie(&self, slave: &Slave, master: &Opposite, k: usize, node: u32) -> Option<Rows> {
        match self {
            Self::Feet(partners) => tie(slave, master, node, partners[k].as_ref()?),
            Self::Mortar(mortar) => mortar.rows(slave, master, node),
        }
    }
}
