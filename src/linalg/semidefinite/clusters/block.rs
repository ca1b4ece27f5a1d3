//! One block of columns of G: the motions that its rows resist, and those that they leave free.

use crate::error::Result;
use crate::linalg::semidefinite::resisted::{parts, Parts};
use crate::linalg::vector::dot;
use crate::linalg::{Csr, Matrix};

/// What the rows resist of the motions of one block, `T'W_pp T = I`, and what they leave free: r_p x rank and the rest.
pub struct Block {
    pub resisted: Matrix,
    pub free: Matrix,
    pub weak: bool,
}

impl Block {
    /// So much of `T'W_pp T = I` may rows add that faces hold or not.
    const ADDED: f64 = 1e3;

    /// By the rows that all faces have, where these resist all motions of the block well, and other rows, which faces may hold, do not
    /// resist them far better; none where every face has its own. All columns of the block are stored.
    pub fn for_all_faces(common: Csr, others: &Csr, limit: f64) -> Result<Option<Self>> {
        let block = Self::new(common, limit)?;
        let added = |i: usize| {
            let turned = block.resisted.mul_transposed(&others.val[others.ptr[i]..others.ptr[i + 1]]);
            dot(&turned, &turned)
        };
        let is_held = block.free.cols == 0 && !block.weak;
        let serves =
            others.rows() == 0 || (is_held && (0..others.rows()).map(added).sum::<f64>() <= Self::ADDED);
        Ok(serves.then_some(block))
    }

    /// Of `G_F'` on the columns of the block.
    pub fn new(own: Csr, limit: f64) -> Result<Self> {
        let r = own.cols;
        let mut w = Matrix::zeros(r, r)?;
        for i in 0..own.rows() {
            for (k, a) in own.row(i) {
                own.row(i).for_each(|(l, b)| w.set(l, k, w.get(l, k) + a * b));
            }
        }
        let largest = (0..r).map(|k| w.get(k, k)).fold(0.0, f64::max);
        if largest.sqrt() <= limit {
            let free = Matrix::from_fn(r, r, |i, j| f64::from(u8::from(i == j)))?;
            return Ok(Self { resisted: Matrix { rows: r, ..Matrix::default() }, free, weak: false });
        }
        let unit = largest.sqrt();
        w.data.iter_mut().for_each(|v| *v /= largest);
        let own = Csr { val: own.val.iter().map(|v| v / unit).collect(), ..own };
        let Parts { mut kept, kernel, weak } = parts(&w, &own, limit / unit)?;
        kept.data.iter_mut().for_each(|v| *v /= unit);
        Ok(Self { resisted: kept, free: kernel, weak })
    }
}
