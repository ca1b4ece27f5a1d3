//! Fixing dofs: the r dofs whose rows of R are most independent, so that `K_ff` is as well conditioned as possible.

use crate::error::{Error, Kind, Result};
use crate::linalg::dense::spectrum::right_singular;
use crate::linalg::Matrix;
use crate::numbers::body::AS_WELL;
use crate::numbers::linalg::DEPENDENT;
use crate::platform::memory::zeros;

/// Dofs given by the host, which must hold every motion of the null space.
pub fn given_dofs(null_space: &Matrix, root: &[f64], given: &[usize]) -> Result<Vec<usize>> {
    let (r, refused) = (null_space.cols, |what: String| Error::new(Kind::NullSpace, what));
    if given.len() != r {
        let what = format!("{} fixing dofs were given, the null space has dimension {r}", given.len());
        return Err(refused(what).value(given.len() as f64).limit(r as f64));
    }
    if r == 0 {
        return Ok(Vec::new());
    }
    let values = singular_values(null_space, root, given)?;
    if values[r - 1].is_nan() || values[r - 1] <= DEPENDENT * values[0] {
        let what = "the fixing dofs do not hold every motion of the null space".to_string();
        return Err(refused(what).dof(given[0]).value(values[r - 1]).limit(DEPENDENT * values[0]));
    }
    Ok(given.to_vec())
}

/// Whether `dofs`, found for other values of K, hold the null space nearly as well as `chosen`, found for these values.
pub fn hold_as_well(null_space: &Matrix, root: &[f64], dofs: &[usize], chosen: &[usize]) -> Result<bool> {
    Ok(held_against(null_space, root, dofs, chosen)? >= AS_WELL)
}

/// Ratio of the smallest singular values of the rows of `D^1/2 R` at `dofs` and at `chosen`.
pub fn held_against(null_space: &Matrix, root: &[f64], dofs: &[usize], chosen: &[usize]) -> Result<f64> {
    if dofs.len() != chosen.len() {
        return Ok(0.0);
    }
    let softest = |values: Vec<f64>| values.last().copied().unwrap_or(f64::INFINITY);
    let (own, best) = (singular_values(null_space, root, dofs)?, singular_values(null_space, root, chosen)?);
    Ok(if dofs.is_empty() { 1.0 } else { softest(own) / softest(best) })
}

/// Singular values, descending, of the rows `dofs` of `D^1/2 R`; there are as many dofs as columns of R.
fn singular_values(null_space: &Matrix, root: &[f64], dofs: &[usize]) -> Result<Vec<f64>> {
    let entry = |at: usize, j: usize| root[dofs[at]] * null_space.get(dofs[at], j);
    Ok(right_singular(&Matrix::from_fn(dofs.len(), dofs.len(), entry)?)?.0)
}

/// Pivoted QR of `(D^1/2 R)'` (r x n): repeatedly chooses the column with the largest part orthogonal to the columns
/// chosen before; the first if several are equal. `root[i] = sqrt(D_ii)`.
pub fn fixing_dofs(null_space: &Matrix, root: &[f64]) -> Result<Vec<usize>> {
    let (n, r) = (null_space.rows, null_space.cols);
    // row i: the remainder of column i
    let mut left = zeros(n * r, "the fixing dofs")?;
    for j in 0..r {
        let motion = null_space.col(j).iter().zip(root);
        motion.enumerate().for_each(|(i, (v, root))| left[i * r + j] = root * v);
    }
    let square = |column: &[f64]| column.iter().map(|v| v * v).sum::<f64>();
    let mut chosen = Vec::with_capacity(r);
    let mut unit = vec![0.0; r];
    for _ in 0..r {
        let (mut best, mut most) = (0, 0.0);
        for (i, column) in left.chunks_exact_mut(r).enumerate() {
            let part: f64 = column.iter().zip(&unit).map(|(a, b)| a * b).sum();
            column.iter_mut().zip(&unit).for_each(|(c, u)| *c -= part * u);
            let size = square(column);
            if size > most {
                (best, most) = (i, size);
            }
        }
        let column = &mut left[best * r..(best + 1) * r];
        unit.iter_mut().zip(column.iter()).for_each(|(u, v)| *u = v / most.sqrt());
        column.fill(0.0);
        chosen.push(best);
    }
    Ok(chosen)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_dofs_must_hold_every_motion() {
        let r = Matrix { rows: 5, cols: 2, data: vec![1., 1., 1., 1., 1., -2., -1., 0., 1., 2.] };
        let given = |dofs: &[usize]| given_dofs(&r, &[1.0; 5], dofs);
        assert_eq!(given(&[3, 1]).unwrap(), [3, 1]);
        assert_eq!(given(&[2, 2]).unwrap_err().kind, Kind::NullSpace);
        assert_eq!(given(&[2]).unwrap_err().place.limit, Some(2.0));
    }

    /// u = 1 and u = x at x = -2 .. 2; dof 4 weak.
    #[test]
    fn dofs_found_for_other_values_serve_unless_these_make_them_much_worse() {
        let r = Matrix { rows: 5, cols: 2, data: vec![1., 1., 1., 1., 1., -2., -1., 0., 1., 2.] };
        let serves = |weak: f64, dofs: &[usize]| {
            let root = [1.0, 1.0, 1.0, 1.0, weak];
            hold_as_well(&r, &root, dofs, &fixing_dofs(&r, &root).unwrap()).unwrap()
        };
        assert!(serves(1.0, &[1, 4]) && serves(0.5, &[0, 4]));
        assert!(!serves(1e-3, &[0, 4]) && !serves(1.0, &[2, 2]) && !serves(1.0, &[2]));
    }

    #[test]
    fn a_translation_and_a_rotation_are_held_at_the_two_ends() {
        // dofs on a line at x = -2 .. 2: u = 1 and u = x
        let r = Matrix { rows: 5, cols: 2, data: vec![1., 1., 1., 1., 1., -2., -1., 0., 1., 2.] };
        let mut chosen = fixing_dofs(&r, &[1.0; 5]).unwrap();
        chosen.sort_unstable();
        assert_eq!(chosen, [0, 4]);
    }
}
