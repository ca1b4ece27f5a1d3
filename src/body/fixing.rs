//! Fixing dofs: the r dofs whose rows of R are most independent, so that `K_ff` is as regular as it can be.

use crate::linalg::Matrix;

/// Pivoted QR of `(D^1/2 R)'` (r x n): dof by dof the column with the largest part orthogonal to those
/// chosen before; the first of equals. `root[i] = sqrt(D_ii)`.
pub fn fixing_dofs(null_space: &Matrix, root: &[f64]) -> Vec<usize> {
    let (n, r) = (null_space.rows, null_space.cols);
    let mut columns: Vec<Vec<f64>> =
        (0..n).map(|i| (0..r).map(|j| root[i] * null_space.get(i, j)).collect()).collect();
    let square = |column: &[f64]| column.iter().map(|v| v * v).sum::<f64>();
    let mut chosen = Vec::with_capacity(r);
    for _ in 0..r {
        let best =
            (0..n).fold(0, |best, i| if square(&columns[i]) > square(&columns[best]) { i } else { best });
        let length = square(&columns[best]).sqrt();
        let unit: Vec<f64> = columns[best].iter().map(|v| v / length).collect();
        for column in &mut columns {
            let part: f64 = column.iter().zip(&unit).map(|(a, b)| a * b).sum();
            column.iter_mut().zip(&unit).for_each(|(c, u)| *c -= part * u);
        }
        columns[best].fill(0.0);
        chosen.push(best);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_translation_and_a_rotation_are_held_at_the_two_ends() {
        // dofs on a line at x = -2 .. 2: u = 1 and u = x
        let r = Matrix { rows: 5, cols: 2, data: vec![1., 1., 1., 1., 1., -2., -1., 0., 1., 2.] };
        let mut chosen = fixing_dofs(&r, &[1.0; 5]);
        chosen.sort_unstable();
        assert_eq!(chosen, [0, 4]);
    }
}
