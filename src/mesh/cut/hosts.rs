//! Elements that follow the piece of another element: springs, penalties, constraints, and elements inside another
//! element.

use super::incidence::{Incidence, Neighbours, NONE, WHAT};
use crate::error::Result;
use crate::platform::interrupt;
use crate::platform::memory::reserved;

/// The host of each element, whose piece it gets; `NONE` for elements that are cut; `e` itself if it has no unknowns.
///
/// The host has all unknowns of the element; or, if it shares only some, it is at least twice as large and has more than
/// half of them, or four times as large and has half. The host is larger, or has a smaller number if both have the same
/// unknowns: so there are no circles.
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
