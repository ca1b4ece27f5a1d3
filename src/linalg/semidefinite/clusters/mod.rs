//! Sparse positive semidefinite systems `W x = b`, W = G_F G_F', with free motions: x of minimum norm, without any dense
//! matrix over all of W.
//!
//! The columns of G form blocks, one for each body. The motions Z that the rows of a block alone leave free are found in
//! the block, and `T'W_pp T = I` scales the others to equal size. The sparse factor of T'W T then holds the unknowns
//! whose pivots may be rounding (`DOUBTFUL`); each represents one motion of a cluster of blocks, `T n`, where `W n = 0`
//! except at the held unknowns. The images of these motions under G_F show which of them are free: they are far more
//! accurate than the pivots.

mod block;
mod inverse;
mod motions;
#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::Arc;

use crate::error::{Error, Kind, Result};
use crate::linalg::semidefinite::faces::FaceFactors;
use crate::linalg::semidefinite::resisted::sorted;
use crate::numbers::linalg::{DOUBTFUL, WEAK};

use crate::linalg::vector::{dot, norm, NOISE};
use crate::linalg::{Cholesky, Csr, Matrix, Symmetric};
use crate::platform::memory::{headroom, headroom_with, SMALL_MATRICES};
use block::Block;
use inverse::Cluster;
pub use inverse::ClusterInverse;
use motions::{length, ByColumn, Motion};

/// A motion of a cluster is corrected so often: each separates it from what the rows resist well.
const REFINEMENTS: usize = 2;
const WHAT: &str = "the coarse space";

/// G' by blocks, with the pattern of T'W T and the results for single blocks.
pub struct Blocks {
    /// First column of each block, and the number of all columns.
    starts: Vec<usize>,
    /// G' with an entry for every column of a block that a row touches, m x r, in units of s.
    rows: Csr,
    by_column: ByColumn,
    /// The rows that touch each block.
    met: Csr,
    /// |G|/s of the columns that share a row with each block.
    sizes: Vec<f64>,
    rounding: f64,
    /// Blocks with one T for all faces.
    fixed: Vec<Option<Arc<Block>>>,
    /// The other blocks, with the rows for which they were last computed.
    known: Vec<Option<(Vec<usize>, Arc<Block>)>>,
    /// Rows that faces may hold, and rows that touch a block without a common T.
    varying: Vec<usize>,
    /// `G_F'T` of the last face, with the pattern of all rows.
    turned: Csr,
    factors: FaceFactors,
    /// The motions of the last face.
    motions: Vec<Motion>,
    /// The last face had free motions: the next face is likely to have some.
    pub left_free: bool,
}

impl Blocks {
    /// `starts`: first columns of the blocks, ascending; empty if every column is a block. Faces hold rows that are
    /// `bounded`. `unit`: s; `whole`: diagonal of `G G' / s^2`. A motion a is free if `|G_F a| <= rounding |G| |a|`, with
    /// G of all rows.
    pub fn new(
        g_transposed: &Csr,
        starts: &[usize],
        bounded: &[bool],
        (unit, whole, rounding): (f64, &[f64], f64),
    ) -> Result<Self> {
        let mut starts = if starts.is_empty() { (0..g_transposed.cols).collect() } else { starts.to_vec() };
        starts.push(g_transposed.cols);
        let (mut rows, mut blocks_of) = (Csr::empty(g_transposed.cols), Csr::empty(starts.len() - 1));
        let _room = headroom(128 * g_transposed.val.len().saturating_mul(6), WHAT)?;
        for i in 0..g_transposed.rows() {
            let block = |(column, _): (usize, f64)| starts.partition_point(|start| *start <= column) - 1;
            let mut met: Vec<usize> = g_transposed.row(i).map(block).collect();
            met.dedup();
            let mut given = g_transposed.row(i).peekable();
            let columns = met.iter().flat_map(|&k| starts[k]..starts[k + 1]);
            rows.push_row(columns.map(|column| {
                (column, given.next_if(|(given, _)| *given == column).map_or(0.0, |(_, v)| v / unit))
            }));
            blocks_of.push_row(met.into_iter().map(|k| (k, 1.0)));
        }
        let met = blocks_of.transposed()?;
        let sizes = sizes(&blocks_of, &met, &starts, whole);
        let mut fixed = Vec::with_capacity(met.rows());
        for (k, columns) in starts.windows(2).enumerate() {
            let own =
                |of: bool| of_block(&rows, met.row(k).map(|(i, _)| i).filter(|&i| bounded[i] == of), columns);
            fixed.push(Block::for_all_faces(own(false), &own(true), (rounding, sizes[k]))?.map(Arc::new));
        }
        let varies = |i: usize| bounded[i] || blocks_of.row(i).any(|(k, _)| fixed[k].is_none());
        let is_varying: Vec<bool> = (0..rows.rows()).map(varies).collect();
        let mut blocks = Self {
            by_column: ByColumn::of(&rows)?,
            turned: rows.clone(),
            known: vec![None; met.rows()],
            varying: (0..rows.rows()).filter(|&i| is_varying[i]).collect(),
            factors: FaceFactors::new(&rows, is_varying)?,
            starts,
            rows,
            met,
            sizes,
            rounding,
            fixed,
            motions: Vec::new(),
            left_free: false,
        };
        (0..blocks.rows.rows()).for_each(|i| blocks.turn(i, &[], false));
        Ok(blocks)
    }

    /// Forgets the last face: another solve finds what it would find alone.
    pub fn forget_face(&mut self) {
        (self.motions, self.left_free) = (Vec::new(), false);
    }

    /// `W+` over the rows that are not held.
    pub fn inverse(&mut self, held: &[bool]) -> Result<ClusterInverse> {
        let _room = headroom_with(0, SMALL_MATRICES, WHAT)?;
        let blocks: Vec<Arc<Block>> =
            (0..self.known.len()).map(|k| self.block(k, held)).collect::<Result<_>>()?;
        let varying = std::mem::take(&mut self.varying);
        varying.iter().for_each(|&i| self.turn(i, &blocks, held[i]));
        self.varying = varying;
        let starts = self.starts.clone();
        let complete = |w: &mut Symmetric| {
            for (k, block) in blocks.iter().enumerate() {
                let none = starts[k] + block.resisted.cols..starts[k + 1];
                none.for_each(|i| w.val[w.ptr[i + 1] - 1] = 1.0);
            }
        };
        let infinite = |_| Error::new(Kind::Internal, "a coarse matrix is not finite");
        let factor = self.factors.factor(&self.turned, held, (1.0, DOUBTFUL), complete)?.map_err(infinite)?;
        let inverse = self.by_factor(factor, &blocks, held)?;
        self.left_free = inverse.deficiency() > 0;
        Ok(inverse)
    }

    /// W+ by the factor of T'W T and the motions of its held unknowns.
    fn by_factor(
        &mut self,
        factor: Arc<Cholesky>,
        blocks: &[Arc<Block>],
        held: &[bool],
    ) -> Result<ClusterInverse> {
        let mut inverse = ClusterInverse {
            starts: self.starts.clone(),
            weak: factor.smallest_pivot() < WEAK || blocks.iter().any(|block| block.weak),
            blocks: blocks.to_vec(),
            held: factor.at_rest(),
            factor,
            clusters: Vec::new(),
        };
        let rows = (&self.turned, &self.by_column);
        let motions = inverse.motions(rows, (&self.sizes, self.accuracy()), &self.motions)?;
        let mut local = vec![None; self.rows.cols];
        for members in inverse.clusters_of(&motions, held.len()) {
            let cluster = self.cluster(&inverse, (&members, &motions), held, &mut local)?;
            inverse.weak |= cluster.weak.cols > 0;
            inverse.clusters.push(cluster);
        }
        self.motions = motions;
        Ok(inverse)
    }

    /// Relative accuracy of motions, also where more counts as free.
    fn accuracy(&self) -> f64 {
        self.rounding.min(NOISE)
    }

    fn columns(&self, k: usize) -> Range<usize> {
        self.starts[k]..self.starts[k + 1]
    }

    /// T and Z of one block; reused if its rows are unchanged.
    fn block(&mut self, k: usize, held: &[bool]) -> Result<Arc<Block>> {
        if let Some(fixed) = &self.fixed[k] {
            return Ok(Arc::clone(fixed));
        }
        let left: Vec<usize> = self.met.row(k).map(|(i, _)| i).filter(|&i| !held[i]).collect();
        if let Some((_, block)) = self.known[k].as_ref().filter(|(rows, _)| *rows == left) {
            return Ok(Arc::clone(block));
        }
        let own = of_block(&self.rows, left.iter().copied(), &self.starts[k..k + 2]);
        let block = Arc::new(Block::new(own, (self.rounding, self.sizes[k]))?);
        self.known[k] = Some((left, Arc::clone(&block)));
        Ok(block)
    }

    /// Row i of `G_F'T`, 0 if it is held; without blocks, only the columns with a common T.
    fn turn(&mut self, i: usize, blocks: &[Arc<Block>], held: bool) {
        let range = self.rows.ptr[i]..self.rows.ptr[i + 1];
        self.turned.val[range.clone()].fill(0.0);
        let mut at = if held { range.end } else { range.start };
        while at < range.end {
            let k = self.starts.partition_point(|start| *start <= self.rows.col[at]) - 1;
            let own = at..at + self.columns(k).len();
            if let Some(Block { resisted, .. }) = blocks.get(k).or(self.fixed[k].as_ref()).map(Arc::as_ref) {
                let (values, turned) = (&self.rows.val[own.clone()], &mut self.turned.val[own.clone()]);
                (0..resisted.cols).for_each(|j| turned[j] = dot(resisted.col(j), values));
            }
            at = own.end;
        }
    }

    /// The motions of some held unknowns. `local`: work array, none before and after.
    fn cluster(
        &self,
        inverse: &ClusterInverse,
        (members, motions): (&[usize], &[Motion]),
        held: &[bool],
        local: &mut [Option<usize>],
    ) -> Result<Cluster> {
        let mut blocks: Vec<usize> =
            members.iter().flat_map(|&at| motions[at].blocks.iter().copied()).collect();
        blocks.sort_unstable();
        blocks.dedup();
        let columns: Vec<usize> = blocks.iter().flat_map(|&k| self.columns(k)).collect();
        let mut together = Matrix { rows: columns.len(), ..Matrix::default() };
        for &at in members {
            together.push_col(&motions[at].on(&columns));
        }
        let mut meets = vec![false; held.len()];
        blocks.iter().flat_map(|&k| self.met.row(k)).for_each(|(i, _)| meets[i] = !held[i]);
        let rows: Vec<usize> = (0..held.len()).filter(|&i| meets[i]).collect();
        columns.iter().enumerate().for_each(|(at, &column)| local[column] = Some(at));
        let (mut motions, size) = (together.orthonormalised(0.0), length(&self.sizes, &blocks));
        let mut images: Vec<Vec<f64>> =
            (0..motions.cols).map(|j| self.image(motions.col(j), &rows, local)).collect();
        let below = self.accuracy() * size / (motions.cols as f64).sqrt();
        for (j, image) in images.iter_mut().enumerate() {
            for _ in 0..REFINEMENTS {
                if norm(image) <= below {
                    break;
                }
                let mut resultant = vec![0.0; self.rows.cols];
                for (&i, along) in rows.iter().zip(&*image) {
                    self.rows.row(i).for_each(|(column, v)| resultant[column] += v * along);
                }
                let resisted = inverse.of_factor(&resultant)?;
                motions.col_mut(j).iter_mut().zip(&columns).for_each(|(v, &column)| *v -= resisted[column]);
                *image = self.image(motions.col(j), &rows, local);
            }
        }
        columns.iter().for_each(|&column| local[column] = None);
        let (free, weak) = sorted(&motions, images, self.rounding * size)?;
        Ok(Cluster { columns, free, weak })
    }

    /// The entries of some rows along a motion, whose amplitude in a column is at `local` of it.
    fn image(&self, motion: &[f64], rows: &[usize], local: &[Option<usize>]) -> Vec<f64> {
        let along = |&i: &usize| {
            self.rows.row(i).map(|(column, v)| local[column].map_or(0.0, |at| v * motion[at])).sum()
        };
        rows.iter().map(along).collect()
    }
}

/// For each block, |G|/s of the columns of all blocks that share a row with it. `whole`: diagonal of `G G' / s^2`.
fn sizes(blocks_of: &Csr, met: &Csr, starts: &[usize], whole: &[f64]) -> Vec<f64> {
    let own = |k: usize| whole[starts[k]..starts[k + 1]].iter().sum::<f64>();
    let near = |k: usize| {
        let mut near: Vec<usize> =
            met.row(k).flat_map(|(i, _)| blocks_of.row(i).map(|(k, _)| k)).chain([k]).collect();
        near.sort_unstable();
        near.dedup();
        near.into_iter().map(own).sum::<f64>().sqrt()
    };
    (0..met.rows()).map(near).collect()
}

/// The entries of some rows in the columns of one block, from the first to the last of `columns`.
fn of_block(rows: &Csr, some: impl Iterator<Item = usize>, columns: &[usize]) -> Csr {
    let mut own = Csr::empty(columns[1] - columns[0]);
    for i in some {
        let entries = rows.row(i).filter(|(column, _)| (columns[0]..columns[1]).contains(column));
        own.push_row(entries.map(|(column, v)| (column - columns[0], v)));
    }
    own
}
