//! The pieces of all sub-faces of a slave, and which of them belong to a node.

use crate::error::Result;
use crate::platform::interrupt::check;
use crate::platform::memory::headroom;
use crate::platform::threads::run;
use crate::surface::areas::Depth;
use crate::surface::find::{Master, Rule};
use crate::surface::mortar::integrals::pieces;
use crate::surface::mortar::piece::Piece;
use crate::surface::rows::Slave;

/// Where a slave has met its master.
#[derive(Debug, Clone, Default)]
pub struct Mortar {
    pieces: Vec<Piece>,
    /// Of each node of the slave where its pieces begin in `of_node`, and their end.
    start: Vec<u32>,
    /// Pieces and corners.
    of_node: Vec<(u32, u8)>,
}

/// Faces of one task.
const TOGETHER: usize = 64;
/// Bytes of a piece, and of the nodes of a face of the master in pieces.
const PER_PIECE: usize = 1024;
const PER_MASTER: usize = 1024;

impl Mortar {
    /// Pieces in the order of the slave's faces.
    pub fn find(threads: usize, slave: &Slave, master: &Master, rule: &Rule, depth: Depth) -> Result<Self> {
        let faces = slave.faces;
        let sub_faces: usize = (0..faces.len()).map(|face| faces.shape(face).sub_faces().len()).sum();
        let (each, others) = match master {
            Master::Faces(placed, _) => (1, placed.faces.len()),
            Master::Rigid(_) => (9, 0),
        };
        let room =
            sub_faces.saturating_mul(each * PER_PIECE).saturating_add(others.saturating_mul(PER_MASTER));
        let _room = headroom(room, "segments of surfaces")?;
        let of_task = run(threads, faces.len().div_ceil(TOGETHER), |task| {
            check()?;
            let own = TOGETHER * task..faces.len().min(TOGETHER * (task + 1));
            let sub_faces =
                own.flat_map(|face| faces.shape(face).sub_faces().iter().map(move |of| (face, of)));
            Ok(sub_faces
                .flat_map(|(face, of)| pieces(slave, face, of, master, rule, depth))
                .collect::<Vec<_>>())
        })?;
        let pieces: Vec<Piece> = of_task.into_iter().flatten().collect();
        Ok(Self::sorted(slave, pieces))
    }

    fn sorted(slave: &Slave, pieces: Vec<Piece>) -> Self {
        let mut start = vec![0u32; slave.faces.nodes + 1];
        let node = |piece: &Piece, c: usize| {
            slave.faces.nodes_of(piece.face as usize)[piece.corners[c] as usize] as usize
        };
        let corners =
            |piece: &Piece| (0..piece.count as usize).filter(|c| piece.area[*c] != 0.0).collect::<Vec<_>>();
        for piece in &pieces {
            corners(piece).iter().for_each(|c| start[node(piece, *c) + 1] += 1);
        }
        (0..slave.faces.nodes).for_each(|k| start[k + 1] += start[k]);
        let (mut next, mut of_node) = (start.clone(), vec![(0, 0); start[slave.faces.nodes] as usize]);
        for (k, piece) in pieces.iter().enumerate() {
            for c in corners(piece) {
                let place = &mut next[node(piece, c)];
                of_node[*place as usize] = (k as u32, c as u8);
                *place += 1;
            }
        }
        Self { pieces, start, of_node }
    }

    /// The pieces of a node and its corner there.
    pub(super) fn of(&self, node: u32) -> impl Iterator<Item = (&Piece, usize)> + Clone {
        let own = self.start[node as usize] as usize..self.start[node as usize + 1] as usize;
        self.of_node[own].iter().map(|(piece, corner)| (&self.pieces[*piece as usize], *corner as usize))
    }

    /// `A_j = int Phi_j`, length^2.
    pub fn area(&self, node: u32) -> f64 {
        self.of(node).map(|(piece, c)| piece.area[c]).sum()
    }

    /// Areas of all nodes.
    #[cfg(test)]
    pub fn areas(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.start.len() as u32 - 1).map(|node| self.area(node))
    }

    /// Bytes of its pieces.
    #[cfg(test)]
    pub fn bytes(&self) -> usize {
        let nodes: usize = self.pieces.iter().map(|piece| piece.master.len()).sum();
        self.pieces.len() * size_of::<Piece>()
            + nodes * size_of::<(u32, [f64; 4])>()
            + 12 * self.of_node.len()
    }
}
