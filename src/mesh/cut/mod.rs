//! The cut of one body into pieces that are connected by faces, of nearly equal size, with few shared unknowns.
//!
//! Elements that lie inside others join their pieces (`hosts`). The remaining elements are cut into slabs by planes if
//! their centres are known, otherwise through the graph of their faces (`sections`, `halves`). Then scraps are given to
//! neighbours (`scraps`), and single elements are moved while this reduces the number of shared unknowns (`refine`).

mod directions;
mod graph;
mod halves;
mod hosts;
mod incidence;
mod refine;
mod scraps;
mod sections;
mod smooth;
#[cfg(test)]
mod tests;

use crate::error::{Error, Kind, Result};
use crate::numbers::cut::PIECE;
use crate::platform::interrupt;
use crate::platform::memory::{filled, reserved};
use graph::{faces, shares};
use incidence::{Incidence, NONE, WHAT};

/// The unknowns of the elements, without held unknowns: element `e` has `dof[ptr[e]..ptr[e+1]]`, each less than
/// `unknowns`.
pub struct Elements<'a> {
    pub ptr: &'a [usize],
    pub dof: &'a [u32],
    pub unknowns: usize,
}

/// Smaller bodies are solved faster without a cut, for each solve expected: later solves of a cut body take half of the time of the
/// first, those of a whole one a twentieth.
const WHOLE: usize = 40_000;

/// The number of pieces for a body with this number of unknowns and of solves expected. A cube is cut equally often along each edge.
pub fn pieces_for(unknowns: usize, solves: usize) -> usize {
    if unknowns / solves.max(1) < WHOLE {
        1
    } else {
        ((unknowns as f64 / PIECE).cbrt().round() as usize).pow(3)
    }
}

/// The piece of every element, numbered from 0 without gaps. There are `pieces` pieces, fewer if there are fewer
/// elements, more if the body has more parts that share no face (one piece each); 1 leaves the body whole.
///
/// `centres`: of the elements in any unit, if known; if an entry is NaN, they count as not known.
pub fn cut(elements: &Elements, centres: Option<&[[f64; 3]]>, pieces: usize) -> Result<Vec<u32>> {
    let all = Incidence::of(elements)?;
    if centres.is_some_and(|centres| centres.len() != all.count()) {
        return Err(Error::new(Kind::Argument("centres"), "there must be one centre per element"));
    }
    if pieces <= 1 {
        return filled(all.count(), 0, WHAT);
    }
    let host = hosts::hosts(&all)?;
    let mut kept = reserved(all.count(), WHAT)?;
    kept.extend((0..all.count() as u32).filter(|&e| host[e as usize] == NONE));
    let incidence = all.of_some(&kept)?;
    drop(all);
    let centres = centres.map(|centres| scaled(centres, &kept)).transpose()?.flatten();
    let piece = cut_all(&incidence, centres.as_deref(), pieces)?;
    with_guests(&host, &kept, &piece)
}

/// The pieces of elements without hosts.
fn cut_all(incidence: &Incidence, centres: Option<&[[f64; 3]]>, pieces: usize) -> Result<Vec<u32>> {
    let graph = faces(incidence)?;
    let (mut piece, weights) = graph.parts(&filled(graph.count(), 0, WHAT)?)?;
    let mut vertices = filled(weights.len(), 0, WHAT)?;
    piece.iter().for_each(|&part| vertices[part as usize] += 1);
    let shares = shares(&weights, &vertices, pieces)?;
    let count = shares.iter().sum();
    match centres {
        Some(_) => sections::sections(&graph, centres, &mut piece, &shares)?,
        None => sections::by_levels(&graph, &mut piece, &shares)?,
    }
    scraps::give(&graph, &mut piece, count)?;
    refine::refine(incidence, &graph, &mut piece, count)?;
    scraps::give(&graph, &mut piece, count)?;
    numbered(&mut piece, count)?;
    Ok(piece)
}

/// Centres of the elements `kept`, moved and scaled by a power of two so that the largest entry is about 1; none if an
/// entry is NaN.
fn scaled(centres: &[[f64; 3]], kept: &[u32]) -> Result<Option<Vec<[f64; 3]>>> {
    let mut points = reserved(kept.len(), WHAT)?;
    points.extend(kept.iter().map(|&e| centres[e as usize]));
    if points.iter().flatten().any(|x: &f64| !x.is_finite()) {
        return Ok(None);
    }
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for x in &points {
        (0..3).for_each(|k| (low[k], high[k]) = (low[k].min(x[k]), high[k].max(x[k])));
    }
    let largest = (0..3).map(|k| 0.5 * high[k] - 0.5 * low[k]).fold(0.0, f64::max);
    if !(largest > f64::MIN_POSITIVE) {
        return Ok(None);
    }
    // only the exponent: the scaling changes no digit
    let unit = f64::from_bits(largest.to_bits() & !((1_u64 << 52) - 1));
    for x in &mut points {
        (0..3).for_each(|k| x[k] = (x[k] - (0.5 * low[k] + 0.5 * high[k])) / unit);
    }
    Ok(Some(points))
}

/// Elements with hosts get the pieces of these, through several hosts if necessary; elements without unknowns get the
/// first piece.
fn with_guests(host: &[u32], kept: &[u32], piece: &[u32]) -> Result<Vec<u32>> {
    let mut all = filled(host.len(), NONE, WHAT)?;
    kept.iter().zip(piece).for_each(|(&e, &p)| all[e as usize] = p);
    for e in 0..host.len() {
        let mut last = e;
        while all[last] == NONE && host[last] as usize != last {
            last = host[last] as usize;
        }
        let found = if all[last] == NONE { 0 } else { all[last] };
        let mut next = e;
        while all[next] == NONE {
            all[next] = found;
            next = host[next] as usize;
        }
    }
    Ok(all)
}

/// Renumbers the pieces without gaps, in their order.
fn numbered(piece: &mut [u32], count: usize) -> Result<()> {
    interrupt::check()?;
    let mut number: Vec<u32> = filled(count, NONE, WHAT)?;
    piece.iter().for_each(|&p| number[p as usize] = 0);
    let used = number.iter_mut().filter(|number| **number == 0);
    used.zip(0..).for_each(|(number, next)| *number = next);
    piece.iter_mut().for_each(|p| *p = number[*p as usize]);
    Ok(())
}
