//! Sparse positive semidefinite systems that may be singular, `x = W+ b`: only parts that need it are solved densely,
//! with eigenvectors. Connected parts of W are independent: one sparse factor is used for all parts that certainly have
//! full rank.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::semidefinite::{is_regular_factor, resisted, GeneralInverse};
use crate::linalg::sparse::graph::components;
use crate::linalg::{Analysis, Cholesky, Csr, Matrix, SpdSolver, Symmetric};
use crate::platform::memory::{headroom_with, SMALL_MATRICES};

/// A matrix with its largest diagonal entry about 1 has weakly resisted motions if a pivot is below this.
pub const WEAK: f64 = 1e-4;
/// Parts up to this order are always dense.
const SMALL: usize = 64;
/// Bytes for the lists of parts and for small parts, per row and per entry.
const PER_ROW: usize = 512;
const PER_ENTRY: usize = 16;

/// `G'`, and which of its rows form `s^2 W = G_F G_F'`.
pub struct FaceRows<'a> {
    pub g_transposed: &'a Csr,
    pub held: &'a [bool],
    /// s
    pub unit: f64,
    /// Diagonal of `G G'` of all rows, in units of s^2.
    pub whole: &'a [f64],
    /// A motion a is free if `|G_F a| <= rounding |G| |a|`.
    pub rounding: f64,
}

pub struct PseudoInverse {
    order: usize,
    /// Factor of all parts that are not dense, with the unit matrix in place of the dense parts.
    regular: Option<Cholesky>,
    dense: Vec<SingularPart>,
    weak: bool,
}

struct SingularPart {
    rows: Vec<usize>,
    inverse: SpdSolver,
}

impl PseudoInverse {
    /// `w` has the analysed pattern; its largest diagonal entry is about 1 if no row is held. None if a part that is not
    /// small is singular.
    pub fn new(w: &Symmetric, analysis: &Arc<Analysis>, rows_of_g: &FaceRows) -> Result<Option<Self>> {
        let lists = PER_ROW * w.order() + PER_ENTRY * w.val.len();
        let _room = headroom_with(lists, SMALL_MATRICES, "the parts of a matrix")?;
        let (part_of, count) = components(w);
        let mut parts = vec![Vec::new(); count];
        part_of.iter().enumerate().for_each(|(row, &part)| parts[part].push(row));
        let dense: Vec<bool> = parts.iter().map(|rows| rows.len() <= SMALL).collect();
        let mut regular = None;
        if dense.contains(&false) {
            let mut rest = w.copied("the parts of a matrix")?;
            uncouple(&mut rest, |row| dense[part_of[row]]);
            let Ok(factor) = analysis.attempt(&rest, 1.0)? else { return Ok(None) };
            if !is_regular_factor(&factor)? {
                return Ok(None);
            }
            regular = Some(factor);
        }
        let own = rows_of_g.by_part(&part_of, &dense);
        let mut weak = regular.as_ref().is_some_and(|factor| factor.smallest_pivot() < WEAK);
        let mut singular = Vec::new();
        for ((rows, own), _) in parts.into_iter().zip(own).zip(&dense).filter(|(_, dense)| **dense) {
            let size = rows.iter().map(|&row| rows_of_g.whole[row]).sum::<f64>().sqrt();
            let (inverse, weakly) = resisted::inverse(&block(w, &rows)?, &own, rows_of_g.rounding * size)?;
            weak |= weakly;
            singular.push(SingularPart { rows, inverse });
        }
        Ok(Some(Self { order: w.order(), regular, dense: singular, weak }))
    }
}

impl GeneralInverse for PseudoInverse {
    fn add_kernel_part(&self, a: f64, b: &[f64], x: &mut [f64]) {
        for SingularPart { rows, inverse } in self.dense.iter().filter(|part| part.inverse.deficiency() > 0) {
            let (kernel, mut part) = (inverse.kernel(), vec![0.0; rows.len()]);
            let own: Vec<f64> = rows.iter().map(|&row| b[row]).collect();
            kernel.mul_add(a, &kernel.mul_transposed(&own), &mut part);
            rows.iter().zip(part).for_each(|(&row, v)| x[row] += v);
        }
    }

    fn solve(&self, b: &[f64]) -> Result<Vec<f64>> {
        let mut x = b.to_vec();
        if let Some(regular) = &self.regular {
            regular.solve(&mut x)?;
        }
        for SingularPart { rows, inverse } in &self.dense {
            let own: Vec<f64> = rows.iter().map(|&row| b[row]).collect();
            rows.iter().zip(inverse.solve(&own)).for_each(|(&row, v)| x[row] = v);
        }
        Ok(x)
    }

    fn deficiency(&self) -> usize {
        self.dense.iter().map(|part| part.inverse.deficiency()).sum()
    }

    /// Basis of a complement of the kernel, n x rank: `T'W T = I` on parts with a kernel or weakly resisted motions, unit
    /// vectors elsewhere.
    fn basis(&self) -> Matrix {
        let mut apart = vec![false; self.order];
        let mut basis = Matrix { rows: self.order, ..Matrix::default() };
        for SingularPart { rows, inverse } in &self.dense {
            let Some(kept) = inverse.kept() else { continue };
            basis.push_part(kept, rows);
            rows.iter().for_each(|&row| apart[row] = true);
        }
        for row in (0..self.order).filter(|&row| !apart[row]) {
            let mut column = vec![0.0; self.order];
            column[row] = 1.0;
            basis.push_col(&column);
        }
        basis
    }

    fn kernel(&self) -> Matrix {
        let mut basis = Matrix { rows: self.order, ..Matrix::default() };
        self.dense.iter().for_each(|part| basis.push_part(&part.inverse.kernel(), &part.rows));
        basis
    }

    fn is_weak(&self) -> bool {
        self.weak
    }
}

impl FaceRows<'_> {
    /// `G_F'` restricted to the columns of each part in `wanted`, in units of s.
    fn by_part(&self, part_of: &[usize], wanted: &[bool]) -> Vec<Csr> {
        let (mut local, mut parts) = (vec![0; part_of.len()], vec![Csr::empty(0); wanted.len()]);
        for (local, &part) in local.iter_mut().zip(part_of) {
            *local = parts[part].cols;
            parts[part].cols += 1;
        }
        for i in (0..self.g_transposed.rows()).filter(|&i| !self.held[i]) {
            let row = self.g_transposed.row(i).filter(|(k, v)| *v != 0.0 && wanted[part_of[*k]]);
            let mut touched: Vec<usize> = row.clone().map(|(k, _)| part_of[k]).collect();
            touched.sort_unstable();
            touched.dedup();
            for part in touched {
                let own = row.clone().filter(|(k, _)| part_of[*k] == part);
                parts[part].push_row(own.map(|(k, v)| (local[k], v / self.unit)));
            }
        }
        parts
    }
}

/// Replaces the rows and columns in `apart` by those of the unit matrix.
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

/// Inverse for some rows of a matrix with unit diagonal, ascending: a connected part, or such a part without some rows.
pub fn dense_inverse(w: &Symmetric, rows: &[usize]) -> Result<SpdSolver> {
    SpdSolver::new(&block(w, rows)?, &vec![1.0; rows.len()])
}

/// The block of some rows and columns, ascending.
fn block(w: &Symmetric, rows: &[usize]) -> Result<Matrix> {
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
    Ok(part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::sparse::gram::Gram;

    /// Chains of springs between these numbers of masses, one row per spring: free chains, and `held` chains with a
    /// spring to the ground; a single mass has no spring.
    fn chains(lengths: &[(usize, bool)]) -> Csr {
        let mut springs = Csr::empty(lengths.iter().map(|(length, _)| length).sum());
        let mut first = 0;
        for &(length, held) in lengths {
            (0..usize::from(held)).for_each(|_| springs.push_row([(first, 0.7)]));
            (first + 1..first + length).for_each(|i| springs.push_row([(i - 1, -0.7), (i, 0.7)]));
            first += length;
        }
        springs
    }

    #[test]
    fn small_singular_parts_beside_large_regular_ones_are_solved_and_counted() {
        let g = chains(&[(100, true), (60, false), (3, true), (2, false), (1, false), (70, true)]);
        let held = vec![false; g.rows()];
        let w = Gram::of(&g).unwrap().sum(&g, &held).unwrap();
        let whole: Vec<f64> = (0..w.order()).map(|k| w.val[w.ptr[k + 1] - 1]).collect();
        let analysis = Arc::new(Analysis::new(&w, &vec![false; w.order()]).unwrap());
        let rows = FaceRows { g_transposed: &g, held: &held, unit: 1.0, whole: &whole, rounding: 1e-14 };
        let pseudo = PseudoInverse::new(&w, &analysis, &rows).unwrap().unwrap();
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

    #[test]
    fn a_large_singular_part_is_left_to_others() {
        let g = chains(&[(80, false), (100, true)]);
        let held = vec![false; g.rows()];
        let w = Gram::of(&g).unwrap().sum(&g, &held).unwrap();
        let analysis = Arc::new(Analysis::new(&w, &vec![false; w.order()]).unwrap());
        let rows = FaceRows {
            g_transposed: &g,
            held: &held,
            unit: 1.0,
            whole: &vec![1.0; w.order()],
            rounding: 1e-14,
        };
        assert!(PseudoInverse::new(&w, &analysis, &rows).unwrap().is_none());
    }
}
