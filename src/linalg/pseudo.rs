//! Sparse positive semidefinite systems that may be singular, `x = W+ b`: dense, with eigenvectors, is only what must be.
//! Connected parts of W do not know of each other: one sparse factor serves those that are safely of full rank.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::graph::components;
use crate::linalg::memory::room;
use crate::linalg::{Analysis, Cholesky, Matrix, SpdSolver, Symmetric};

/// A pivot of a matrix with unit diagonal below this means that it is singular.
pub const SINGULAR: f64 = 1e-11;
/// Parts up to this order are dense from the start.
const SMALL: usize = 64;
/// Bytes of the lists of the parts and of small parts, per row and per entry.
const PER_ROW: usize = 512;
const PER_ENTRY: usize = 16;

pub struct Pseudo {
    order: usize,
    /// Of all parts that are not dense, with the unit matrix in place of those.
    regular: Option<Cholesky>,
    dense: Vec<Part>,
}

struct Part {
    rows: Vec<usize>,
    inverse: SpdSolver,
}

impl Pseudo {
    /// `w` has the diagonal 1, or 0 where a row is empty, and the pattern that was analysed.
    pub fn new(w: &Symmetric, analysis: &Arc<Analysis>) -> Result<Self> {
        let _room = room(PER_ROW * w.order() + PER_ENTRY * w.val.len(), "the parts of a matrix")?;
        let (part_of, count) = components(w);
        let mut parts = vec![Vec::new(); count];
        part_of.iter().enumerate().for_each(|(row, &part)| parts[part].push(row));
        let mut dense: Vec<bool> = parts.iter().map(|rows| rows.len() <= SMALL).collect();
        let mut regular = None;
        while regular.is_none() && dense.contains(&false) {
            let mut rest = w.copied("the parts of a matrix")?;
            uncouple(&mut rest, |row| dense[part_of[row]]);
            match analysis.attempt(&rest, 1.0)? {
                Ok(factor) if factor.smallest_pivot() > SINGULAR => regular = Some(factor),
                Ok(factor) => factor
                    .pivots()
                    .filter(|(_, pivot)| *pivot <= SINGULAR)
                    .for_each(|(row, _)| dense[part_of[row]] = true),
                Err(at) => dense[part_of[analysis.order[at]]] = true,
            }
        }
        let singular = parts.into_iter().zip(&dense).filter(|(_, dense)| **dense);
        let part = |rows: Vec<usize>| Ok(Part { inverse: dense_inverse(w, &rows)?, rows });
        let dense = singular.map(|(rows, _)| part(rows)).collect::<Result<_>>()?;
        Ok(Self { order: w.order(), regular, dense })
    }

    /// The solution of minimum norm.
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>> {
        let mut x = b.to_vec();
        if let Some(regular) = &self.regular {
            regular.solve(&mut x)?;
        }
        for Part { rows, inverse } in &self.dense {
            let own: Vec<f64> = rows.iter().map(|&row| b[row]).collect();
            rows.iter().zip(inverse.solve(&own)).for_each(|(&row, v)| x[row] = v);
        }
        Ok(x)
    }

    /// Dimension of the kernel.
    pub fn deficiency(&self) -> usize {
        self.dense.iter().map(|part| part.inverse.deficiency()).sum()
    }

    /// Basis of the kernel, n x deficiency.
    pub fn kernel(&self) -> Matrix {
        let mut basis = Matrix { rows: self.order, ..Matrix::default() };
        for Part { rows, inverse } in self.dense.iter().filter(|part| part.inverse.deficiency() > 0) {
            let own = inverse.kernel();
            for j in 0..own.cols {
                let mut column = vec![0.0; self.order];
                rows.iter().zip(own.col(j)).for_each(|(&row, v)| column[row] = *v);
                basis.push_col(&column);
            }
        }
        basis
    }
}

/// The rows apart get the unit matrix.
pub fn uncouple(w: &mut Symmetric, apart: impl Fn(usize) -> bool) {
    for i in 0..w.order() {
        for at in w.ptr[i]..w.ptr[i + 1] {
            let j = w.col[at] as usize;
            if apart(i) || apart(j) {
                w.val[at] = f64::from(u8::from(i == j));
            }
        }
    }
}

/// Of some rows of a matrix with unit diagonal, ascending: all of a connected part, or of one without some of its rows.
pub fn dense_inverse(w: &Symmetric, rows: &[usize]) -> Result<SpdSolver> {
    let n = rows.len();
    let mut part = Matrix::zeros(n, n)?;
    for (a, &i) in rows.iter().enumerate() {
        for (j, v) in w.lower_row(i) {
            if let Ok(b) = rows.binary_search(&j) {
                part.set(a, b, v);
                part.set(b, a, v);
            }
        }
    }
    SpdSolver::new(&part, &vec![1.0; n])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chains of springs between so many masses each, divided by their diagonals: free ones, `held` ones with a spring to
    /// the ground; a mass alone, without a spring.
    fn chains(lengths: &[(usize, bool)]) -> Symmetric {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        let mut first = 0;
        for &(length, held) in lengths {
            let springs = |i: usize| f64::from(u8::from(i > 0 || held) + u8::from(i + 1 < length));
            for i in 0..length {
                if i > 0 {
                    col.push((first + i - 1) as u32);
                    val.push(-(springs(i) * springs(i - 1)).sqrt().recip());
                }
                col.push((first + i) as u32);
                val.push(springs(i).min(1.0));
                ptr.push(col.len());
            }
            first += length;
        }
        Symmetric::new(ptr, col, val)
    }

    #[test]
    fn singular_parts_small_and_large_beside_regular_ones_are_solved_and_counted() {
        let w = chains(&[(100, true), (80, false), (3, true), (2, false), (1, false), (70, true)]);
        let analysis = Arc::new(Analysis::new(&w, &vec![false; w.order()]).unwrap());
        let pseudo = Pseudo::new(&w, &analysis).unwrap();
        assert!(pseudo.regular.is_some() && pseudo.dense.len() == 4, "{}", pseudo.dense.len());
        let kernel = pseudo.kernel();
        assert_eq!((pseudo.deficiency(), kernel.cols), (3, 3));
        let mut image = vec![0.0; w.order()];
        for j in 0..kernel.cols {
            w.mul(kernel.col(j), &mut image);
            assert!(image.iter().all(|v| v.abs() < 1e-12));
        }
        let y: Vec<f64> = (0..w.order()).map(|i| (1.0 + i as f64).sin()).collect();
        w.mul(&y, &mut image);
        let x = pseudo.solve(&image).unwrap();
        let mut again = vec![0.0; w.order()];
        w.mul(&x, &mut again);
        assert!(again.iter().zip(&image).all(|(a, b)| (a - b).abs() < 1e-10));
        assert!((0..kernel.cols).all(|j| kernel.mul_transposed(&x)[j].abs() < 1e-9), "not of minimum norm");
    }
}
