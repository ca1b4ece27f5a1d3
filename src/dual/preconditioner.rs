//! Preconditioners of F on a face: `M_F = B_D S_b B_D'` with `B_D = (B_F D^-1 B_F')^-1 B_F D^-1`, rebuilt for
//! the rows F that are not held. S_b is the stiffness of the constrained dofs: lumped or Dirichlet. Compliant rows
//! add C to both, `M_F = W^-1 (B_F D^-1 S_b D^-1 B_F' + C_F) W^-1`, `W = B_F D^-1 B_F' + C_F`.

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::error::Result;
use crate::linalg::gram::Gram;
use crate::linalg::{Analysis, Cholesky, Csr, Operator};

/// Added to the diagonal (1) of `B D^-1 B' + C` when dependent rows make it singular.
const SHIFT: f64 = 1e-10;
/// A pivot below this means that rows depend on each other.
const SINGULAR: f64 = 1e-9;

/// The constrained dofs of one body.
pub struct Boundary {
    /// Among all unknowns, ascending.
    pub dofs: Vec<usize>,
    pub stiffness: Box<dyn Operator + Send>,
}

pub struct Preconditioner {
    /// `B D^-1/2`
    rows: Csr,
    /// C, no unit.
    compliance: Vec<f64>,
    /// Its transposed: the rows of every unknown.
    columns: Csr,
    /// `D^-1/2` over all unknowns.
    weight: Vec<f64>,
    boundaries: Vec<Boundary>,
    gram: Gram,
    analysis: Arc<Analysis>,
    /// The rows held on the last face, and the factor of its W.
    face: Mutex<Option<(Vec<bool>, Cholesky)>>,
}

impl Preconditioner {
    /// `matrix` is B, `compliance` the diagonal of C; `B D^-1 B' + C` has the diagonal 1.
    pub fn new(
        matrix: &Csr,
        compliance: Vec<f64>,
        metric: &[f64],
        boundaries: Vec<Boundary>,
    ) -> Result<Self> {
        let weight: Vec<f64> = metric.iter().map(|d| d.sqrt().recip()).collect();
        let mut rows = Csr::empty(matrix.cols);
        (0..matrix.rows()).for_each(|i| rows.push_row(matrix.row(i).map(|(j, v)| (j, v * weight[j]))));
        let columns = rows.transposed()?;
        let gram = Gram::of(&columns)?;
        let analysis = Arc::new(Analysis::new(gram.pattern(), &vec![false; matrix.rows()])?);
        Ok(Self { rows, compliance, columns, weight, boundaries, gram, analysis, face: Mutex::new(None) })
    }

    /// `z = M_F r` on the rows that are not held, 0 on the others.
    pub fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        let face = self.select(held)?;
        let Some((_, coupling)) = face.as_ref() else { return Ok(()) };
        z.iter_mut().zip(r).zip(held).for_each(|((z, r), held)| *z = if *held { 0.0 } else { *r });
        coupling.solve(z)?;
        clear(held, z);
        let mut spread = vec![0.0; self.weight.len()];
        self.rows.mul_transposed_add(1.0, z, &mut spread);
        let mut force = vec![0.0; spread.len()];
        for boundary in &self.boundaries {
            let moved: Vec<f64> = boundary.dofs.iter().map(|&j| spread[j] * self.weight[j]).collect();
            let mut image = vec![0.0; moved.len()];
            boundary.stiffness.apply(&moved, &mut image);
            boundary.dofs.iter().zip(image).for_each(|(&j, v)| force[j] = v * self.weight[j]);
        }
        for (i, (z, c)) in z.iter_mut().zip(&self.compliance).enumerate() {
            *z = self.rows.row_dot(i, &force) + c * *z;
        }
        clear(held, z);
        coupling.solve(z)?;
        clear(held, z);
        Ok(())
    }

    /// Factorises W, the held rows uncoupled.
    fn select(&self, held: &[bool]) -> Result<MutexGuard<'_, Option<(Vec<bool>, Cholesky)>>> {
        let mut face = self.face.lock().unwrap_or_else(PoisonError::into_inner);
        if face.as_ref().is_some_and(|(known, _)| known == held) {
            return Ok(face);
        }
        let mut w = self.gram.sum(&self.columns, &vec![false; self.columns.rows()])?;
        for i in 0..w.order() {
            w.val[w.ptr[i + 1] - 1] += self.compliance[i];
            for at in w.ptr[i]..w.ptr[i + 1] {
                let j = w.col[at];
                if held[i] || held[j] {
                    w.val[at] = f64::from(u8::from(i == j));
                }
            }
        }
        let factor = match self.analysis.attempt(&w)? {
            Ok(factor) if factor.smallest_pivot() > SINGULAR => Some(factor),
            _ => {
                (0..w.order()).for_each(|i| w.val[w.ptr[i + 1] - 1] += SHIFT);
                self.analysis.attempt(&w)?.ok()
            }
        };
        *face = factor.map(|factor| (held.to_vec(), factor));
        Ok(face)
    }
}

fn clear(held: &[bool], z: &mut [f64]) {
    z.iter_mut().zip(held).filter(|(_, held)| **held).for_each(|(z, _)| *z = 0.0);
}

/// Unknowns in the range that some row constrains, counted from its start.
pub fn constrained(matrix: &Csr, range: &Range<usize>) -> Vec<usize> {
    let mut touched = vec![false; range.len()];
    matrix.col.iter().filter(|j| range.contains(j)).for_each(|j| touched[j - range.start] = true);
    (0..range.len()).filter(|&j| touched[j]).collect()
}
