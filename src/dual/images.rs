//! `G = R'B'`: what the rows make of the motions of every body.

use crate::dual::Subdomain;
use crate::linalg::vector::{norm_max, power_of_two_below};
use crate::linalg::Csr;

/// `G' = B R`, m x r, without entries that are rounding. All entries of a body are left out if its rows resist its
/// motions by no more than errors of R, as for struts within a body far from the origin of its rotations.
pub fn coarse(subdomains: &[Subdomain], m: usize, modes: usize) -> Csr {
    let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); m];
    for s in subdomains {
        let (mut resisted, mut terms) = (0.0, 0.0);
        let mut own = Vec::new();
        let uncertain = uncertain(s);
        for (j, mode) in s.modes.clone().enumerate() {
            let motion = s.kplus.null_space.col(j);
            let fastest = norm_max(motion);
            for (k, &i) in s.rows.iter().enumerate() {
                let entry = s.matrix.row_dot(k, motion);
                let size = fastest * s.matrix.row(k).map(|(_, v)| v.abs()).sum::<f64>();
                resisted += entry * entry;
                terms += size * size;
                if entry.abs() > s.kplus.rounding * fastest * uncertain[k] {
                    own.push((i, mode, entry));
                }
            }
        }
        if f64::sqrt(resisted) > s.kplus.error * f64::sqrt(terms) {
            own.into_iter().for_each(|(i, mode, entry)| rows[i].push((mode, entry)));
        }
    }
    let mut coarse = Csr::with_room(modes, m, rows.iter().map(Vec::len).sum());
    rows.into_iter().for_each(|row| coarse.push_row(row));
    coarse
}

/// `|b_k|` of every row of a body, without the entries at held unknowns if its motions are soft: soft motions are those with exactly
/// these values there.
fn uncertain(s: &Subdomain) -> Vec<f64> {
    let mut held = vec![false; s.kplus.null_space.rows];
    if !s.kplus.stiffness.is_empty() {
        s.kplus.fixing.iter().for_each(|&j| held[j] = true);
    }
    let of = |k: usize| s.matrix.row(k).filter(|(j, _)| !held[*j]).map(|(_, v)| v.abs()).sum();
    (0..s.rows.len()).map(of).collect()
}

/// Scales each body so that `|G_p|` is in [1, 2), for every body that rows touch.
pub fn scale_by_body(subdomains: &mut [Subdomain], coarse: &mut Csr) {
    let mut square = vec![0.0; coarse.cols];
    coarse.col.iter().zip(&coarse.val).for_each(|(&mode, v)| square[mode] += v * v);
    let mut by = vec![1.0; coarse.cols];
    for s in subdomains {
        s.size = power_of_two_below(square[s.modes.clone()].iter().sum::<f64>().sqrt());
        by[s.modes.clone()].fill(s.size);
    }
    coarse.col.iter().zip(&mut coarse.val).for_each(|(&mode, v)| *v /= by[mode]);
}
