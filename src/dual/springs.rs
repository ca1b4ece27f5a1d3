//! The stiffness of K against soft motions: springs with positive or negative stiffness.

use crate::dual::{Dual, Subdomain};
use crate::linalg::Csr;

/// Adds springs at the held unknowns of K+ that resist soft motions, with energy `lambda_j a_j^2 / 2` for the amplitude
/// a_j: compliant rows `a_j = mu / lambda_j` without unknowns, for which F has only a diagonal entry and G one entry.
/// Scaled by `lambda_j^1/2`, and as G by the size of their body.
pub fn add_springs(subdomains: &[Subdomain], coarse: &mut Csr) -> usize {
    let before = coarse.rows();
    for s in subdomains {
        let resisted = s.soft_modes().filter(|(_, stiffness)| *stiffness > 0.0);
        resisted.for_each(|(mode, stiffness)| coarse.push_row([(mode, stiffness.sqrt() / s.size)]));
    }
    coarse.rows() - before
}

/// Modes with negative stiffness, with this stiffness for amplitudes divided by the size of their body.
pub fn negative_modes(subdomains: &[Subdomain]) -> Vec<(usize, f64)> {
    let of = |s: &Subdomain| {
        let negative = s.soft_modes().filter(|(_, stiffness)| *stiffness < 0.0);
        negative.map(|(mode, stiffness)| (mode, stiffness / (s.size * s.size))).collect::<Vec<_>>()
    };
    subdomains.iter().flat_map(of).collect()
}

impl Dual {
    /// Replaces the amplitudes of carried motions by those from the forces x of their springs: then the forces on these
    /// bodies balance whatever error the multiplier alpha has.
    pub fn balanced(&self, x: &[f64], alpha: &[f64]) -> Vec<f64> {
        let mut alpha = alpha.to_vec();
        self.carried().for_each(|(row, mode, entry)| alpha[mode] = x[row] / entry);
        alpha
    }

    /// Sets the springs of carried motions to the forces that balance the other rows, `G x = e`.
    pub fn load_springs(&self, e: &[f64], x: &mut [f64]) {
        self.carried().for_each(|(row, ..)| x[row] = 0.0);
        let mut left = e.to_vec();
        self.coarse.mul_transposed_add(-1.0, x, &mut left);
        self.carried().for_each(|(row, mode, entry)| x[row] = left[mode] / entry);
    }

    /// Row, mode and entry of G of the springs of carried motions.
    fn carried(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let springs = self.subdomains.iter().flat_map(|s| {
            let first = s.modes.end - s.kplus.carried_motions();
            s.soft_modes().filter(|(_, stiffness)| *stiffness > 0.0).map(move |(mode, _)| mode >= first)
        });
        let rows = (self.coarse.rows() - self.springs..).zip(springs).filter(|(_, carried)| *carried);
        rows.flat_map(|(row, _)| self.coarse.row(row).map(move |(mode, entry)| (row, mode, entry)))
    }
}

impl Subdomain {
    /// Modes of soft motions with their stiffness, in the unit of forces of all bodies.
    fn soft_modes(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.modes.clone().zip(self.kplus.springs(self.by))
    }
}
