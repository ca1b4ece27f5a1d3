//! Surfaces: positions, faces, unknowns.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::model::pairs::{copied, WHAT};
use crate::platform::memory::reserved;
use crate::surface::vector::Vector;
use crate::surface::{Faces, Rigid};

/// A surface at its present positions, and where it was at the beginning of the step.
#[derive(Debug, Clone)]
pub enum Geometry {
    Nodes { faces: Arc<Faces>, x: Vec<Vector>, begin: Arc<Vec<Vector>>, unknowns: Option<Arc<Unknowns>> },
    Rigid { now: Rigid, begin: Rigid },
}

/// What the arrays of a surface hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SurfaceSizes {
    pub dim: usize,
    /// 0 for a rigid surface.
    pub nodes: usize,
    pub faces: usize,
    /// Numbers that describe a rigid surface; 0 for one with nodes.
    pub data: usize,
}

/// The unknowns of the nodes, one per direction; below 0: held.
#[derive(Debug)]
pub struct Unknowns {
    /// Without a body they are those of all bodies, or the host's numbers, or those of its table.
    pub body: Option<usize>,
    pub is_tabled: bool,
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

    pub fn unknowns(&self) -> Option<&Unknowns> {
        match self {
            Self::Nodes { unknowns, .. } => unknowns.as_deref(),
            Self::Rigid { .. } => None,
        }
    }

    /// The nodes of its faces or its points, ascending; of a surface without either all nodes.
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
        let mut nodes = reserved(faces.nodes, WHAT)?;
        nodes.extend(faces.used());
        if nodes.is_empty() {
            nodes.extend(0..faces.nodes as u32);
        }
        Ok(nodes)
    }

    pub fn sizes(&self) -> SurfaceSizes {
        let (faces, data) = match self {
            Self::Nodes { faces, .. } => (faces.len(), 0),
            Self::Rigid { now, .. } => (0, now.shape.numbers(now.dim).unwrap_or(0)),
        };
        SurfaceSizes { dim: self.dim(), nodes: self.len(), faces, data }
    }

    /// A copy of the present positions; empty for a rigid surface.
    pub fn positions(&self) -> Result<Arc<Vec<Vector>>> {
        match self {
            Self::Nodes { x, .. } => Ok(Arc::new(copied(x.iter().copied())?)),
            Self::Rigid { .. } => Ok(Arc::default()),
        }
    }

    /// The step begins at the present positions, of which this is a copy.
    pub fn begin_at(&mut self, positions: Arc<Vec<Vector>>) {
        match self {
            Self::Nodes { begin, .. } => *begin = positions,
            Self::Rigid { now, begin } => *begin = *now,
        }
    }
}
