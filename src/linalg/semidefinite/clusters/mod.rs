//! Sparse positive semidefinite systems `W x = b`, W = G_F G_F', with free motions in many places: x of minimum norm,
//! without any dense matrix over all of W.
//!
//! The columns of G form blocks, one for each body. The motions Z that the rows of a block alone leave free are found in
//! the block, and `T'W_pp T = I` scales the others to equal size. The sparse factor of T'W T then holds the unknowns
//! whose pivots are rounding; each represents one motion of a cluster of blocks, `T n`, where `W n = 0` except at the
//! held unknowns. The images of these motions under G_F show which of them are free: they are far more accurate than the
//! pivots.

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
use crate::linalg::semidefinite::sparse::WEAK;
use crate::linalg::semidefinite::{is_regular_factor, DOUBTFUL};
use crate::linalg::vector::dot;
use crate::linalg::{Cholesky, Csr, Matrix, Symmetric};
use crate::platform::memory::{headroom, headroom_with, SMALL_MATRICES};
use block::Block;
use inverse::{Cluster, ClusterInverse};
use motions::{ByColumn, Motion};

/// Pivots of T'W T, with unit diagonal, are held up to the first of these, or up to the second if that leaves a free
/// motion: then the factor of the rest is accurate, and weakly resisted motions are separated from free ones afterwards.
const HOLD: [f64; 2] = [1e-8, DOUBTFUL];
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
    /// Diagonal of `G G' / s^2`.
    whole: Vec<f64>,
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
        let mut fixed = Vec::with_capacity(met.rows());
        for (k, columns) in starts.windows(2).enumerate() {
            let own =
                |of: bool| of_block(&rows, met.row(k).map(|(i, _)| i).filter(|&i| bounded[i] == of), columns);
            let size = whole[columns[0]..columns[1]].iter().sum::<f64>().sqrt();
            fixed.push(Block::for_all_faces(own(false), &own(true), rounding * size)?.map(Arc::new));
        }
        let varies = |i: usize| bounded[i] || blocks_of.row(i).any(|(k, _)| fixed[k].is_none());
        let is_varying: Vec<bool> = (0..rows.rows()).map(varies).collect();
        let mut blocks = Self {
            by_column: ByColumn::of(&rows)?,
            turned: rows.clone(),
            known: vec![None; met.rows()],
            varying: (0..rows.rows()).filter(|&i| is_varying[i]).collect(),
            factors: FaceFactors::new(&rows, is_varying)?,
            whole: whole.to_vec(),
            starts,
            rows,
            met,
            rounding,
            fixed,
            motions: Vec::new(),
        };
        (0..blocks.rows.rows()).for_each(|i| blocks.turn(i, &[], false));
        Ok(blocks)
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
        let factor = self.factors.factor(&self.turned, held, (1.0, HOLD[0]), complete)?.map_err(infinite)?;
        let is_certain = factor.smallest_pivot() > DOUBTFUL;
        if is_regular_factor(&factor)? {
            let inverse = self.by_factor(factor, &blocks, held)?;
            if is_certain || inverse.clusters.iter().all(|cluster| cluster.weak.cols == 0) {
                return Ok(inverse);
            }
        }
        let mut w = self.factors.gram().sum(&self.turned, held)?;
        complete(&mut w);
        let factor = self.factors.analysis().pivoted(&w, 1.0, HOLD[1])?.map_err(infinite)?;
        self.by_factor(Arc::new(factor), &blocks, held)
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
        let motions = inverse.motions(rows, (&self.whole, self.rounding), &self.motions)?;
        let mut local = vec![None; self.rows.cols];
        for members in inverse.clusters_of(&motions, held.len()) {
            let cluster = self.cluster(&members, &motions, held, &mut local)?;
            inverse.weak |= cluster.weak.cols > 0;
            inverse.clusters.push(cluster);
        }
        self.motions = motions;
        Ok(inverse)
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
        let size = self.whole[self.columns(k)].iter().sum::<f64>().sqrt();
        let block = Arc::new(Block::new(own, self.rounding * size)?);
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
        members: &[usize],
        motions: &[Motion],
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
        let motions = together.orthonormalised(0.0);
        let mut images = vec![vec![0.0; rows.len()]; motions.cols];
        for (row, &i) in rows.iter().enumerate() {
            for (at, v) in self.rows.row(i).filter_map(|(column, v)| Some((local[column]?, v))) {
                images.iter_mut().enumerate().for_each(|(j, image)| image[row] += v * motions.get(at, j));
            }
        }
        columns.iter().for_each(|&column| local[column] = None);
        let size = columns.iter().map(|&column| self.whole[column]).sum::<f64>().sqrt();
        let (free, weak) = sorted(&motions, images, self.rounding * size)?;
        Ok(Cluster { columns, free, weak })
    }
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
