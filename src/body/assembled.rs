//! K of a body that is cut: the sum of the matrices of its pieces, applied without assembly.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::sparse::csr::by_columns;
use crate::linalg::twofold::Twofold;
use crate::linalg::{graph, Symmetric};
use crate::platform::memory::{filled, reserved, zeros};
use crate::platform::threads;

const WHAT: &str = "a product with K";

/// `K = sum_s A_s K_s A_s'`, A_s the unknowns of piece s.
#[derive(Debug)]
pub struct Assembled {
    /// Unknowns of each piece, ascending, and its matrix over them, force / length.
    pieces: Vec<(Arc<[u32]>, Arc<Symmetric>)>,
    /// `K_ii`
    diagonal: Vec<f64>,
}

impl Assembled {
    /// Each unknown must belong to a piece; `diagonal`: one zero per unknown, from `room_for`.
    pub fn new(mut diagonal: Vec<f64>, pieces: impl Iterator<Item = (Arc<[u32]>, Arc<Symmetric>)>) -> Self {
        let pieces: Vec<_> = pieces.collect();
        for (dofs, k) in &pieces {
            dofs.iter().enumerate().for_each(|(i, &dof)| diagonal[dof as usize] += k.diagonal(i));
        }
        Self { pieces, diagonal }
    }

    /// The same K with a metric to which the unknowns that `slight` names in a piece add nothing.
    pub fn measured_without(
        self: &Arc<Self>,
        slight: impl Fn(&Symmetric) -> Result<Vec<bool>>,
    ) -> Result<Arc<Self>> {
        let slight = self.pieces.iter().map(|(_, k)| slight(k)).collect::<Result<Vec<_>>>()?;
        if slight.iter().all(Vec::is_empty) {
            return Ok(Arc::clone(self));
        }
        let mut diagonal = zeros(self.order(), WHAT)?;
        for ((dofs, k), slight) in self.pieces.iter().zip(&slight) {
            let stiff = dofs.iter().enumerate().filter(|(i, _)| slight.get(*i) != Some(&true));
            stiff.for_each(|(i, &dof)| diagonal[dof as usize] += k.diagonal(i));
        }
        Ok(Arc::new(Self { pieces: self.pieces.clone(), diagonal }))
    }

    /// K as one matrix. Of an entry that several pieces have, their values are added in the order of the pieces.
    pub fn sum(&self) -> Result<Symmetric> {
        let (ptr, col, val) = by_columns(self.order(), || self.lower_entries(), WHAT)?;
        let mut sum = Symmetric::with_room(self.order(), val.len(), WHAT)?;
        for ends in ptr.windows(2) {
            let own = ends[0]..ends[1];
            let mut row: Vec<(u32, f64)> =
                col[own.clone()].iter().copied().zip(val[own].iter().copied()).collect();
            row.sort_by_key(|(j, _)| *j);
            let same = row.chunk_by(|a, b| a.0 == b.0);
            sum.push_row(same.map(|of| (of[0].0 as usize, of.iter().map(|(_, v)| v).sum())));
        }
        Ok(sum)
    }

    /// Memory for a body of n unknowns in addition to its pieces.
    pub fn room_for(n: usize) -> Result<Vec<f64>> {
        zeros(n, "a stiffness matrix")
    }

    /// Of all pieces.
    pub fn entries(&self) -> usize {
        self.pieces.iter().map(|(_, k)| k.col.len()).sum()
    }

    pub fn order(&self) -> usize {
        self.diagonal.len()
    }

    pub fn diagonal(&self, i: usize) -> f64 {
        self.diagonal[i]
    }

    /// `D_ii` of the metric for K: `|K_ii|`, or `without` for a dof without stiffness.
    pub fn metric(&self, i: usize, without: f64) -> f64 {
        Some(self.diagonal[i].abs()).filter(|diagonal| *diagonal > 0.0).unwrap_or(without)
    }

    /// `max |K_ii|`
    pub fn largest_diagonal(&self) -> f64 {
        self.diagonal.iter().fold(0.0, |largest, k| k.abs().max(largest))
    }

    /// `y = K x`
    pub fn mul(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        let images = self.of_pieces(x, |k, own| {
            let mut image = zeros(own.len(), WHAT)?;
            k.mul(own, &mut image);
            Ok(image)
        })?;
        y.fill(0.0);
        for ((dofs, _), image) in self.pieces.iter().zip(images) {
            dofs.iter().zip(image).for_each(|(&dof, v)| y[dof as usize] += v);
        }
        Ok(())
    }

    /// `y = K x` and `terms = sum_s A_s |K_s| |A_s'x|`
    pub fn mul_with_terms(&self, x: &[f64], y: &mut [f64], terms: &mut [f64]) -> Result<()> {
        let images = self.of_pieces(x, |k, own| {
            let (mut image, mut size) = (zeros(own.len(), WHAT)?, zeros(own.len(), WHAT)?);
            k.mul_with_terms(own, &mut image, &mut size);
            Ok((image, size))
        })?;
        y.fill(0.0);
        terms.fill(0.0);
        for ((dofs, _), (image, size)) in self.pieces.iter().zip(images) {
            for ((&dof, v), t) in dofs.iter().zip(image).zip(size) {
                y[dof as usize] += v;
                terms[dof as usize] += t;
            }
        }
        Ok(())
    }

    /// `y += by K x` in double-double arithmetic; `by` is a power of two.
    pub fn add_twofold(&self, by: f64, x: &[f64], y: &mut [Twofold]) -> Result<()> {
        let largest = self.largest();
        let (mut own, mut sums) = (zeros(largest, WHAT)?, filled(largest, Twofold::default(), WHAT)?);
        for (dofs, k) in &self.pieces {
            let (own, sums) = (&mut own[..dofs.len()], &mut sums[..dofs.len()]);
            for ((own, sum), &dof) in own.iter_mut().zip(sums.iter_mut()).zip(dofs.iter()) {
                (*own, *sum) = (x[dof as usize], y[dof as usize]);
            }
            k.add_twofold(by, own, sums);
            sums.iter().zip(dofs.iter()).for_each(|(sum, &dof)| y[dof as usize] = *sum);
        }
        Ok(())
    }

    /// Numbers of the unknowns of each piece.
    pub fn pieces(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.pieces.iter().map(|(dofs, _)| dofs.len())
    }

    /// The connected component of every unknown, numbered by first unknowns, and the number of components. Entries that
    /// are 0 connect nothing.
    pub fn components(&self) -> (Vec<usize>, usize) {
        let rows = self.pieces.iter().flat_map(|(dofs, k)| {
            let joined =
                move |i: usize| k.lower_row(i).filter(|(_, v)| *v != 0.0).map(|(j, _)| dofs[j] as usize);
            (0..dofs.len()).map(joined)
        });
        graph::joined(self.order(), rows)
    }

    /// Bytes that the library keeps for this matrix.
    pub fn bytes(&self) -> usize {
        let of_pieces = self.pieces.iter().map(|(dofs, k)| size_of_val(&dofs[..]) + k.bytes()).sum::<usize>();
        of_pieces + size_of_val(&self.diagonal[..])
    }

    /// Row, column and value of every entry of the lower triangles of the pieces.
    pub fn each_entry(&self, mut visit: impl FnMut(usize, usize, f64)) {
        self.lower_entries().for_each(|(j, i, v)| visit(i, j as usize, v));
    }

    /// Column, row and value of these.
    fn lower_entries(&self) -> impl Iterator<Item = (u32, usize, f64)> + '_ {
        self.pieces.iter().flat_map(|(dofs, k)| {
            let row = move |i: usize| k.lower_row(i).map(move |(j, v)| (dofs[j], dofs[i] as usize, v));
            (0..dofs.len()).flat_map(row)
        })
    }

    /// `work(K_s, A_s'x)` of every piece, in the order of the pieces.
    fn of_pieces<T: Send>(
        &self,
        x: &[f64],
        work: impl Fn(&Symmetric, &[f64]) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let of_piece = |s: usize| {
            let (dofs, k) = &self.pieces[s];
            let mut own = reserved(dofs.len(), WHAT)?;
            own.extend(dofs.iter().map(|&dof| x[dof as usize]));
            work(k, &own)
        };
        threads::parts(self.pieces.len(), of_piece).into_iter().collect()
    }

    /// Unknowns of the largest piece.
    fn largest(&self) -> usize {
        self.pieces.iter().map(|(dofs, _)| dofs.len()).max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring of 2 between unknowns 0 and 2 and one of 3 between 1 and 2.
    #[test]
    fn products_are_those_of_the_sum_of_the_pieces() {
        let spring = |k: f64| Arc::new(Symmetric::new(vec![0, 1, 3], vec![0, 0, 1], vec![k, -k, k]));
        let pieces = [(Arc::from([0, 2]), spring(2.0)), (Arc::from([1, 2]), spring(3.0))];
        let k = Assembled::new(vec![0.0; 3], pieces.into_iter());
        assert_eq!((0..3).map(|i| k.diagonal(i)).collect::<Vec<_>>(), [2.0, 3.0, 5.0]);
        let (mut y, mut terms) = ([0.0; 3], [0.0; 3]);
        k.mul_with_terms(&[1.0, 2.0, 4.0], &mut y, &mut terms).unwrap();
        assert_eq!((y, terms), ([-6.0, -6.0, 12.0], [10.0, 18.0, 28.0]));
        k.mul(&[1.0, 2.0, 4.0], &mut y).unwrap();
        assert_eq!(y, [-6.0, -6.0, 12.0]);
        let mut twofold = [Twofold::from(1.0); 3];
        k.add_twofold(-0.5, &[1.0, 2.0, 4.0], &mut twofold).unwrap();
        assert_eq!(twofold.map(Twofold::value), [4.0, 4.0, -5.0]);
        let sum = k.sum().unwrap();
        let rows: Vec<Vec<_>> = (0..3).map(|i| sum.lower_row(i).collect()).collect();
        assert_eq!(rows, [vec![(0, 2.0)], vec![(1, 3.0)], vec![(0, -2.0), (1, -3.0), (2, 5.0)]]);
    }
}
