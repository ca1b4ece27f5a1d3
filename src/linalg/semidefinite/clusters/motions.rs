//! The motions of the held unknowns, and the entries of rows along them.

use std::ops::Range;

use crate::error::Result;
use crate::linalg::semidefinite::clusters::inverse::ClusterInverse;
use crate::linalg::sparse::csr::by_columns;
use crate::linalg::vector::{norm, norm_max, LONG};
use crate::linalg::Csr;
use crate::platform::threads::parts;

/// Limit of corrections; after a few, the images of the motions are accurate to rounding.
const CORRECTIONS: usize = 8;
/// The first corrections are restricted to the unknowns below the held one in the elimination: a free motion moves no
/// others.
const BELOW: usize = 2;
/// If more than one in this number of unknowns moves, images are computed row by row.
const MANY: usize = 8;
/// Motions that involve many rows are found in so many parts at most, each with vectors over all rows.
const PARTS: usize = 4;
/// Entries of a motion below this part of its largest are rounding.
const ROUNDING: f64 = 0.25 * f64::EPSILON;

/// The motion of one held unknown, the blocks that it moves and the rows that resist it.
pub struct Motion {
    /// The unknown held.
    at: usize,
    /// The unknowns that move with it: n.
    n: Vec<(usize, f64)>,
    /// Columns of the blocks that move, ascending.
    columns: Vec<usize>,
    amplitudes: Vec<f64>,
    pub blocks: Vec<usize>,
    pub rows: Vec<usize>,
}

impl ClusterInverse {
    /// `T n` for each held unknown: n is 1 there, 0 at other held unknowns, and `G_F'T n = 0` at all others. Motions
    /// found `before` on another face are reused if they have no image on this face.
    pub fn motions(
        &self,
        (turned, by_column): (&Csr, &ByColumn),
        limits: (&[f64], f64),
        before: &[Motion],
    ) -> Result<Vec<Motion>> {
        let as_before = before.iter().map(|motion| motion.at).eq(self.held.iter().copied());
        let before = if as_before { before } else { &[] };
        let count = self.held.len();
        let each = if turned.rows() < LONG { count } else { count.div_ceil(PARTS) }.max(1);
        let some = parts(count.div_ceil(each), |k| {
            let own = k * each..count.min((k + 1) * each);
            self.some_motions(own, Images::new(turned, by_column), limits, before)
        });
        Ok(some.into_iter().collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
    }

    /// The motions of some of the held unknowns; either each of them has a motion `before` or none has.
    fn some_motions(
        &self,
        own: Range<usize>,
        mut images: Images,
        (sizes, rounding): (&[f64], f64),
        before: &[Motion],
    ) -> Result<Vec<Motion>> {
        let mut motions = Vec::with_capacity(own.len());
        let mut n = vec![0.0; images.turned.cols];
        for j in own {
            let at = self.held[j];
            let mut moved = Vec::new();
            let known = before.get(j);
            for &(k, v) in known.into_iter().flat_map(|motion| &motion.n) {
                moved.push(k);
                n[k] = v;
            }
            if known.is_none() || images.of(&n, &moved) > rounding * length(&n, &moved) {
                moved.iter().for_each(|&k| n[k] = 0.0);
                moved = self.corrected(at, &mut n, &mut images, rounding)?;
            }
            motions.push(self.motion(at, &n, &moved, (&images.along, &images.resisting), (sizes, rounding)));
            moved.iter().for_each(|&k| n[k] = 0.0);
        }
        Ok(motions)
    }

    /// Corrects n, which is 1 at a held unknown, until its image is 0 relative to this 1; returns the unknowns that it
    /// moves, ascending. The largest entries are no measure: they may be common to several motions, and the cluster has
    /// the difference of these.
    fn corrected(&self, at: usize, n: &mut [f64], images: &mut Images, rounding: f64) -> Result<Vec<usize>> {
        let below = self.factor.below(at);
        n[at] = 1.0;
        let (mut moved, mut last, mut image) = (vec![at], f64::INFINITY, vec![0.0; n.len()]);
        for pass in 0.. {
            let left = images.of(n, &moved);
            let stagnates = pass > BELOW && left > 0.5 * last;
            if left <= rounding || stagnates || pass == CORRECTIONS {
                break;
            }
            last = left;
            images.back(&mut image);
            self.held.iter().for_each(|&i| image[i] = 0.0);
            if pass < BELOW {
                self.factor.solve_below(at, &mut image)?;
                moved = below.iter().copied().chain([at]).collect();
            } else {
                self.factor.solve(&mut image)?;
                moved = (0..n.len()).collect();
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
        Ok(moved)
    }

    /// The motion `T n` of n, which is 0 except on the unknowns `moved`, with the entries of rows `along` it.
    fn motion(
        &self,
        at: usize,
        n: &[f64],
        moved: &[usize],
        (along, resisting): (&[f64], &[usize]),
        (sizes, rounding): (&[f64], f64),
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
        let least = rounding * norm_max(&amplitudes);
        blocks.retain(|k| norm_max(part(k)) > least);
        let least = rounding * length(sizes, &blocks) * norm(&amplitudes);
        let rows = resisting.iter().copied().filter(|&i| along[i].abs() > least).collect();
        let n = moved.iter().map(|&k| (k, n[k])).collect();
        Motion { at, n, columns, amplitudes, blocks, rows }
    }

    /// Motions that move a common block, or that a common row resists, form a cluster: the motion numbers of each
    /// cluster.
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
    /// The motion restricted to some columns.
    pub fn on(&self, columns: &[usize]) -> Vec<f64> {
        let amplitude = |column| self.columns.binary_search(column).map_or(0.0, |at| self.amplitudes[at]);
        columns.iter().map(amplitude).collect()
    }
}

/// Positions of the entries of a matrix by rows, sorted by columns.
pub struct ByColumn {
    ptr: Vec<usize>,
    /// Row of an entry, and its position in the values.
    entry: Vec<(u32, u32)>,
}

impl ByColumn {
    pub fn of(rows: &Csr) -> Result<Self> {
        let entries = || (0..rows.rows()).flat_map(|i| (rows.ptr[i]..rows.ptr[i + 1]).map(move |at| (i, at)));
        let by = || entries().map(|(i, at)| ((i as u32, at as u32), rows.col[at], 0.0));
        let (ptr, entry, _) = by_columns(rows.cols, by, "the coarse space")?;
        Ok(Self { ptr, entry })
    }

    fn column(&self, k: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.entry[self.ptr[k]..self.ptr[k + 1]].iter().map(|&(i, at)| (i as usize, at as usize))
    }
}

/// The entries of the rows along a motion.
struct Images<'a> {
    /// `G_F'T`
    turned: &'a Csr,
    by_column: &'a ByColumn,
    along: Vec<f64>,
    /// The rows with a nonzero entry along it, ascending.
    resisting: Vec<usize>,
    seen: Vec<bool>,
}

impl<'a> Images<'a> {
    fn new(turned: &'a Csr, by_column: &'a ByColumn) -> Self {
        let m = turned.rows();
        Self { turned, by_column, along: vec![0.0; m], resisting: Vec::new(), seen: vec![false; m] }
    }

    /// Computes `G_F'T n`, n on some unknowns; returns its length.
    fn of(&mut self, n: &[f64], unknowns: &[usize]) -> f64 {
        let Self { turned, by_column, along, resisting, seen } = self;
        resisting.drain(..).for_each(|i| along[i] = 0.0);
        if MANY * unknowns.len() > n.len() {
            // row by row, in the order of G_F'T in memory
            for i in 0..along.len() {
                let mut entries = turned.row(i).filter(|(k, v)| *v != 0.0 && n[*k] != 0.0).peekable();
                if entries.peek().is_some() {
                    along[i] = entries.map(|(k, v)| v * n[k]).sum();
                    resisting.push(i);
                }
            }
            return length(along, resisting);
        }
        for &k in unknowns {
            for (i, at) in by_column.column(k).filter(|(_, at)| turned.val[*at] != 0.0) {
                along[i] += turned.val[at] * n[k];
                if !std::mem::replace(&mut seen[i], true) {
                    resisting.push(i);
                }
            }
        }
        resisting.iter().for_each(|&i| seen[i] = false);
        resisting.sort_unstable();
        length(along, resisting)
    }

    /// `y += T'G_F` times the last images.
    fn back(&self, y: &mut [f64]) {
        for &i in &self.resisting {
            self.turned.row(i).for_each(|(k, v)| y[k] += self.along[i] * v);
        }
    }
}

/// |x| over some entries.
pub fn length(x: &[f64], entries: &[usize]) -> f64 {
    entries.iter().map(|&i| x[i] * x[i]).sum::<f64>().sqrt()
}
