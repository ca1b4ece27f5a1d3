//! The loop over columns of tiles, of which the product consists.

use crate::linalg::dense::packed::{Line, Tile, SIDE};

/// A set of instructions of the processor; all sets give the same bits.
pub trait Kernel {
    /// P columns of tiles A_p in the same rows: `y += sum_p A_p factor_p`; returns the P products `A_p' x`.
    fn columns<const P: usize>(
        &self,
        tiles: [&[Tile]; P],
        x: &[Line],
        y: &mut [Line],
        factors: &[Line; P],
    ) -> [Line; P];

    /// Prefetches these tiles.
    fn ask_for(&self, _: &[Tile]) {}
}

/// Plain loops, for any processor.
pub struct Portable;

impl Kernel for Portable {
    fn columns<const P: usize>(
        &self,
        tiles: [&[Tile]; P],
        x: &[Line],
        y: &mut [Line],
        factors: &[Line; P],
    ) -> [Line; P] {
        let mut terms = [[[0.0; SIDE]; SIDE]; P];
        for (at, (x, y)) in x.iter().zip(y).enumerate() {
            for ((tiles, factors), terms) in tiles.iter().zip(factors).zip(&mut terms) {
                for ((a, factor), terms) in tiles[at].0.iter().zip(factors).zip(terms) {
                    for k in 0..SIDE {
                        y[k] += a[k] * factor;
                        terms[k] += a[k] * x[k];
                    }
                }
            }
        }
        terms.map(|terms| terms.map(|terms| sum(&terms)))
    }
}

/// Sum of a line, in an order common to all kernels.
pub fn sum(t: &Line) -> f64 {
    ((t[0] + t[4]) + (t[2] + t[6])) + ((t[1] + t[5]) + (t[3] + t[7]))
}
