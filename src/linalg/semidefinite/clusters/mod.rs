//! Sparse positive semidefinite systems `W x = b`, W = G_F G_F', with motions that nothing resists all over: x of minimum norm,
//! without any dense matrix over all of W.
//!
//! Columns of G come in blocks, those of a body. What the rows of a block alone leave free, Z, is found in the block, and
//! `T'W_pp T = I` makes the rest of one size. The sparse factor of T'W T then holds the unknowns whose pivots are rounding; each
//! stands for one motion of a cluster of blocks, `T n`, `W n = 0` but for the unknowns held. Which of them are free, G_F says
//! itself: their images are far more accurate than the pivots.

mod block;
mod inverse;
#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::Arc;

use crate::error::Result;
use crate::linalg::semidefinite::resisted::sorted;
use crate::linalg::semidefinite::sparse::WEAK;
use crate::linalg::sparse::gram::Gram;
use crate::linalg::{Analysis, Csr, Matrix};
use crate::platform::memory::{headroom, headroom_with, SMALL_MATRICES};
use block::Block;
use inverse::{Cluster, ClusterInverse, Motion};

/// Pivots of T'W T, with unit diagonal, up to this are held: the factor of the rest is accurate, motions resisted by little
/// are told from free ones afterwards.
const HOLD: f64 = 1e-8;
const WHAT: &str = "the coarse space";

/// G' by blocks, with the pattern of T'W T and what is known of single blocks.
pub struct Blocks {
    /// First column of each block, then the number of all columns.
    starts: Vec<usize>,
    /// G' with an entry for every column of a block that a row meets, m x r, in units of s.
    rows: Csr,
    /// The rows that meet each block.
    met: Csr,
    gram: Gram,
    analysis: Arc<Analysis>,
    /// Blocks as they were for the rows that they met last.
    known: Vec<Option<(Vec<usize>, Arc<Block>)>>,
}

impl Blocks {
    /// `starts`: first columns of the blocks, ascending; none where every column is one. `unit`: s.
    pub fn new(g_transposed: &Csr, starts: &[usize], unit: f64) -> Result<Self> {
        let mut starts = if starts.is_empty() { (0..g_transposed.cols).collect() } else { starts.to_vec() };
        starts.push(g_transposed.cols);
        let (mut rows, mut blocks_of) = (Csr::empty(g_transposed.cols), Csr::empty(starts.len() - 1));
        let _room = headroom(64 * g_transposed.val.len().saturating_mul(6), WHAT)?;
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
        let gram = Gram::of(&rows)?;
        let analysis = Arc::new(Analysis::new(gram.pattern(), &vec![false; rows.cols])?);
        let known = starts.iter().map(|_| None).collect();
        Ok(Self { met: blocks_of.transposed()?, starts, rows, gram, analysis, known })
    }

    /// `W+` over the rows that are not held. A motion a is free when `|G_F a| <= rounding |G| |a|`, |G| of all rows.
    pub fn inverse(&mut self, held: &[bool], whole: &[f64], rounding: f64) -> Result<ClusterInverse> {
        let _room = headroom_with(0, SMALL_MATRICES, WHAT)?;
        let count = self.starts.len() - 1;
        let blocks: Vec<Arc<Block>> =
            (0..count).map(|k| self.block(k, held, whole, rounding)).collect::<Result<_>>()?;
        let turned = self.turned(&blocks, held);
        let mut w = self.gram.sum(&turned, held)?;
        for (k, block) in blocks.iter().enumerate() {
            (self.starts[k] + block.resisted.cols..self.starts[k + 1])
                .for_each(|i| w.val[w.ptr[i + 1] - 1] = 1.0);
        }
        let (factor, at_rest) = self.analysis.holding(&w, HOLD)?;
        let mut inverse = ClusterInverse {
            starts: self.starts.clone(),
            weak: factor.smallest_pivot() < WEAK || blocks.iter().any(|block| block.weak),
            blocks,
            factor,
            held: at_rest,
            clusters: Vec::new(),
        };
        let motions = inverse.motions(&turned, (whole, rounding))?;
        for members in inverse.clusters_of(&motions, held.len()) {
            let cluster = self.cluster(&members, &motions, held, (whole, rounding))?;
            inverse.weak |= cluster.weak.cols > 0;
            inverse.clusters.push(cluster);
        }
        Ok(inverse)
    }

    fn columns(&self, k: usize) -> Range<usize> {
        self.starts[k]..self.starts[k + 1]
    }

    /// T and Z of one block; as before where the same rows are left.
    fn block(&mut self, k: usize, held: &[bool], whole: &[f64], rounding: f64) -> Result<Arc<Block>> {
        let left: Vec<usize> = self.met.row(k).map(|(i, _)| i).filter(|&i| !held[i]).collect();
        if let Some((_, block)) = self.known[k].as_ref().filter(|(rows, _)| *rows == left) {
            return Ok(Arc::clone(block));
        }
        let columns = self.columns(k);
        let mut own = Csr::empty(columns.len());
        for &i in &left {
            let entries = self.rows.row(i).filter(|(column, _)| columns.contains(column));
            own.push_row(entries.map(|(column, v)| (column - columns.start, v)));
        }
        let size = whole[columns.clone()].iter().sum::<f64>().sqrt();
        let block = Arc::new(Block::new(own, rounding * size)?);
        self.known[k] = Some((left, Arc::clone(&block)));
        Ok(block)
    }

    /// `(G_F'T)`, with the pattern of all rows.
    fn turned(&self, blocks: &[Arc<Block>], held: &[bool]) -> Csr {
        let mut turned = self.rows.clone();
        turned.val.fill(0.0);
        for i in (0..held.len()).filter(|&i| !held[i]) {
            let range = self.rows.ptr[i]..self.rows.ptr[i + 1];
            let mut at = range.start;
            while at < range.end {
                let k = self.starts.partition_point(|start| *start <= self.rows.col[at]) - 1;
                let own = at..at + self.columns(k).len();
                let resisted = &blocks[k].resisted;
                let values = resisted.mul_transposed(&self.rows.val[own.clone()]);
                turned.val[own.start..own.start + resisted.cols].copy_from_slice(&values);
                at = own.end;
            }
        }
        turned
    }

    /// The motions that some unknowns held stand for.
    fn cluster(
        &self,
        members: &[usize],
        motions: &[Motion],
        held: &[bool],
        (whole, rounding): (&[f64], f64),
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
        let mut rows: Vec<usize> =
            blocks.iter().flat_map(|&k| self.met.row(k)).map(|(i, _)| i).filter(|&i| !held[i]).collect();
        rows.sort_unstable();
        rows.dedup();
        let mut own = Csr::empty(columns.len());
        for i in rows {
            let entries = self.rows.row(i);
            own.push_row(entries.filter_map(|(column, v)| Some((columns.binary_search(&column).ok()?, v))));
        }
        let size = columns.iter().map(|&column| whole[column]).sum::<f64>().sqrt();
        let (free, weak) = sorted(&together.orthonormalised(0.0), &own, rounding * size)?;
        Ok(Cluster { columns, free, weak })
    }
}
