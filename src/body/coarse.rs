//! `G_p = R_p'B_p'`: what the rows that touch a body make of its motions.

use crate::linalg::vector::{norm_max, power_of_two_below};
use crate::linalg::{Csr, Matrix};
use crate::ranks::wire_struct;

/// The part of a body in G, without entries that are rounding.
pub struct Coarse {
    /// `G_p' = B_p R_p`, m_p x r.
    pub matrix: Csr,
    /// Power of two by which R_p is divided in G and e, so that `|G_p|` with the springs of the body is in [1, 2).
    pub size: f64,
}

wire_struct!(Coarse { matrix, size });

impl Coarse {
    /// For rows B_p, m_p x n. All entries are left out if the rows resist the motions by no more than the error of R, as for struts within a
    /// body far from the origin of its rotations. `held`: where soft motions have exactly these values; `springs`: the stiffness against
    /// motions, r or none.
    pub fn of(
        (motions, held): (&Matrix, &[usize]),
        (rounding, error): (f64, f64),
        springs: &[f64],
        rows: &Csr,
    ) -> Self {
        let (mut resisted, mut terms) = (0.0, 0.0);
        let mut own = vec![Vec::new(); rows.rows()];
        let uncertain = uncertain(rows, held);
        for j in 0..motions.cols {
            let motion = motions.col(j);
            let fastest = norm_max(motion);
            for k in 0..rows.rows() {
                let entry = rows.row_dot(k, motion);
                let size = fastest * rows.row(k).map(|(_, v)| v.abs()).sum::<f64>();
                resisted += entry * entry;
                terms += size * size;
                if entry.abs() > rounding * fastest * uncertain[k] {
                    own[k].push((j, entry));
                }
            }
        }
        let is_resisted = f64::sqrt(resisted) > error * f64::sqrt(terms);
        let mut matrix = Csr::empty(motions.cols);
        own.into_iter().for_each(|row| matrix.push_row(row.into_iter().filter(|_| is_resisted)));
        let size = size(&matrix, springs);
        Self { matrix, size }
    }
}

fn size(matrix: &Csr, springs: &[f64]) -> f64 {
    let mut square = vec![0.0; matrix.cols];
    matrix.col.iter().zip(&matrix.val).for_each(|(&j, v)| square[j] += v * v);
    for (square, spring) in square.iter_mut().zip(springs).filter(|(_, spring)| **spring > 0.0) {
        let entry = spring.sqrt();
        *square += entry * entry;
    }
    power_of_two_below(square.iter().sum::<f64>().sqrt())
}

/// `|b_k|` of every row, without the entries at held unknowns.
fn uncertain(rows: &Csr, held: &[usize]) -> Vec<f64> {
    let mut is_held = vec![false; rows.cols];
    held.iter().for_each(|&j| is_held[j] = true);
    let of = |k: usize| rows.row(k).filter(|(j, _)| !is_held[*j]).map(|(_, v)| v.abs()).sum();
    (0..rows.rows()).map(of).collect()
}
