//! Moves vertices of a graph, which are groups of elements, to the neighbouring piece with which they share more.

use super::incidence::WHAT;
use crate::error::Result;
use crate::linalg::partition::Weighted;
use crate::numbers::cut::FULL_BY_WEIGHT;
use crate::platform::interrupt;
use crate::platform::memory::filled;

const ROUNDS: usize = 6;

pub fn smooth(graph: &Weighted, piece: &mut [u32], count: usize) -> Result<()> {
    let mut weight = filled(count, 0.0, WHAT)?;
    (0..graph.count()).for_each(|i| weight[piece[i] as usize] += graph.weight[i]);
    let most = FULL_BY_WEIGHT * weight.iter().sum::<f64>() / count as f64;
    let mut near: Vec<(u32, i64)> = Vec::new();
    for _ in 0..ROUNDS {
        interrupt::check()?;
        let mut moves = 0;
        for i in 0..graph.count() {
            shared(graph, piece, i, &mut near);
            let (from, own) = (piece[i], graph.weight[i]);
            let here = near.iter().find(|n| n.0 == from).map_or(0, |n| n.1);
            let heavy = weight[from as usize] > most;
            let better = |&&(to, share): &&(u32, i64)| {
                let after = weight[to as usize] + own;
                let lighter = after < weight[from as usize];
                to != from
                    && (after <= most || heavy && lighter)
                    && (share > here || lighter && (share == here || heavy))
            };
            let best = near.iter().filter(better).max_by_key(|n| (n.1, std::cmp::Reverse(n.0)));
            // the only vertex of a piece must stay, or the piece would be empty
            if let Some(&(to, _)) = best.filter(|_| here > 0) {
                piece[i] = to;
                weight[from as usize] -= own;
                weight[to as usize] += own;
                moves += 1;
            }
        }
        if moves == 0 {
            break;
        }
    }
    Ok(())
}

/// Number of unknowns that a vertex shares with each piece around it.
fn shared(graph: &Weighted, piece: &[u32], i: usize, near: &mut Vec<(u32, i64)>) {
    near.clear();
    for (j, share) in graph.around(i) {
        match near.iter_mut().find(|n| n.0 == piece[j]) {
            Some(n) => n.1 += i64::from(share),
            None => near.push((piece[j], i64::from(share))),
        }
    }
}
