//! The graph to be cut: vertices are elements, or groups of elements; edges join neighbours across a face.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::incidence::{Incidence, Neighbours, WHAT};
use crate::error::Result;
use crate::linalg::partition::Weighted;
use crate::platform::interrupt;
use crate::platform::memory::{ensure_spare, filled, refusal, reserved};

/// Two elements have a common face if they share at least this part of the largest number of unknowns that either shares
/// with a neighbour. A common edge has at most 2/3 of the unknowns of a face (linear tetrahedra), a triangle 3/4 of those
/// of a quadrangle (pyramids, wedges).
const FACE: (u32, u32) = (3, 4);

/// The graph of the elements; edges have the numbers of unknowns shared.
pub fn faces(incidence: &Incidence) -> Result<Weighted> {
    let count = incidence.count();
    let mut room = Neighbours::room(count)?;
    let mut most: Vec<u32> = filled(count, 0, WHAT)?;
    for e in 0..count {
        if e % 4096 == 0 {
            interrupt::check()?;
        }
        let mut here = 0;
        incidence.neighbours(e, &mut room, |_, share| here = here.max(share));
        most[e] = here;
    }
    let (mut ptr, mut adj, mut edge) = (reserved(count + 1, WHAT)?, Vec::new(), Vec::new());
    let mut here: Vec<(u32, u32)> = Vec::new();
    ptr.push(0);
    for e in 0..count {
        if e % 4096 == 0 {
            interrupt::check()?;
        }
        here.clear();
        incidence.neighbours(e, &mut room, |f, share| {
            if FACE.1 * share >= FACE.0 * most[e].min(most[f as usize]) {
                here.push((f, share));
            }
        });
        enlarge(&mut adj, here.len())?;
        enlarge(&mut edge, here.len())?;
        adj.extend(here.iter().map(|h| h.0));
        edge.extend(here.iter().map(|h| h.1));
        ptr.push(adj.len());
    }
    Ok(Weighted { ptr, adj, edge, weight: weights(incidence)? })
}

/// Reserves room for `more` entries; if it must grow, by half of the length.
fn enlarge(list: &mut Vec<u32>, more: usize) -> Result<()> {
    if list.capacity() - list.len() >= more {
        return Ok(());
    }
    let bytes = size_of::<u32>() * (list.len() + list.len() / 2 + more);
    ensure_spare(bytes, WHAT)?;
    list.try_reserve_exact(list.len() / 2 + more + 1024).map_err(|_| refusal(bytes, WHAT))
}

/// Weights whose sums over the pieces shall be equal: the number of unknowns of an element, divided by the largest number of
/// elements at one of its nodes. Equal elements have equal weights, at the surface of the body as inside.
fn weights(incidence: &Incidence) -> Result<Vec<f64>> {
    let mut weights = reserved(incidence.count(), WHAT)?;
    for e in 0..incidence.count() {
        let most = incidence.nodes(e).iter().map(|&n| incidence.elements(n).len()).max().unwrap_or(1);
        weights.push(f64::from(incidence.size(e).max(1)) / most.max(1) as f64);
    }
    Ok(weights)
}

/// The number of pieces of each part: in proportion to its weight, at least one, at most its number of vertices.
pub fn shares(weights: &[f64], vertices: &[usize], pieces: usize) -> Result<Vec<usize>> {
    let total: f64 = weights.iter().sum();
    let mut shares = filled(weights.len(), 1, WHAT)?;
    let mut left = pieces.saturating_sub(weights.len());
    // integer parts first, then one by one to the part with the heaviest pieces
    for part in 0..shares.len() {
        let wish = (pieces as f64 * weights[part] / total) as usize;
        let more = wish.min(vertices[part]).saturating_sub(1).min(left);
        shares[part] += more;
        left -= more;
    }
    let need = |part: usize, share: usize| Need(weights[part] / share as f64, Reverse(part));
    let open = (0..shares.len()).filter(|&part| shares[part] < vertices[part]);
    let mut by_need: BinaryHeap<Need> = open.map(|part| need(part, shares[part])).collect();
    while let Some(Need(_, Reverse(part))) = by_need.pop().filter(|_| left > 0) {
        shares[part] += 1;
        left -= 1;
        if shares[part] < vertices[part] {
            by_need.push(need(part, shares[part]));
        }
    }
    Ok(shares)
}

/// A part and the weight of its pieces.
struct Need(f64, Reverse<usize>);

impl Ord for Need {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

impl PartialOrd for Need {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Need {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Need {}
