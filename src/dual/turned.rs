//! The preconditioner of a face with friction. Its rows are combinations of two rows of a node, and slip adds damping to
//! F:
//!
//! ```text
//! M = H^-1 (W'(B D^-1 S_b D^-1 B' + C)W + N) H^-1,   H = W'(B D^-1 B' + C)W + N,   N diagonal
//! ```

use crate::dual::coupling::{Coupling, FaceCoupling};
use crate::dual::preconditioner::Preconditioner;
use crate::error::Result;
use crate::linalg::Csr;
use crate::numbers::rounding;
use crate::platform::memory::zeros;
use crate::platform::{interrupt, tally};

/// A column of W and its entry of N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurnedRow {
    /// Two rows of a node, or one row twice with the entries (1, 0).
    pub rows: [usize; 2],
    pub along: [f64; 2],
    pub damping: f64,
}

/// M of one face.
pub struct TurnedFace<'a> {
    of: &'a Preconditioner,
    /// `W'B D^-1/2`, n x constrained unknowns.
    rows: Csr,
    /// Diagonal of `W'C W + N`.
    added: Vec<f64>,
    /// `diag(H)^-1/2`
    scale: Vec<f64>,
    /// Inverse of `H`, scaled to unit diagonal; none if rounding prevents the factorisation: then H is replaced by its
    /// diagonal.
    coupling: Option<FaceCoupling>,
    /// Rows that are springs of bodies, on which F is 1.
    springs: Vec<bool>,
}

impl Preconditioner {
    /// The combinations of each node must be orthonormal, and its tangential rows have equal compliances.
    pub fn turned(&self, face: &[TurnedRow]) -> Result<TurnedFace<'_>> {
        interrupt::check()?;
        tally::costly();
        let own = self.compliance().len();
        let (mut rows, mut added, mut springs) = (Csr::empty(self.rows().cols), Vec::new(), Vec::new());
        for row in face {
            let spring = row.rows[0] >= own;
            let used = || (0..2).filter(|&k| row.along[k] != 0.0 && !spring);
            rows.push_row(joined(used().map(|k| (row.along[k], self.rows().row(row.rows[k])))));
            let compliance = used().map(|k| row.along[k].powi(2) * self.compliance()[row.rows[k]]);
            added.push(if spring { 1.0 } else { compliance.sum::<f64>() } + row.damping);
            springs.push(spring);
        }
        let square = |i: usize| rows.row(i).map(|(_, v)| v * v).sum::<f64>() + added[i];
        let mut diagonal: Vec<f64> = (0..face.len()).map(square).collect();
        // for rows without entries
        let shift = rounding::METHOD * diagonal.iter().fold(0.0, |largest: f64, v| largest.max(*v));
        let shift = if shift > 0.0 { shift } else { 1.0 };
        diagonal.iter_mut().for_each(|v| *v += shift);
        let scale: Vec<f64> = diagonal.iter().map(|v| v.sqrt().recip()).collect();
        let mut scaled = rows.clone();
        for (i, s) in scale.iter().enumerate() {
            scaled.val[rows.ptr[i]..rows.ptr[i + 1]].iter_mut().for_each(|v| *v *= s);
        }
        let compliance: Vec<f64> = added.iter().zip(&scale).map(|(c, s)| (c + shift) * s * s).collect();
        let coupling = Coupling::new(&scaled.transposed()?, &compliance)?;
        let coupling = coupling.face(&vec![false; face.len()], None)?;
        Ok(TurnedFace { of: self, rows, added, scale, coupling, springs })
    }
}

/// A sum of multiples of rows with ascending columns.
fn joined(rows: impl Iterator<Item = (f64, impl Iterator<Item = (usize, f64)>)>) -> Vec<(usize, f64)> {
    let mut entries: Vec<(usize, f64)> =
        rows.flat_map(|(by, row)| row.map(move |(j, v)| (j, by * v))).collect();
    entries.sort_by_key(|entry| entry.0);
    entries.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        kept.1 += if same { next.1 } else { 0.0 };
        same
    });
    entries
}

impl TurnedFace<'_> {
    /// `z = M q`, both over the rows of the face.
    pub fn apply(&self, q: &[f64], z: &mut [f64]) -> Result<()> {
        interrupt::check()?;
        tally::costly();
        z.copy_from_slice(q);
        self.solve(z)?;
        let mut moved = zeros(self.rows.cols, "a preconditioner")?;
        self.rows.mul_transposed_add(1.0, z, &mut moved);
        let force = self.of.stiffened(moved)?;
        for (i, z) in z.iter_mut().enumerate() {
            *z = self.rows.row_dot(i, &force) + self.added[i] * *z;
        }
        self.solve(z)?;
        (0..z.len()).filter(|&i| self.springs[i]).for_each(|i| z[i] = q[i] / self.added[i]);
        Ok(())
    }

    /// `z <- H^-1 z`
    fn solve(&self, z: &mut [f64]) -> Result<()> {
        z.iter_mut().zip(&self.scale).for_each(|(z, s)| *z *= s);
        if let Some(coupling) = &self.coupling {
            coupling.solve(z)?;
        }
        z.iter_mut().zip(&self.scale).for_each(|(z, s)| *z *= s);
        Ok(())
    }
}
