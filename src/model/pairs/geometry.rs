//! Surfaces: positions, faces, unknowns.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::model::pairs::copied;
use crate::surface::vector::Vector;
use crate::surface::{Faces, Rigid};

/// A surface at its present positions, and where it was at the beginning of the step.
#[derive(Debug, Clone)]
pub enum Geometry {
    Nodes { faces: Arc<Faces>, x: Vec<Vector>, begin: Arc<Vec<Vector>>, unknowns: Option<Arc<Unknowns>> },
    Rigid { now: Rigid, begin: Rigid },
}

/// The unknowns of the nodes, one per direction; below 0: held.
#[derive(Debug)]
pub struct Unknowns {
    /// Without a body they are those of all bodies, or the host's numbers.
    pub body: Option<usize>,
    pub dof: Vec<i64>,
}

impl Geometry {
    pub fn dim(&self) -> usize {
        match self {
            Self::Nodes { faces, .. } => faces.dim,
            Self::Rigid { now, .. } => now.dim,
        }
    }

    /// There is something to meet.
    pub fn has_points(&self) -> bool {
        match self {
            Self::Nodes { faces, .. } => faces.len() > 0,
            Self::Rigid { .. } => true,
        }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        match self {
            Self::Nodes { x, .. } => x.len(),
            Self::Rigid { .. } => 0,
        }
    }

    /// The nodes of its faces, ascending; of a cloud all nodes.
    pub fn slave_nodes(&self) -> Result<Vec<u32>> {
        let refused = |what: &str| Err(Error::argument("slave", what));
        let Self::Nodes { faces, unknowns, .. } = self else {
            return refused("a rigid surface cannot be the slave");
        };
        if unknowns.is_none() {
            return refused("a surface without unknowns cannot be the slave");
        }
        if faces.nodes == 0 {
            return refused("this surface has no nodes");
        }
        let nodes: Vec<u32> =
            if faces.len() > 0 { faces.used().collect() } else { (0..faces.nodes as u32).collect() };
        copied(nodes.into_iter())
    }

    /// The step begins at the present positions.
    pub fn begin_here(&mut self) {
        match self {
            Self::Nodes { x, begin, .. } => *begin = Arc::new(x.clone()),
            Self::Rigid { now, begin } => *begin = *now,
        }
    }
}
