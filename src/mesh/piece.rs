//! The stiffness matrix of a piece of a body, assembled from its elements.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::Symmetric;
use crate::mesh::connectivity::{Connectivity, Place};
use crate::mesh::pattern::Local;
use crate::platform::memory::{copied, filled, reserved};

const WHAT: &str = "the pieces of a body";

/// A part of a body with a separate stiffness matrix.
#[derive(Debug, Clone)]
pub struct Piece {
    /// Its unknowns within the body, ascending.
    pub dofs: Arc<[u32]>,
    /// Its K over them, force / length.
    pub stiffness: Arc<Symmetric>,
}

impl Piece {
    /// Adds the lower triangle of `(ke + ke') / 2`, `ke(i, j)` over the rows and columns of the element.
    pub fn add(&mut self, places: &[Place], ke: impl Fn(usize, usize) -> f64) {
        let found = |dof: usize| self.dofs.binary_search(&(dof as u32)).ok();
        let mut own: Vec<(usize, usize)> = Vec::with_capacity(places.len());
        own.extend(places.iter().enumerate().filter_map(|(at, place)| match place {
            Place::Free(dof) => Some((found(*dof)?, at)),
            Place::Held(_) => None,
        }));
        own.sort_unstable();
        let k = Arc::make_mut(&mut self.stiffness);
        let (ptr, col, val) = (&k.ptr, &k.col, k.val.to_mut());
        for (last, &(row, i)) in own.iter().enumerate() {
            let mut at = ptr[row];
            for &(column, j) in &own[..=last] {
                at += col[at..ptr[row + 1]].iter().take_while(|c| (**c as usize) < column).count();
                let (one, other) = (ke(i, j), ke(j, i));
                let mean = if one == other { one } else { 0.5 * one + 0.5 * other };
                // an unknown that occurs twice in an element gets both triangles
                val[at] += if column == row && i != j { 2.0 * mean } else { mean };
            }
        }
    }

    /// A zero matrix with this pattern; the present matrix may still be in use elsewhere.
    pub fn cleared(&self) -> Result<Arc<Symmetric>> {
        let Symmetric { ptr, col, val, .. } = &*self.stiffness;
        let (ptr, col) = (copied(ptr, WHAT)?, copied(col, WHAT)?);
        Ok(Arc::new(Symmetric::new(ptr, col, filled(val.len(), 0.0, WHAT)?)))
    }
}

/// The pieces of a body, without values; `piece_of`: the piece of every element. Unknowns without element belong to the
/// first piece.
pub fn pieces(all: &Connectivity, piece_of: &[u32]) -> Result<Vec<Piece>> {
    let count = piece_of.iter().max().map_or(1, |last| *last as usize + 1);
    let (ptr, members) = by_piece(piece_of, count)?;
    let alone = in_no_element(all)?;
    let mut local = filled(all.unknowns(), u32::MAX, WHAT)?;
    let mut made = reserved(count, WHAT)?;
    for piece in 0..count {
        let members = &members[ptr[piece]..ptr[piece + 1]];
        let entries = members.iter().map(|&e| all.free(e as usize).count()).sum();
        let mut dofs: Vec<u32> = reserved(entries + alone.len(), WHAT)?;
        members.iter().for_each(|&e| dofs.extend(all.free(e as usize)));
        dofs.extend(if piece == 0 { &alone[..] } else { &[] });
        dofs.sort_unstable();
        dofs.dedup();
        dofs.iter().enumerate().for_each(|(at, &dof)| local[dof as usize] = at as u32);
        let mut own = Local::with_room(members.len(), entries, dofs.len())?;
        members.iter().for_each(|&e| own.push(all.free(e as usize).map(|dof| local[dof as usize])));
        made.push(Piece { dofs: dofs.into(), stiffness: Arc::new(own.pattern()?) });
    }
    Ok(made)
}

/// Unknowns without element, ascending.
fn in_no_element(all: &Connectivity) -> Result<Vec<u32>> {
    let mut met = filled(all.unknowns(), false, WHAT)?;
    (0..all.elements()).flat_map(|e| all.free(e)).for_each(|dof| met[dof as usize] = true);
    let mut alone = reserved(met.iter().filter(|met| !**met).count(), WHAT)?;
    alone.extend((0..all.unknowns() as u32).filter(|dof| !met[*dof as usize]));
    Ok(alone)
}

/// The elements of every piece, ascending.
fn by_piece(piece_of: &[u32], count: usize) -> Result<(Vec<usize>, Vec<u32>)> {
    let (mut ptr, mut members) = (filled(count + 1, 0, WHAT)?, filled(piece_of.len(), 0, WHAT)?);
    piece_of.iter().for_each(|&piece| ptr[piece as usize + 1] += 1);
    (0..count).for_each(|piece| ptr[piece + 1] += ptr[piece]);
    let mut next = ptr.clone();
    for (element, &piece) in piece_of.iter().enumerate() {
        members[next[piece as usize]] = element as u32;
        next[piece as usize] += 1;
    }
    Ok((ptr, members))
}
