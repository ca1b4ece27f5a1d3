//! Elements that go with another one: springs, penalties, constraints, and those that lie in another.

use super::incidence::{Incidence, Neighbours, NONE, WHAT};
use crate::error::Result;
use crate::platform::interrupt;
use crate::platform::memory::reserved;

/// The element that each goes with, `NONE` for those that are cut; `e` itself where it has no unknowns and goes with anyone.
///
/// An element goes with one that has all its unknowns but those that it alone has, or with one of at least twice its size that
/// has half of them. The host is larger, or has a smaller number where both have the same unknowns: no circles.
pub fn hosts(incidence: &Incidence) -> Result<Vec<u32>> {
    let count = incidence.count();
    let mut room = Neighbours::room(count)?;
    let mut host: Vec<u32> = reserved(count, WHAT)?;
    for e in 0..count {
        if e % 4096 == 0 {
            interrupt::check()?;
        }
        let shared = |n: &&u32| incidence.elements(**n).len() > 1;
        let shared: u32 =
            incidence.nodes(e).iter().filter(shared).map(|&n| incidence.weight[n as usize]).sum();
        let size = incidence.size(e);
        let (mut best, mut most) = (NONE, 0);
        incidence.neighbours(e, &mut room, |f, share| {
            if share > most
                && 2 * share >= shared
                && is_host(incidence, (e, size), f as usize, share == shared)
            {
                (best, most) = (f, share);
            }
        });
        host.push(if size == 0 { e as u32 } else { best });
    }
    Ok(host)
}

fn is_host(incidence: &Incidence, (e, size): (usize, u32), f: usize, has_all: bool) -> bool {
    let other = incidence.size(f);
    other >= 2 * size || has_all && (other > size || other == size && f < e)
}
