//! W+ by the factor of T'W T and the motions of clusters of blocks.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::semidefinite::clusters::block::Block;
use crate::linalg::{Cholesky, Matrix};

/// `W+` of one face.
pub struct ClusterInverse {
    pub starts: Vec<usize>,
    pub blocks: Vec<Arc<Block>>,
    /// Factor of T'W T, with units where T has no column.
    pub factor: Arc<Cholesky>,
    pub held: Vec<usize>,
    pub clusters: Vec<Cluster>,
    /// Some motions are resisted so weakly that rounding of `G_F v` matters in `W+ G_F v`.
    pub weak: bool,
}

/// Motions of some blocks together, over their columns of G.
pub struct Cluster {
    pub columns: Vec<usize>,
    /// Orthonormal.
    pub free: Matrix,
    /// V of the weakly resisted motions, `V'W V = I`.
    pub weak: Matrix,
}

impl ClusterInverse {
    /// The solution of minimum norm.
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>> {
        let mut b = b.to_vec();
        self.clusters.iter().for_each(|cluster| cluster.project(&mut b));
        let mut x = self.of_factor(&b)?;
        for Cluster { columns, weak, .. } in &self.clusters {
            let own: Vec<f64> = columns.iter().map(|&column| b[column]).collect();
            add(weak, &weak.mul_transposed(&own), columns, &mut x);
        }
        self.clusters.iter().for_each(|cluster| cluster.project(&mut x));
        Ok(x)
    }

    /// `T (T'W T)^-1 T'b` without the held unknowns.
    pub fn of_factor(&self, b: &[f64]) -> Result<Vec<f64>> {
        let mut y = self.in_blocks(b);
        self.factor.solve(&mut y)?;
        self.held.iter().for_each(|&i| y[i] = 0.0);
        Ok(self.of_blocks(&y))
    }

    /// `x += a N N'b`, N an orthonormal basis of the kernel.
    pub fn add_kernel_part(&self, a: f64, b: &[f64], x: &mut [f64]) {
        for (k, block) in self.blocks.iter().enumerate().filter(|(_, block)| block.free.cols > 0) {
            let columns = self.starts[k]..self.starts[k + 1];
            block.free.mul_add(a, &block.free.mul_transposed(&b[columns.clone()]), &mut x[columns]);
        }
        for Cluster { columns, free, .. } in &self.clusters {
            let own: Vec<f64> = columns.iter().map(|&column| a * b[column]).collect();
            add(free, &free.mul_transposed(&own), columns, x);
        }
    }

    /// Dimension of the kernel.
    pub fn deficiency(&self) -> usize {
        self.blocks.iter().map(|block| block.free.cols).sum::<usize>()
            + self.clusters.iter().map(|cluster| cluster.free.cols).sum::<usize>()
    }

    /// Basis of the kernel, r x deficiency.
    pub fn kernel(&self) -> Matrix {
        let mut basis = self.none();
        for (k, block) in self.blocks.iter().enumerate() {
            let columns: Vec<usize> = (self.starts[k]..self.starts[k + 1]).collect();
            basis.push_part(&block.free, &columns);
        }
        self.clusters.iter().for_each(|cluster| basis.push_part(&cluster.free, &cluster.columns));
        basis
    }

    /// Basis of a complement of the kernel, r x rank: T without the held unknowns, and V.
    pub fn basis(&self) -> Matrix {
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
