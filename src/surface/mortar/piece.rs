//! Integrals over one sub-face of a slave.

use crate::surface::rigid::RigidFoot;
use crate::surface::shape::MOST;

/// The integrals of one sub-face of the slave with all faces of the master; of a rigid master those of one point.
#[derive(Debug, Clone)]
pub struct Piece {
    pub face: u32,
    /// Local numbers of the corners of the sub-face, and how many there are.
    pub corners: [u8; 4],
    pub count: u8,
    /// `int Phi_j`, area, of each corner; of one point it may be below 0.
    pub area: [f64; 4],
    /// D: `int Phi_j N_k` for the nodes of the face.
    pub slave: [[f64; MOST]; 4],
    /// M: nodes of the master, ascending, with `int Phi_j N_l`.
    pub master: Vec<(u32, [f64; 4])>,
    pub rigid: Option<RigidFoot>,
    /// To which the edge leads that gives the first tangent of each corner.
    pub along: [u32; 4],
    /// Between -n0 and the normal of the master, radian.
    pub angle: f64,
}
