//! Facts on a pair of surfaces, as a struct of the header without padding.
#![allow(non_camel_case_types)]

/// What a pair of surfaces carries and where it is closed, by the last answer, and where it overlaps, at the present positions. Nodes are
/// those of the surface, from 0. Without an answer forces and counts of states are 0.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_pair_facts {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// Slave nodes that have a row, or of a tie a row in each direction.
    pub rows: i64,
    /// Those of them that had no partner in the last find.
    pub without: i64,
    /// Nodes that are closed.
    pub closed: i64,
    /// Closed nodes that stick; of a tie all nodes with a partner.
    pub sticking: i64,
    /// Closed nodes that slip.
    pub slipping: i64,
    /// Force on the slave, force: the sum over all nodes.
    pub force: [f64; 3],
    /// Moment of these forces about the origin at the present positions, force times length.
    pub moment: [f64; 3],
    /// Sum of the areas of closed nodes, length^2.
    pub closed_area: f64,
    /// Largest pressure, force per area; 0 if no node presses, or if the surface has no faces.
    pub pressure: f64,
    /// Slave node with this pressure; -1: none.
    pub pressure_node: i64,
    /// Largest angle between the normal of a closed node and that of the master where it meets it, radian: 0 by node-to-face; by mortar the
    /// force of this node has the wrong direction by so much.
    pub angle: f64,
    /// This node; -1: none.
    pub angle_node: i64,
    /// Deepest penetration of a slave node into the master, below its offset, length; 0: none.
    pub depth: f64,
    /// This node; -1: none.
    pub depth_node: i64,
    /// Deepest penetration of a node of the master into the slave, length; 0: none.
    pub master_depth: f64,
    /// This node of the master; -1: none.
    pub master_depth_node: i64,
    /// Nodes between two walls of the master, which have a row with only one of them: give the walls as two surfaces.
    pub between_walls: i64,
    /// The first of these nodes; -1: none.
    pub between_walls_node: i64,
    /// Rows of the last find whose unknowns are all held; they are switched off.
    pub held: i64,
    /// Deepest overlap of these rows, length.
    pub held_overlap: f64,
}
