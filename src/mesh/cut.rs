//! The piece of every element.

use crate::error::Result;
use crate::platform::memory::filled;

/// Elements by the unknowns they join, held ones left out.
pub struct Elements<'a> {
    pub ptr: &'a [usize],
    pub dof: &'a [u32],
    pub unknowns: usize,
}

pub fn pieces_for(unknowns: usize) -> usize {
    if unknowns < 40_000 {
        1
    } else {
        unknowns / 1000
    }
}

pub fn cut(elements: &Elements, centres: Option<&[[f64; 3]]>, pieces: usize) -> Result<Vec<u32>> {
    let count = elements.ptr.len() - 1;
    let mut of = filled(count, 0u32, "pieces")?;
    let mut order: Vec<usize> = (0..count).collect();
    fn split(order: &mut [usize], c: Option<&[[f64; 3]]>, first: u32, pieces: usize, of: &mut [u32]) {
        if pieces <= 1 || order.len() <= 1 {
            order.iter().for_each(|&e| of[e] = first);
            return;
        }
        if let Some(c) = c {
            let extent = |k: usize| {
                let (a, b) = order
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &e| (a.min(c[e][k]), b.max(c[e][k])));
                b - a
            };
            let axis = (0..3).fold(0, |best, k| if extent(k) > 1.0001 * extent(best) { k } else { best });
            order.sort_by(|&a, &b| c[a][axis].total_cmp(&c[b][axis]).then(a.cmp(&b)));
        }
        let left = pieces / 2;
        let at = order.len() * left / pieces;
        let (a, b) = order.split_at_mut(at);
        split(a, c, first, left, of);
        split(b, c, first + left as u32, pieces - left, of);
    }
    split(&mut order, centres, 0, pieces.min(count), &mut of);
    Ok(of)
}
