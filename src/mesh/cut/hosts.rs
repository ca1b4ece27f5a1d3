//! Elements that join the piece of another element: springs, penalties, constraints, and elements that lie inside another.

use super::incidence::{Incidence, Neighbours, NONE, WHAT};
use crate::error::Result;
use crate::platform::interrupt;
use crate::platform::memory::reserved;

/// The element that each goes with, `NONE` for those that are cut; `e` itself where it has no unknowns and goes with anyone.
///
/// An element goes with one that has all its unknowns; of those that it shares with any, with one of at least twice its size that
/// has more than half, or of four times its size that has half. The host is larger, or has a smaller number where both have the
/// same unknowns: no circles.
pub fn hosts(incidence: &Incidence) -> Result<Vec<u32>> {
    let count = incidence.count();
    let mut room = Neighbours::room(count)?;
    let (mut host, mut sizes): (Vec<u32>, Vec<u32>) = (reserved(count, WHAT)?, reserved(count, WHAT)?);
    sizes.extend((0..count).map(|e| incidence.size(e)));
    for e in 0..count {
        if e % 4096 == 0 {
            interrupt::check()?;
        }
        let shared = |n: &&u32| incidence.elements(**n).len() > 1;
        let shared: u32 =
            incidence.nodes(e).iter().filter(shared).map(|&n| incidence.weight[n as usize]).sum();
        let (mut best, mut most) = (NONE, 0);
        incidence.neighbours(e, &mut room, |f, share| {
            if share > most && is_host(&sizes, (e, f as usize), share, shared) {
                (best, most) = (f, share);
            }
        });
        host.push(if sizes[e] == 0 { e as u32 } else { best });
    }
    Ok(host)
}

fn is_host(sizes: &[u32], (e, f): (usize, usize), share: u32, shared: u32) -> bool {
    let (size, other) = (sizes[e], sizes[f]);
    share == size && (other > size || f < e)
        || 2 * share > shared && other >= 2 * size
        || 2 * share == shared && other >= 4 * size
}
