//! Pieces that are not connected: all parts of a piece except the heaviest are given to neighbours.

use super::incidence::{NONE, WHAT};
use crate::error::Result;
use crate::linalg::partition::Weighted;
use crate::platform::interrupt;
use crate::platform::memory::{filled, reserved};

/// Gives every part of a piece except its heaviest to the piece that shares most unknowns with it, until every piece is
/// connected.
pub fn give(graph: &Weighted, piece: &mut [u32], count: usize) -> Result<()> {
    loop {
        interrupt::check()?;
        let (part, weights) = graph.parts(piece)?;
        if weights.len() <= count || !given(graph, piece, count, (&part, &weights))? {
            return Ok(());
        }
    }
}

/// One round; returns whether any part was given away.
fn given(graph: &Weighted, piece: &mut [u32], count: usize, parts: (&[u32], &[f64])) -> Result<bool> {
    let (part, weights) = parts;
    let mut heaviest: Vec<u32> = filled(count, NONE, WHAT)?;
    for i in 0..graph.count() {
        let best = &mut heaviest[piece[i] as usize];
        if *best == NONE || weights[part[i] as usize] > weights[*best as usize] {
            *best = part[i];
        }
    }
    // unknowns shared by each scrap and the pieces around it
    let mut touching: Vec<(u32, u32, u32)> = Vec::new();
    for i in (0..graph.count()).filter(|&i| heaviest[piece[i] as usize] != part[i]) {
        for (j, share) in graph.around(i).filter(|&(j, _)| piece[j] != piece[i]) {
            // only parts that stay in their piece
            if heaviest[piece[j] as usize] == part[j] {
                touching.push((part[i], piece[j], share));
            }
        }
    }
    touching.sort_unstable();
    let mut goes: Vec<u32> = filled(weights.len(), NONE, WHAT)?;
    let mut most: Vec<u64> = filled(weights.len(), 0, WHAT)?;
    for same in touching.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let sum = same.iter().map(|t| u64::from(t.2)).sum();
        let at = same[0].0 as usize;
        if sum > most[at] {
            (goes[at], most[at]) = (same[0].1, sum);
        }
    }
    let mut new = reserved(graph.count(), WHAT)?;
    new.extend((0..graph.count()).map(|i| goes[part[i] as usize]));
    let mut any = false;
    for (i, new) in new.into_iter().enumerate().filter(|(_, new)| *new != NONE) {
        piece[i] = new;
        any = true;
    }
    Ok(any)
}
