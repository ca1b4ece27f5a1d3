//! Surfaces and pairs as the host gives them: positions, which surface meets which, laws of contact. Rows are written here; a find of the
//! solver computes them.

mod laws;
mod rows;
mod surfaces;

pub use laws::Laws;
pub use rows::PairRows;
pub use surfaces::Geometry;

use crate::constraints::{RowKind, RowsInput};
use crate::error::{Error, Kind, Result};
use crate::model::host::HostModel;
use crate::platform::memory::{filled, reserved};
use crate::surface::vector::Vector;
use crate::surface::{Partner, NONE};

const WHAT: &str = "a pair of surfaces";

/// How rows are made between two surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairMethod {
    /// One row between each slave node and the point of the master nearest to it.
    NodeToFace,
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
    /// From slave to master.
    pub normal: Vector,
    pub tangents: [Vector; 2],
    /// Between the points at the positions of the find, length.
    pub gap: f64,
}

/// The material point of a tie, and the components of x - y in the master's frame when it was found, length.
pub type Tied = (Partner, [f64; 3]);

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
    /// The points of a tie; none before the first find.
    pub tied: Option<Vec<Option<Tied>>>,
    /// Areas of its nodes at the last find, length^2.
    pub areas: Vec<f64>,
    /// Rows of the last find whose unknowns are all held, and the deepest overlap there, length.
    pub held: (usize, f64),
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

    /// Bytes of a copy, which shares faces and unknowns.
    pub fn bytes(&self) -> usize {
        let nodes: usize = self.surfaces.iter().map(Geometry::len).sum();
        let rows: usize = self.pairs.iter().map(|pair| pair.nodes.len()).sum();
        let each = size_of::<Option<Met>>() + size_of::<Option<Tied>>() + 8 * size_of::<f64>();
        nodes * size_of::<Vector>() + rows * each
    }

    pub fn dim(&self, pair: &Pair) -> usize {
        self.surfaces[pair.slave].dim()
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

impl HostModel {
    /// Rows of one kind that belong to pairs; of tangential rows the nodes.
    pub fn rows_of_pairs(&self, kind: RowKind) -> usize {
        self.pairs.rows(kind, |pair| self.pairs.dim(pair))
    }

    pub fn pair_add(
        &mut self,
        slave: usize,
        master: usize,
        method: PairMethod,
        is_tied: bool,
        distance: f64,
    ) -> Result<(usize, usize)> {
        let (of_slave, of_master) =
            (self.pairs.surface(slave, "slave")?, self.pairs.surface(master, "master")?);
        if slave == master {
            let what = "a surface cannot meet itself: give its sides as two surfaces";
            return Err(Error::new(Kind::Unsupported, what).index(slave as i64));
        }
        let dim = of_slave.dim();
        if of_master.dim() != dim {
            let what = format!("the slave has {dim} dimensions, the master {}", of_master.dim());
            return Err(Error::argument("master", what).value(of_master.dim() as f64));
        }
        if !(distance.is_finite() && distance > 0.0) {
            let what = "the distance up to which nodes meet the master is a finite number above 0";
            return Err(Error::argument("distance", what).value(distance));
        }
        if !of_master.has_points() {
            return Err(Error::argument("master", "this surface has no faces").index(master as i64));
        }
        let nodes = of_slave.slave_nodes()?;
        let kind = if is_tied { RowKind::Equality } else { RowKind::Inequality };
        let own = self.rows_of_pairs(kind);
        if self.rows(kind).len() > own {
            let what = format!("pairs come before rows: there is a {} of the host", kind.name());
            return Err(Error::new(Kind::State, what).row(own));
        }
        let rows = if is_tied { dim * nodes.len() } else { nodes.len() };
        let rhs = filled(rows, if is_tied { 0.0 } else { f64::INFINITY }, WHAT)?;
        let ptr = filled(rows + 1, 0, WHAT)?;
        let mut pair = Pair {
            slave,
            master,
            method,
            is_tied,
            first: own,
            friction: None,
            laws: Laws::new(nodes.len(), distance)?,
            kept: filled(nodes.len(), NONE, WHAT)?,
            met: filled(nodes.len(), None, WHAT)?,
            adjusted: None,
            tied: None,
            areas: filled(nodes.len(), 0.0, WHAT)?,
            held: (0, 0.0),
            nodes: Vec::new(),
        };
        pair.nodes = nodes;
        self.pairs
            .pairs
            .try_reserve(1)
            .map_err(|_| crate::platform::memory::refusal(size_of::<Pair>(), WHAT))?;
        let input = RowsInput { ptr: &ptr, body: None, dof: &[], val: &[], rhs: Some(&rhs) };
        self.add_rows(kind, input)?;
        let is_new = |of: usize| self.pairs.pairs.iter().all(|pair| pair.slave != of && pair.master != of);
        for surface in [slave, master].into_iter().filter(|of| is_new(*of)).collect::<Vec<_>>() {
            self.pairs.surfaces[surface].begin_here();
        }
        self.pairs.pairs.push(pair);
        Ok((self.pairs.pairs.len() - 1, own))
    }

    pub fn pairs_commit(&mut self) {
        self.pairs.surfaces.iter_mut().for_each(Geometry::begin_here);
        self.pairs.pairs.iter_mut().for_each(|pair| pair.kept.fill(NONE));
    }
}

/// A copy in reserved memory.
fn copied<T: Copy>(values: impl ExactSizeIterator<Item = T>) -> Result<Vec<T>> {
    let mut copy = reserved(values.len(), WHAT)?;
    copy.extend(values);
    Ok(copy)
}
