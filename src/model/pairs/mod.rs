//! Surfaces and pairs as the host gives them: positions, which surface meets which, laws of contact.

mod geometry;
mod laws;

pub use geometry::{Geometry, SurfaceSizes, Unknowns};
pub use laws::Laws;

use std::sync::Arc;

use crate::constraints::{RowKind, RowSet, TabledRows};
use crate::error::{Error, Result, INDEX};
use crate::platform::memory::reserved;
use crate::surface::vector::Vector;
use crate::surface::{Meeting, Rigid};

pub(super) const WHAT: &str = "a pair of surfaces";

/// How rows are made between two surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairMethod {
    /// One row between each slave node and the point of the master nearest to it.
    NodeToFace,
    /// One row for each slave node, of the gap weighted over its faces.
    Mortar,
}

/// All surfaces and pairs. Their rows come before those of the host.
#[derive(Debug, Clone, Default)]
pub struct Pairs {
    pub surfaces: Vec<Geometry>,
    pub pairs: Vec<Pair>,
}

/// What a slave node has met in the last find.
#[derive(Debug, Clone, Copy)]
pub struct Met {
    /// From slave to master; by mortar, as the tangents, a mean over faces, which may be shorter than 1.
    pub normal: Vector,
    pub tangents: [Vector; 2],
    /// Moments about the origin of unit forces along the normal and the tangents on the slave, length.
    pub moments: [Vector; 3],
    /// At the positions of the find, length.
    pub gap: f64,
    /// Between the normal and that of the master, radian.
    pub angle: f64,
}

/// The material points of a tie, the openings of its nodes when they were found, length, and a rigid master at that time.
#[derive(Debug)]
pub struct Tied {
    pub meeting: Meeting,
    pub then: Vec<Option<[f64; 3]>>,
    pub rigid: Option<Rigid>,
}

/// Two surfaces that may meet. Row k belongs to slave node `nodes[k]`.
#[derive(Debug, Clone)]
pub struct Pair {
    pub slave: usize,
    pub master: usize,
    pub method: PairMethod,
    /// Equality rows in all directions, found once.
    pub is_tied: bool,
    /// Slave nodes that have a row, ascending.
    pub nodes: Vec<u32>,
    /// Its first contact row, or equality row of a tie.
    pub first: usize,
    /// Its first node with friction, once it has some.
    pub friction: Option<usize>,
    pub laws: Laws,
    /// Faces that nodes keep.
    pub kept: Vec<u32>,
    pub met: Vec<Option<Met>>,
    /// Gaps of the first find that count as 0, length; none before it.
    pub adjusted: Option<Vec<f64>>,
    /// None before the first find of a tie that is on.
    pub tied: Option<Arc<Tied>>,
    /// Areas of its nodes at the last find, by mortar of their covered parts, length^2.
    pub areas: Vec<f64>,
    /// Rows of the last find whose unknowns are all held, and the deepest overlap there, length.
    pub held: (usize, f64),
}

/// Rows of all pairs.
#[derive(Default)]
pub struct PairRows {
    /// Over the unknowns of all bodies, by their kind; tangential rows with s_old as right-hand sides.
    pub sets: [RowSet; 3],
    /// Those that follow the table of unknowns.
    pub tabled: [TabledRows; 3],
    /// Coefficient and bound of the nodes with friction.
    pub coefficient: Vec<f64>,
    pub bound: Vec<f64>,
}

impl Pair {
    pub fn kind(&self) -> RowKind {
        if self.is_tied {
            RowKind::Equality
        } else {
            RowKind::Inequality
        }
    }
}

impl Pairs {
    /// Rows of one kind that belong to pairs; of tangential rows the nodes.
    pub fn rows(&self, kind: RowKind, dim: impl Fn(&Pair) -> usize) -> usize {
        let count = |pair: &Pair| match kind {
            RowKind::Inequality if !pair.is_tied => pair.nodes.len(),
            RowKind::Equality if pair.is_tied => dim(pair) * pair.nodes.len(),
            RowKind::Tangential if pair.friction.is_some() => pair.nodes.len(),
            _ => 0,
        };
        self.pairs.iter().map(count).sum()
    }

    /// The same surfaces and pairs, perhaps at other positions and with other laws.
    pub fn is_of(&self, other: &Self) -> bool {
        let friction = |pairs: &Self| pairs.pairs.iter().map(|pair| pair.friction).collect::<Vec<_>>();
        let counts = |pairs: &Self| (pairs.surfaces.len(), pairs.pairs.len());
        counts(self) == counts(other) && friction(self) == friction(other)
    }

    /// Bytes of a copy, which shares faces, unknowns and points of ties.
    pub fn bytes(&self) -> usize {
        let nodes: usize = self.surfaces.iter().map(Geometry::len).sum();
        let rows: usize = self.pairs.iter().map(|pair| pair.nodes.len()).sum();
        let each = size_of::<Option<Met>>() + 8 * size_of::<f64>();
        nodes * size_of::<Vector>() + rows * each
    }

    pub fn dim(&self, pair: &Pair) -> usize {
        self.surfaces[pair.slave].dim()
    }

    /// Surfaces name no more than `n` unknowns of the table.
    pub fn check_table(&self, n: usize) -> Result<()> {
        for (number, surface) in self.surfaces.iter().enumerate() {
            let Some(of) = surface.unknowns().filter(|of| of.is_tabled) else { continue };
            if let Some(at) = of.dof.iter().position(|dof| *dof >= n as i64) {
                let what = format!("surface {number} names unknown {INDEX} of the table, which has {n} now");
                return Err(Error::argument("n", what).node(at / surface.dim()).index(of.dof[at]));
            }
        }
        Ok(())
    }

    pub fn pair(&self, pair: usize) -> Result<&Pair> {
        let pairs = self.pairs.len();
        self.pairs
            .get(pair)
            .ok_or_else(|| Error::argument("pair", format!("there are {pairs} pairs")).index(pair as i64))
    }

    pub fn surface(&self, surface: usize, argument: &'static str) -> Result<&Geometry> {
        let surfaces = self.surfaces.len();
        self.surfaces.get(surface).ok_or_else(|| {
            Error::argument(argument, format!("there are {surfaces} surfaces")).index(surface as i64)
        })
    }

    /// The pair to which a row belongs, and its slave node.
    pub fn of_row(&self, kind: RowKind, row: usize) -> Option<(usize, usize)> {
        self.pairs.iter().enumerate().find_map(|(number, pair)| {
            let (first, each) = match kind {
                RowKind::Tangential => (pair.friction?, 1),
                _ if kind != pair.kind() => return None,
                RowKind::Equality => (pair.first, self.dim(pair)),
                RowKind::Inequality => (pair.first, 1),
            };
            let node = pair.nodes.get(row.checked_sub(first)? / each)?;
            Some((number, *node as usize))
        })
    }
}

/// A copy in reserved memory.
pub(super) fn copied<T: Copy>(values: impl ExactSizeIterator<Item = T>) -> Result<Vec<T>> {
    let mut copy = reserved(values.len(), WHAT)?;
    copy.extend(values);
    Ok(copy)
}
