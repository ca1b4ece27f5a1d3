//! A body into pieces: connected through faces, of about equal size, with few unknowns between them. The same for any number of
//! threads, and in any unit.
//!
//! Elements that lie in others, or are much smaller (springs, penalties, constraints), go with these. The rest is a graph: neighbours
//! share a face. It is cut by planes where centres are known, as long as both sides hang together, else by the graph itself.

mod coarse;
mod directions;
mod graph;
mod halves;
mod hosts;
mod incidence;
mod sections;
#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::platform::memory::{filled, reserved};
use graph::{shares, Graph};
use hosts::hosts;
use incidence::{Incidence, NONE, WHAT};
use sections::sections;

/// Bodies with fewer unknowns are not worth a cut.
const WORTH: usize = 60_000;
/// Unknowns of a piece.
const PIECE: f64 = 1100.0;
/// Times that what has come loose of a piece is looked for.
const MENDINGS: usize = 4;

/// Elements by the unknowns that they join: e has `dof[ptr[e]..ptr[e + 1]]`, held unknowns left out.
pub struct Elements<'a> {
    pub ptr: &'a [usize],
    pub dof: &'a [u32],
    pub unknowns: usize,
}

/// How many pieces a body of so many unknowns is cut into, 1: none. A cube is cut as often along each edge.
pub fn pieces_for(unknowns: usize) -> usize {
    if unknowns < WORTH {
        1
    } else {
        ((unknowns as f64 / PIECE).cbrt().round() as usize).pow(3)
    }
}

/// The piece of every element, numbered from 0 without gaps: about `pieces` of them, at least one for each part of the body.
/// `centres`: of the elements, length, where coordinates are known.
pub fn cut(elements: &Elements, centres: Option<&[[f64; 3]]>, pieces: usize) -> Result<Vec<u32>> {
    let all = Incidence::of(elements)?;
    let host = hosts(&all)?;
    let mut kept: Vec<u32> = reserved(host.len(), WHAT)?;
    kept.extend((0..host.len() as u32).filter(|e| host[*e as usize] == NONE));
    let graph = Graph::of(&all.of_some(&kept)?)?;
    let mut own = reserved(if centres.is_some() { kept.len() } else { 0 }, WHAT)?;
    own.extend(centres.iter().flat_map(|centres| kept.iter().map(|&e| centres[e as usize])));
    let (mut piece, weights) = graph.parts(&filled(graph.count(), 0, WHAT)?)?;
    let mut vertices = filled(weights.len(), 0, WHAT)?;
    piece.iter().for_each(|&part| vertices[part as usize] += 1);
    let shares = shares(&weights, &vertices, pieces);
    sections(&graph, centres.map(|_| &own[..]), &mut piece, &shares)?;
    mend(&graph, &mut piece)?;
    let mut of_all = filled(host.len(), NONE, WHAT)?;
    kept.iter().zip(&piece).for_each(|(&e, &piece)| of_all[e as usize] = piece);
    for e in 0..host.len() {
        let mut with = e;
        while host[with] != NONE && host[with] as usize != with {
            with = host[with] as usize;
        }
        of_all[e] = of_all[with];
    }
    number(&mut of_all)?;
    Ok(of_all)
}

/// What has come loose of a piece joins the piece that it shares most unknowns with.
fn mend(graph: &Graph, piece: &mut [u32]) -> Result<()> {
    for _ in 0..MENDINGS {
        let (fragment, weights) = graph.parts(piece)?;
        let count = piece.iter().max().map_or(0, |last| *last as usize + 1);
        let mut largest = filled(count, NONE, WHAT)?;
        for (&own, &of) in fragment.iter().zip(piece.iter()) {
            let best = &mut largest[of as usize];
            if *best == NONE || weights[own as usize] > weights[*best as usize] {
                *best = own;
            }
        }
        let is_loose = |i: usize, piece: &[u32]| largest[piece[i] as usize] != fragment[i];
        let mut bonds = Vec::new();
        for i in (0..graph.count()).filter(|&i| is_loose(i, piece)) {
            let outside = graph.around(i).filter(|&(j, _)| piece[j] != piece[i] && !is_loose(j, piece));
            bonds.extend(outside.map(|(j, share)| (fragment[i], piece[j], share)));
        }
        if bonds.is_empty() {
            return Ok(());
        }
        bonds.sort_unstable();
        let mut best = filled(weights.len(), (0, NONE), WHAT)?;
        for alike in bonds.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (of, to, shared) =
                (alike[0].0 as usize, alike[0].1, alike.iter().map(|bond| bond.2).sum::<u32>());
            if shared > best[of].0 {
                best[of] = (shared, to);
            }
        }
        for (own, of) in fragment.iter().zip(piece.iter_mut()) {
            if best[*own as usize].1 != NONE {
                *of = best[*own as usize].1;
            }
        }
    }
    Ok(())
}

/// Numbers without gaps, in the order of the first element; elements without unknowns that may move are of the first piece.
fn number(piece: &mut [u32]) -> Result<()> {
    let count = piece.iter().filter(|piece| **piece != NONE).max().map_or(0, |last| *last as usize + 1);
    let (mut new, mut next) = (filled(count, NONE, WHAT)?, 0);
    for own in piece.iter_mut() {
        let Some(number) = new.get_mut(*own as usize) else {
            *own = 0;
            continue;
        };
        if *number == NONE {
            *number = next;
            next += 1;
        }
        *own = *number;
    }
    Ok(())
}
