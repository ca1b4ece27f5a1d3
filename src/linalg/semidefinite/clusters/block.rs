//! One block of columns of G: the motions that its rows resist, and the motions that they leave free.

use crate::error::Result;
use crate::linalg::semidefinite::resisted::{parts, Parts};

use crate::linalg::vector::{dot, norm};
use crate::linalg::{Csr, Matrix};
use crate::numbers::linalg::{ADDED, WEAK};

/// The motions of one block that the rows resist, r_p x rank, and the free motions, r_p x (r_p - rank). `T'W_pp T = I`
/// but for motions that are resisted by less than the root of `WEAK` of |G|: scaled as if by this, or rounding would look like resistance.
pub struct Block {
    pub resisted: Matrix,
    pub free: Matrix,
    pub weak: bool,
}

impl Block {
    /// For the rows that all faces have, if they resist all motions of the block well, and the other rows, which faces
    /// may hold, do not resist them far better; none if every face needs its own. All columns of the block are stored.
    pub fn for_all_faces(common: Csr, others: &Csr, limits: (f64, f64)) -> Result<Option<Self>> {
        let block = Self::new(common, limits)?;
        let added = |i: usize| {
            let turned = block.resisted.mul_transposed(&others.val[others.ptr[i]..others.ptr[i + 1]]);
            dot(&turned, &turned)
        };
        let is_held = block.free.cols == 0 && !block.weak;
        let serves = others.rows() == 0 || (is_held && (0..others.rows()).map(added).sum::<f64>() <= ADDED);
        Ok(serves.then_some(block))
    }

    /// For `G_F'` on the columns of the block. A motion a is free if `|G_F a| <= rounding size |a|`.
    pub fn new(own: Csr, (rounding, size): (f64, f64)) -> Result<Self> {
        let r = own.cols;
        let mut w = Matrix::zeros(r, r)?;
        for i in 0..own.rows() {
            for (k, a) in own.row(i) {
                own.row(i).for_each(|(l, b)| w.set(l, k, w.get(l, k) + a * b));
            }
        }
        let largest = (0..r).map(|k| w.get(k, k)).fold(0.0, f64::max);
        if largest.sqrt() <= rounding * size {
            let free = Matrix::from_fn(r, r, |i, j| f64::from(u8::from(i == j)))?;
            return Ok(Self { resisted: Matrix { rows: r, ..Matrix::default() }, free, weak: false });
        }
        let unit = largest.sqrt();
        w.data.iter_mut().for_each(|v| *v /= largest);
        let own = Csr { val: own.val.iter().map(|v| v / unit).collect(), ..own };
        let Parts { kept: mut resisted, kernel: free, weak } = parts(&w, &own, rounding * size / unit)?;
        for j in 0..resisted.cols {
            let by = 1.0 / (unit * (norm(resisted.col(j)) * WEAK.sqrt() * size / unit).max(1.0));
            resisted.col_mut(j).iter_mut().for_each(|v| *v *= by);
        }
        Ok(Self { resisted, free, weak })
    }
}
