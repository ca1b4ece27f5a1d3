//! Which motions the rows of G_F resist, and how well, on one block of `W = G_F G_F'`, r x r: by eigenvectors of W
//! if its eigenvalues are accurate enough, otherwise by the singular values of `G_F N` (eigenvalues of W are their
//! squares).

use crate::error::Result;
use crate::linalg::dense::spectrum::{right_singular, symmetric_eigen};
use crate::linalg::vector::norm;
use crate::linalg::{Csr, Matrix};
use crate::numbers::linalg::ROOT;

/// Each makes `|G_F n|` of a motion n accurate to rounding, even if the eigenvectors contain parts of well resisted
/// motions.
const REFINEMENTS: usize = 2;
/// Rows reduced together, in addition to 4 times the number of motions.
const ROWS: usize = 64;

/// The motions that the rows resist, `T'W T = I`, the kernel, and whether some motions of T are resisted weakly.
pub struct Parts {
    /// T, r x rank.
    pub kept: Matrix,
    /// Orthonormal, r x deficiency.
    pub kernel: Matrix,
    pub weak: bool,
}

/// T and the kernel of `w`, whose largest diagonal entry is about 1; `g_transposed`: `G_F'` in the same scale. A motion a is
/// free if `|G_F a| <= limit |a|`: it is in the kernel.
pub fn parts(w: &Matrix, g_transposed: &Csr, limit: f64) -> Result<Parts> {
    let (values, vectors) = symmetric_eigen(w)?;
    let certain = values.partition_point(|value| *value <= ROOT);
    let (mut motions, mut kept) = (vectors.columns(0..certain), vectors.columns(certain..w.cols));
    for (j, value) in values[certain..].iter().enumerate() {
        kept.col_mut(j).iter_mut().for_each(|v| *v /= value.sqrt());
    }
    for _ in 0..REFINEMENTS {
        (0..motions.cols).for_each(|j| conjugate(motions.col_mut(j), &kept, g_transposed));
    }
    let images = (0..motions.cols).map(|j| product(g_transposed, motions.col(j))).collect();
    let (kernel, weak) = sorted(&motions, images, limit)?;
    kept.push_cols(&weak);
    Ok(Parts { kept, kernel, weak: weak.cols > 0 })
}

/// Splits orthonormal motions n with the `images` `G_F'n` into those that are free and a basis V of the others, `V'W V = I`.
pub fn sorted(motions: &Matrix, images: Vec<Vec<f64>>, limit: f64) -> Result<(Matrix, Matrix)> {
    let (resistance, turned) = singular(images, limit)?;
    let none = Matrix { rows: motions.rows, ..Matrix::default() };
    let (mut free, mut weak) = (none.clone(), none);
    for (j, resistance) in resistance.iter().enumerate() {
        let mut motion = vec![0.0; motions.rows];
        motions.mul_add(1.0, turned.col(j), &mut motion);
        if *resistance <= limit {
            free.push_col(&motion);
        } else {
            motion.iter_mut().for_each(|v| *v /= resistance);
            weak.push_col(&motion);
        }
    }
    Ok((free, weak))
}

/// `n <- n - T T'W n`: then `T'W n = 0`, since `T'W T = I`.
fn conjugate(n: &mut [f64], kept: &Matrix, g_transposed: &Csr) {
    let image = g_transposed.mul_transposed(&product(g_transposed, n));
    let part = kept.mul_transposed(&image);
    kept.mul_add(-1.0, &part, n);
}

/// Singular values of a matrix with these columns, and its right singular vectors; 0 if all are below the limit.
fn singular(images: Vec<Vec<f64>>, limit: f64) -> Result<(Vec<f64>, Matrix)> {
    let (d, rows) = (images.len(), images.first().map_or(0, Vec::len));
    let mut turned = Matrix::from_fn(d, d, |i, j| f64::from(u8::from(i == j)))?;
    let lengths: Vec<f64> = images.iter().map(|image| norm(image)).collect();
    if norm(&lengths) <= limit {
        return Ok((vec![0.0; d], turned));
    }
    let (mut values, mut done) = (vec![0.0; d], 0);
    while done < rows {
        // replaces the rows so far by their singular values and vectors
        let some = (rows - done).min(4 * d + ROWS);
        let entry =
            |i: usize, j: usize| if i < d { values[i] * turned.get(j, i) } else { images[j][done + i - d] };
        let stacked = Matrix::from_fn(d + some, d, entry)?;
        (values, turned) = right_singular(&stacked)?;
        done += some;
    }
    Ok((values, turned))
}

/// `G_F'n`
fn product(g_transposed: &Csr, n: &[f64]) -> Vec<f64> {
    let mut image = vec![0.0; g_transposed.rows()];
    g_transposed.mul(n, &mut image);
    image
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::vector::{axpy, dot};

    /// Rows that resist three combined motions by 1, `weak` and 0.
    fn mixed(weak: f64) -> (Matrix, Csr) {
        let third = 1.0 / 3.0;
        let turn = [
            [third, 2.0 * third, 2.0 * third],
            [2.0 * third, third, -2.0 * third],
            [2.0 * third, -2.0 * third, third],
        ];
        let mut g_transposed = Csr::empty(3);
        for i in 0..200 {
            let (a, b) = ((1.0 + i as f64).sin(), weak * (3.0 * i as f64).cos());
            g_transposed.push_row((0..3).map(|k| (k, 0.1 * (a * turn[0][k] + b * turn[1][k]))));
        }
        let mut w = Matrix::zeros(3, 3).unwrap();
        for i in 0..200 {
            for (k, a) in g_transposed.row(i) {
                g_transposed.row(i).for_each(|(l, b)| w.set(k, l, w.get(k, l) + a * b));
            }
        }
        (w, g_transposed)
    }

    #[test]
    fn a_motion_held_weakly_is_told_from_a_free_one_far_below_the_root_of_rounding() {
        for weak in [1e-5, 1e-7, 1e-10, 1e-12] {
            let (w, g_transposed) = mixed(weak);
            let Parts { kept, kernel, weak: weakly } = parts(&w, &g_transposed, 2e-14).unwrap();
            assert!(weakly && kernel.cols == 1, "{weak}");
            let solve = |b: &[f64]| {
                let mut x = vec![0.0; 3];
                kept.mul_add(1.0, &kept.mul_transposed(b), &mut x);
                x
            };
            assert!(norm(&product(&g_transposed, kernel.col(0))) <= 2e-15, "{weak}");
            // g in the range of G_F': its remainder is 0
            let g = product(&g_transposed, &[1.0, -0.5, 0.25]);
            let mut image = vec![0.0; 3];
            g_transposed.mul_transposed_add(1.0, &g, &mut image);
            let mut rest = g.clone();
            axpy(-1.0, &product(&g_transposed, &solve(&image)), &mut rest);
            assert!(norm(&rest) <= 1e-15 / weak * norm(&g), "{weak}: {:e}", norm(&rest));
            assert!(dot(&solve(&image), kernel.col(0)).abs() < 1e-7);
        }
    }
}
