//! `G_p = R_p'B_p'`: what the rows that touch a body make of its motions.

use crate::body::generalized_inverse::GeneralizedInverse;
use crate::linalg::vector::{norm_max, power_of_two_below};
use crate::linalg::Csr;
use crate::ranks::wire_struct;

/// The part of a body in G, without entries that are rounding.
pub struct Coarse {
    /// `G_p' = B_p R_p`, m_p x r.
    pub matrix: Csr,
    /// Power of two by which R_p is divided in G and e, so that `|G_p|` with the springs of the body is in [1, 2).
    pub size: f64,
}

wire_struct!(Coarse { matrix, size });

impl GeneralizedInverse {
    /// For these rows, m_p x n. All entries are left out if the rows resist its motions by no more than errors of R, as for struts within
    /// a body far from the origin of its rotations. `by`: the power of two by which K+ is multiplied in F.
    pub fn coarse(&self, rows: &Csr, by: f64) -> Coarse {
        let (mut resisted, mut terms) = (0.0, 0.0);
        let mut own = vec![Vec::new(); rows.rows()];
        let uncertain = self.uncertain(rows);
        for j in 0..self.null_space.cols {
            let motion = self.null_space.col(j);
            let fastest = norm_max(motion);
            for k in 0..rows.rows() {
                let entry = rows.row_dot(k, motion);
                let size = fastest * rows.row(k).map(|(_, v)| v.abs()).sum::<f64>();
                resisted += entry * entry;
                terms += size * size;
                if entry.abs() > self.rounding * fastest * uncertain[k] {
                    own[k].push((j, entry));
                }
            }
        }
        let is_resisted = f64::sqrt(resisted) > self.error * f64::sqrt(terms);
        let mut matrix = Csr::empty(self.null_space.cols);
        own.into_iter().for_each(|row| matrix.push_row(row.into_iter().filter(|_| is_resisted)));
        let size = self.size(&matrix, by);
        Coarse { matrix, size }
    }

    /// `lambda_j` of its soft and carried motions in the unit of forces of F, force / length.
    pub fn springs(&self, by: f64) -> impl Iterator<Item = f64> + '_ {
        self.stiffness.iter().map(move |stiffness| stiffness / by)
    }

    fn size(&self, matrix: &Csr, by: f64) -> f64 {
        let mut square = vec![0.0; matrix.cols];
        matrix.col.iter().zip(&matrix.val).for_each(|(&j, v)| square[j] += v * v);
        for (square, spring) in square.iter_mut().zip(self.springs(by)).filter(|(_, spring)| *spring > 0.0) {
            let entry = spring.sqrt();
            *square += entry * entry;
        }
        power_of_two_below(square.iter().sum::<f64>().sqrt())
    }

    /// `|b_k|` of every row, without the entries at held unknowns if its motions are soft: soft motions are those with exactly these values
    /// there.
    fn uncertain(&self, rows: &Csr) -> Vec<f64> {
        let mut held = vec![false; rows.cols];
        if !self.stiffness.is_empty() {
            self.fixing.iter().for_each(|&j| held[j] = true);
        }
        let of = |k: usize| rows.row(k).filter(|(j, _)| !held[*j]).map(|(_, v)| v.abs()).sum();
        (0..rows.rows()).map(of).collect()
    }
}
