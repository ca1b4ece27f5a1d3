//! W+ by the factor of T'W T and the motions of clusters of blocks.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::semidefinite::clusters::block::Block;
use crate::linalg::semidefinite::GeneralInverse;
use crate::linalg::vector::{norm, norm_max};
use crate::linalg::{Cholesky, Csr, Matrix};

/// A cluster moves with a motion when it has more than this part of its largest entry.
const MOVES: f64 = 1e-9;
/// The images of the motions held become accurate to rounding in a few corrections; at most so many.
const CORRECTIONS: usize = 8;
/// The first ones are made on what is eliminated before the unknown held: a free motion moves nothing else.
const BELOW: usize = 2;
/// Entries of a motion below this part of its largest are rounding.
const ROUNDING: f64 = 0.25 * f64::EPSILON;

/// `W+` of one face.
pub struct ClusterInverse {
    pub starts: Vec<usize>,
    pub blocks: Vec<Arc<Block>>,
    /// Of T'W T, with units where T has no column.
    pub factor: Cholesky,
    pub held: Vec<usize>,
    pub clusters: Vec<Cluster>,
    pub weak: bool,
}

/// The motion that one unknown held stands for, the blocks that it moves and the rows that resist it.
pub struct Motion {
    /// Of the blocks that move at all, ascending.
    columns: Vec<usize>,
    amplitudes: Vec<f64>,
    pub blocks: Vec<usize>,
    pub rows: Vec<usize>,
}

/// Motions of some blocks together, over their columns of G.
pub struct Cluster {
    pub columns: Vec<usize>,
    /// Orthonormal.
    pub free: Matrix,
    /// V of those resisted by little, `V'W V = I`.
    pub weak: Matrix,
}

impl GeneralInverse for ClusterInverse {
    fn solve(&self, b: &[f64]) -> Result<Vec<f64>> {
        let mut b = b.to_vec();
        self.clusters.iter().for_each(|cluster| cluster.project(&mut b));
        let mut y = self.in_blocks(&b);
        self.factor.solve(&mut y)?;
        self.held.iter().for_each(|&i| y[i] = 0.0);
        let mut x = self.of_blocks(&y);
        for Cluster { columns, weak, .. } in &self.clusters {
            let own: Vec<f64> = columns.iter().map(|&column| b[column]).collect();
            add(weak, &weak.mul_transposed(&own), columns, &mut x);
        }
        self.clusters.iter().for_each(|cluster| cluster.project(&mut x));
        Ok(x)
    }

    fn add_kernel_part(&self, a: f64, b: &[f64], x: &mut [f64]) {
        for (k, block) in self.blocks.iter().enumerate().filter(|(_, block)| block.free.cols > 0) {
            let columns = self.starts[k]..self.starts[k + 1];
            block.free.mul_add(a, &block.free.mul_transposed(&b[columns.clone()]), &mut x[columns]);
        }
        for Cluster { columns, free, .. } in &self.clusters {
            let own: Vec<f64> = columns.iter().map(|&column| a * b[column]).collect();
            add(free, &free.mul_transposed(&own), columns, x);
        }
    }

    fn deficiency(&self) -> usize {
        self.blocks.iter().map(|block| block.free.cols).sum::<usize>()
            + self.clusters.iter().map(|cluster| cluster.free.cols).sum::<usize>()
    }

    fn kernel(&self) -> Matrix {
        let mut basis = self.none();
        for (k, block) in self.blocks.iter().enumerate() {
            let columns: Vec<usize> = (self.starts[k]..self.starts[k + 1]).collect();
            basis.push_part(&block.free, &columns);
        }
        self.clusters.iter().for_each(|cluster| basis.push_part(&cluster.free, &cluster.columns));
        basis
    }

    /// T but for the unknowns held, and V.
    fn basis(&self) -> Matrix {
        let mut basis = self.none();
        for (k, block) in self.blocks.iter().enumerate() {
            let columns: Vec<usize> = (self.starts[k]..self.starts[k + 1]).collect();
            for j in (0..block.resisted.cols).filter(|j| !self.is_held(columns[*j])) {
                basis.push_part(&block.resisted.columns(j..j + 1), &columns);
            }
        }
        self.clusters.iter().for_each(|cluster| basis.push_part(&cluster.weak, &cluster.columns));
        basis
    }

    fn is_weak(&self) -> bool {
        self.weak
    }
}

impl ClusterInverse {
    fn none(&self) -> Matrix {
        Matrix { rows: self.starts[self.starts.len() - 1], ..Matrix::default() }
    }

    fn is_held(&self, unknown: usize) -> bool {
        self.held.binary_search(&unknown).is_ok()
    }

    /// `T'x`, 0 where T has no column.
    fn in_blocks(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for (block, columns) in self.blocks.iter().zip(self.starts.windows(2)) {
            let own = block.resisted.mul_transposed(&x[columns[0]..columns[1]]);
            y[columns[0]..columns[0] + own.len()].copy_from_slice(&own);
        }
        y
    }

    /// `T y`
    fn of_blocks(&self, y: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; y.len()];
        for (block, columns) in self.blocks.iter().zip(self.starts.windows(2)) {
            let own = &y[columns[0]..columns[0] + block.resisted.cols];
            block.resisted.mul_add(1.0, own, &mut x[columns[0]..columns[1]]);
        }
        x
    }

    /// `T n` for each unknown held: n is 1 there, 0 where others are held, and has no image elsewhere: `G_F'T n = 0`, G_F'T = `turned`.
    pub fn motions(&self, turned: &Csr, (whole, rounding): (&[f64], f64)) -> Result<Vec<Motion>> {
        let by_unknown = turned.transposed()?;
        let (order, mut motions) = (turned.cols, Vec::with_capacity(self.held.len()));
        let (mut n, mut image, mut along) = (vec![0.0; order], vec![0.0; order], vec![0.0; turned.rows()]);
        let mut seen = vec![false; turned.rows()];
        for &at in &self.held {
            let below = self.factor.below(at);
            n[at] = 1.0;
            let (mut moved, mut resisting) = (vec![at], Vec::new());
            let mut last = f64::INFINITY;
            for pass in 0.. {
                resisting.iter().for_each(|&i| along[i] = 0.0);
                resisting = met(&by_unknown, &moved, &mut seen);
                moved.iter().for_each(|&k| by_unknown.row(k).for_each(|(i, v)| along[i] += v * n[k]));
                let left = length(&along, &resisting);
                let stagnates = pass > BELOW && left > 0.5 * last;
                if left <= rounding * length(&n, &moved) || stagnates || pass == CORRECTIONS {
                    break;
                }
                last = left;
                resisting.iter().for_each(|&i| turned.row(i).for_each(|(k, v)| image[k] += along[i] * v));
                self.held.iter().for_each(|&i| image[i] = 0.0);
                if pass < BELOW {
                    self.factor.solve_below(at, &mut image)?;
                    moved = below.iter().copied().chain([at]).collect();
                } else {
                    self.factor.solve(&mut image)?;
                    moved = (0..order).collect();
                }
                self.held.iter().for_each(|&i| image[i] = 0.0);
                moved.iter().for_each(|&k| n[k] -= std::mem::take(&mut image[k]));
                let least = ROUNDING * moved.iter().fold(0.0, |largest: f64, &k| largest.max(n[k].abs()));
                moved.retain(|&k| {
                    let moves = n[k].abs() > least;
                    n[k] = if moves { n[k] } else { 0.0 };
                    moves
                });
                moved.sort_unstable();
            }
            motions.push(self.motion(&n, &moved, (&along, &resisting), (whole, rounding)));
            moved.iter().for_each(|&k| n[k] = 0.0);
            resisting.iter().for_each(|&i| along[i] = 0.0);
        }
        Ok(motions)
    }

    /// The motion `T n` of n, 0 but on the unknowns `moved`, and of what the rows have `along` it.
    fn motion(
        &self,
        n: &[f64],
        moved: &[usize],
        (along, resisting): (&[f64], &[usize]),
        (whole, rounding): (&[f64], f64),
    ) -> Motion {
        let block_of = |k: &usize| self.starts.partition_point(|start| start <= k) - 1;
        let mut blocks: Vec<usize> = moved.iter().map(block_of).collect();
        blocks.dedup();
        let (mut columns, mut amplitudes) = (Vec::new(), Vec::new());
        for &k in &blocks {
            let (own, resisted) = (self.starts[k]..self.starts[k + 1], &self.blocks[k].resisted);
            let mut part = vec![0.0; own.len()];
            resisted.mul_add(1.0, &n[own.start..own.start + resisted.cols], &mut part);
            columns.extend(own);
            amplitudes.extend(part);
        }
        let part = |k: &usize| {
            let at = columns.partition_point(|column| *column < self.starts[*k]);
            &amplitudes[at..at + self.starts[*k + 1] - self.starts[*k]]
        };
        let least = MOVES * norm_max(&amplitudes);
        blocks.retain(|k| norm_max(part(k)) > least);
        let size = blocks.iter().map(|&k| whole[self.starts[k]..self.starts[k + 1]].iter().sum::<f64>());
        let least = rounding * size.sum::<f64>().sqrt() * norm(&amplitudes);
        let rows = resisting.iter().copied().filter(|&i| along[i].abs() > least).collect();
        Motion { columns, amplitudes, blocks, rows }
    }

    /// Motions that move one block, or that one of so many rows resists, belong together: their numbers, cluster by cluster.
    pub fn clusters_of(&self, motions: &[Motion], rows: usize) -> Vec<Vec<usize>> {
        let mut first = vec![None; self.blocks.len() + rows];
        let mut cluster: Vec<usize> = (0..motions.len()).collect();
        let root = |cluster: &[usize], mut at: usize| {
            while cluster[at] != at {
                at = cluster[at];
            }
            at
        };
        for (at, motion) in motions.iter().enumerate() {
            let rows = motion.rows.iter().map(|&i| self.blocks.len() + i);
            for place in motion.blocks.iter().copied().chain(rows) {
                let (a, b) = (root(&cluster, *first[place].get_or_insert(at)), root(&cluster, at));
                cluster[a.max(b)] = a.min(b);
            }
        }
        let mut clusters = vec![Vec::new(); motions.len()];
        (0..motions.len()).for_each(|at| clusters[root(&cluster, at)].push(at));
        clusters.retain(|members| !members.is_empty());
        clusters
    }
}

impl Motion {
    /// On some columns.
    pub fn on(&self, columns: &[usize]) -> Vec<f64> {
        let amplitude = |column| self.columns.binary_search(column).map_or(0.0, |at| self.amplitudes[at]);
        columns.iter().map(amplitude).collect()
    }
}

/// The rows in which some unknowns have entries, ascending; `seen` is false for all rows, and is so again.
fn met(by_unknown: &Csr, unknowns: &[usize], seen: &mut [bool]) -> Vec<usize> {
    let mut rows = Vec::new();
    for (i, v) in unknowns.iter().flat_map(|&k| by_unknown.row(k)) {
        if v != 0.0 && !std::mem::replace(&mut seen[i], true) {
            rows.push(i);
        }
    }
    rows.iter().for_each(|&i| seen[i] = false);
    rows.sort_unstable();
    rows
}

/// |x| of some entries.
fn length(x: &[f64], entries: &[usize]) -> f64 {
    entries.iter().map(|&i| x[i] * x[i]).sum::<f64>().sqrt()
}

impl Cluster {
    /// `x <- x - N N'x`
    fn project(&self, x: &mut [f64]) {
        let own: Vec<f64> = self.columns.iter().map(|&column| -x[column]).collect();
        add(&self.free, &self.free.mul_transposed(&own), &self.columns, x);
    }
}

/// `x += M y` on these columns.
fn add(motions: &Matrix, y: &[f64], columns: &[usize], x: &mut [f64]) {
    let mut own = vec![0.0; columns.len()];
    motions.mul_add(1.0, y, &mut own);
    columns.iter().zip(own).for_each(|(&column, v)| x[column] += v);
}
