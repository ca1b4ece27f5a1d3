//! The symbolic analysis: order of elimination, elimination tree, pattern of L.

mod blocks;
#[cfg(any(test, not(feature = "metis")))]
mod dissection;
pub mod elimination;
#[cfg(feature = "metis")]
mod metis;
mod minimum_degree;
pub mod ordering;
pub mod subtrees;
pub mod supernodes;

use crate::error::Result;
use crate::linalg::sparse::graph::Graph;
use crate::linalg::Symmetric;
use crate::platform::memory::{filled, headroom, Headroom};
use elimination::NONE;
use ordering::order_of_elimination;
use supernodes::Supernodes;

/// Upper bound of the bytes for ordering and symbolic analysis, per dof and per entry of the lower triangle: grids of all
/// dimensions, chains, stars and diagonal matrices take up to 4/5 of it.
const ANALYSIS_PER_DOF: usize = 256;
const ANALYSIS_PER_ENTRY: usize = 128;

/// Order of elimination and pattern of L, which depend only on the pattern of K and the held dofs.
pub struct Analysis {
    /// Dof eliminated at each position.
    pub order: Vec<usize>,
    /// Position of each dof, `NONE` for held dofs.
    pub position: Vec<usize>,
    pub(in crate::linalg::cholesky) nodes: Supernodes,
}

impl Analysis {
    pub fn new(matrix: &Symmetric, held: &[bool]) -> Result<Self> {
        let _room = analysis_headroom(matrix)?;
        let graph = Graph::of(matrix)?;
        let order = order_of_elimination(&graph, held)?;
        Self::in_order(&graph, &order)
    }

    /// Analysis of `matrix` with the dofs `last` eliminated last, in this order. `graph` determines the order of the
    /// others; `matrix` may only have further couplings among `last`.
    pub fn ending(graph: &Symmetric, matrix: &Symmetric, last: &[usize]) -> Result<Self> {
        let _room = analysis_headroom(matrix)?;
        let mut is_last = vec![false; matrix.order()];
        last.iter().for_each(|&dof| is_last[dof] = true);
        let mut order = order_of_elimination(&Graph::of(graph)?, &is_last)?;
        order.extend(last);
        Self::in_order(&Graph::of(matrix)?, &order)
    }

    /// Analysis of the block of the dofs in `order`, eliminated in this order.
    pub fn of_leading(matrix: &Symmetric, order: &[usize]) -> Result<Self> {
        let _room = analysis_headroom(matrix)?;
        Self::in_order(&Graph::of(matrix)?, order)
    }

    /// Analysis for the dofs to eliminate in `order`.
    fn in_order(graph: &Graph, order: &[usize]) -> Result<Self> {
        let (order, nodes) = Supernodes::of(graph, order)?;
        let mut position = filled(graph.order(), NONE, "the order of a body")?;
        order.iter().enumerate().for_each(|(at, &dof)| position[dof] = at);
        Ok(Self { order, position, nodes })
    }

    /// Multiplications of a factorisation.
    pub fn work(&self) -> f64 {
        self.nodes.nodes().map(|node| node.work()).sum()
    }

    /// Rows of the highest front.
    pub fn highest_front(&self) -> usize {
        self.nodes.nodes().map(|node| node.height()).max().unwrap_or(0)
    }

    /// Entries of L.
    pub fn entries(&self) -> usize {
        self.nodes.values()
    }
}

fn analysis_headroom(matrix: &Symmetric) -> Result<Headroom> {
    headroom(
        matrix.order() * ANALYSIS_PER_DOF + matrix.val.len() * ANALYSIS_PER_ENTRY,
        "the ordering of a body",
    )
}
