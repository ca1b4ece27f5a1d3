//! Coordinates of the forces of a node: normal, along the slip, across the slip. In each coordinate the linear model of
//! the laws either prescribes a value of x or is an equation for gaps and slips.

use crate::linalg::Csr;
use crate::qp::friction::cones::Cones;

/// The linear model in one coordinate; `s = w'x - coupling x_n`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// `s = value`
    Held { value: f64 },
    /// `w'r + damping s = shift`, damping >= 0.
    Free { damping: f64, shift: f64 },
}

/// `w'r = 0`
pub const EQUATION: Law = Law::Free { damping: 0.0, shift: 0.0 };

/// One vector w of an orthonormal basis of the forces: a single row, or a combination of two tangential rows of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    /// Rows with their entries in w.
    pub rows: [usize; 2],
    pub along: [f64; 2],
    /// Coefficient of the normal coordinate of the node in s, and the number of places by which that coordinate comes
    /// before this one.
    pub coupling: Option<(usize, f64)>,
    pub law: Law,
}

impl Coordinate {
    pub fn row(row: usize, law: Law) -> Self {
        Self { rows: [row; 2], along: [1.0, 0.0], coupling: None, law }
    }

    /// `w'x`
    pub fn of(&self, x: &[f64]) -> f64 {
        self.along[0] * x[self.rows[0]] + self.along[1] * x[self.rows[1]]
    }

    /// `x += y w`
    pub fn add(&self, y: f64, x: &mut [f64]) {
        x[self.rows[0]] += self.along[0] * y;
        x[self.rows[1]] += self.along[1] * y;
    }

    pub fn is_free(&self) -> bool {
        matches!(self.law, Law::Free { .. })
    }

    /// Weight of an equation, as a force: `1 / (1 + rho damping)`, 0 if a value is held.
    pub fn weight(&self, rho: f64) -> f64 {
        match self.law {
            Law::Held { .. } => 0.0,
            Law::Free { damping, .. } => 1.0 / (1.0 + rho * damping),
        }
    }
}

/// Every row as a coordinate, in the order of the coordinates of a face: rows of nodes, node by node, then free rows.
pub fn of_rows(cones: &Cones) -> Vec<Coordinate> {
    let of_nodes =
        cones.nodes().iter().flat_map(|node| node.own_normal().into_iter().chain(node.tangents().to_vec()));
    of_nodes.chain(cones.free().iter().copied()).map(|row| Coordinate::row(row, EQUATION)).collect()
}

/// Rows of G' of every coordinate, with a pattern common to all faces: a normal coordinate has the columns of all nodes with this
/// normal row, since friction couples it to the others.
pub fn pattern(cones: &Cones, g_transposed: &Csr) -> Csr {
    let mut pattern = Csr::empty(g_transposed.cols);
    let columns_of = |rows: &mut dyn Iterator<Item = usize>| {
        let mut columns: Vec<usize> = rows.flat_map(|i| g_transposed.row(i).map(|(j, _)| j)).collect();
        columns.sort_unstable();
        columns.dedup();
        columns
    };
    for nodes in cones.groups() {
        if let Some(normal) = nodes[0].normal {
            let tangents = nodes.iter().flat_map(|node| node.tangents().iter().copied());
            let all = columns_of(&mut std::iter::once(normal).chain(tangents));
            pattern.push_row(all.into_iter().map(|j| (j, 0.0)));
        }
        for node in nodes {
            let tangential = columns_of(&mut node.tangents().iter().copied());
            node.tangents().iter().for_each(|_| pattern.push_row(tangential.iter().map(|&j| (j, 0.0))));
        }
    }
    for &row in cones.free() {
        pattern.push_row(g_transposed.row(row).map(|(j, _)| (j, 0.0)));
    }
    pattern
}
