//! W+ by the factor of T'W T and the motions of clusters of blocks.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::semidefinite::clusters::block::Block;
use crate::linalg::semidefinite::GeneralInverse;
use crate::linalg::vector::{axpy, norm, norm_max};
use crate::linalg::{Cholesky, Csr, Matrix, Symmetric};

/// A cluster moves with a motion when it has more than this part of its largest entry.
const MOVES: f64 = 1e-9;
/// The images of the motions held become accurate to rounding in a few corrections; at most so many.
const CORRECTIONS: usize = 8;
/// The first ones are made on what is eliminated before the unknown held: a free motion moves nothing else.
const BELOW: usize = 2;

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
    pub amplitudes: Vec<f64>,
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

    /// `T n` for each unknown held: n is 1 there, 0 where others are held, and has no image elsewhere. `w` = T'W T of `turned`.
    pub fn motions(
        &self,
        w: &Symmetric,
        turned: &Csr,
        (whole, rounding): (&[f64], f64),
    ) -> Result<Vec<Motion>> {
        let at_rest = |x: &mut [f64]| self.held.iter().for_each(|&i| x[i] = 0.0);
        let mut motions = Vec::with_capacity(self.held.len());
        for &at in &self.held {
            let (mut n, mut image) = (vec![0.0; w.order()], vec![0.0; w.order()]);
            let mut along = vec![0.0; turned.rows()];
            n[at] = 1.0;
            w.mul(&n, &mut image);
            let mut last = f64::INFINITY;
            for pass in 0..CORRECTIONS {
                at_rest(&mut image);
                if pass < BELOW {
                    self.factor.solve_below(at, &mut image)?;
                } else {
                    self.factor.solve(&mut image)?;
                }
                at_rest(&mut image);
                axpy(-1.0, &image, &mut n);
                turned.mul(&n, &mut along);
                let left = norm(&along);
                if left <= rounding * norm(&n) || pass >= BELOW && left > 0.5 * last {
                    break;
                }
                last = left;
                image.fill(0.0);
                turned.mul_transposed_add(1.0, &along, &mut image);
            }
            let amplitudes = self.of_blocks(&n);
            let least = MOVES * norm_max(&amplitudes);
            let moves = |k: &usize| norm_max(&amplitudes[self.starts[*k]..self.starts[*k + 1]]) > least;
            let blocks: Vec<usize> = (0..self.blocks.len()).filter(moves).collect();
            let size = blocks.iter().map(|&k| whole[self.starts[k]..self.starts[k + 1]].iter().sum::<f64>());
            let least = rounding * size.sum::<f64>().sqrt() * norm(&amplitudes);
            let rows = (0..along.len()).filter(|&i| along[i].abs() > least).collect();
            motions.push(Motion { amplitudes, blocks, rows });
        }
        Ok(motions)
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
