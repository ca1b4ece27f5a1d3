//! The coarse space on a face with friction: `A w^2 A'`, r x r and sparse, A = G W or G Z over the coordinates of the face.

use crate::error::Result;
use crate::linalg::vector::norm_max;
use crate::linalg::Csr;
use crate::platform::memory::{headroom_with, SMALL_MATRICES};
use crate::platform::{interrupt, tally};
use crate::qp::friction::cones::Cones;
use crate::qp::friction::coordinates::{self, Coordinate};
use crate::qp::space::{CoarseInverse, Space};
use crate::qp::Qp;

/// Data common to all faces of one G.
pub struct Motions<'a> {
    g_transposed: &'a Csr,
    blocks: &'a [usize],
    rounding: f64,
    /// Pattern of A' of all faces, m x r.
    pattern: Csr,
    space: Space,
    nothing_held: Vec<bool>,
}

/// Rows of A' with their weights, and `(A w^2 A')^+`.
pub struct Turned {
    /// A' and w A', m x r
    rows: Csr,
    weighted: Csr,
    pub weights: Vec<f64>,
    inverse: CoarseInverse,
}

impl<'a> Motions<'a> {
    pub fn of(qp: &Qp<'a>, cones: &Cones) -> Result<Self> {
        interrupt::check()?;
        tally::costly();
        let &Qp { g_transposed, blocks, rounding, .. } = qp;
        let pattern = coordinates::pattern(cones, g_transposed);
        let space = Space::new(g_transposed, &pattern, vec![true; pattern.rows()])?;
        let nothing_held = vec![false; pattern.rows()];
        Ok(Self { g_transposed, blocks, rounding, pattern, space, nothing_held })
    }

    /// `(A w^2 A')^+` for A = G W, or, if `through`, for A = G Z, in which normal coordinates also move those along the slip that follow
    /// them. Motions a are free if `|w A'a| <= cut |G| |a|`, but not below the rounding of G.
    pub fn inverse(
        &mut self,
        coordinates: &[Coordinate],
        weights: Vec<f64>,
        (through, cut): (bool, f64),
    ) -> Result<Turned> {
        interrupt::check()?;
        tally::costly();
        let (rows, cut) = (self.in_coordinates(coordinates, through), cut.max(self.rounding));
        let entries = rows.val.len() * (size_of::<f64>() + size_of::<usize>());
        let both = 2 * (entries + rows.ptr.len() * size_of::<usize>());
        let _room = headroom_with(both, SMALL_MATRICES, "the coarse space of a face")?;
        let mut weighted = rows.clone();
        for (i, weight) in weights.iter().enumerate() {
            weighted.val[rows.ptr[i]..rows.ptr[i + 1]].iter_mut().for_each(|v| *v *= weight);
        }
        let inverse = self.space.inverse(&weighted, self.blocks, &self.nothing_held, cut)?;
        // the blocks are those of these rows
        self.space.by_blocks = None;
        Ok(Turned { rows, weighted, weights, inverse })
    }

    /// `A w^2 A' + shift max diag(G G') I` for A = G Z; none without modes, or if it is not positive definite.
    pub fn shifted(
        &self,
        coordinates: &[Coordinate],
        weights: &[f64],
        shift: f64,
    ) -> Result<Option<CoarseInverse>> {
        let rows = self.in_coordinates(coordinates, true);
        let shift = shift * norm_max(&self.space.whole);
        self.space.weighted(&rows, |i| weights[i] * weights[i], |_| shift)
    }

    /// The largest diagonal entry of `G G'`.
    pub fn size(&self) -> f64 {
        self.space.largest()
    }

    /// `W'G'` or `Z'G'`, m x r.
    fn in_coordinates(&self, coordinates: &[Coordinate], through: bool) -> Csr {
        let mut rows = self.pattern.clone();
        for (k, coordinate) in coordinates.iter().enumerate() {
            self.add_row(&mut rows, k, coordinate, 1.0);
            if let Some((before, coupling)) = coordinate.coupling.filter(|_| through) {
                self.add_row(&mut rows, k - before, coordinate, coupling);
            }
        }
        rows
    }

    /// Adds the row of a coordinate, times `by`, to row k.
    fn add_row(&self, rows: &mut Csr, k: usize, coordinate: &Coordinate, by: f64) {
        let own = rows.ptr[k]..rows.ptr[k + 1];
        for (&row, along) in coordinate.rows.iter().zip(coordinate.along).filter(|(_, along)| *along != 0.0) {
            for (j, v) in self.g_transposed.row(row) {
                if let Ok(at) = rows.col[own.clone()].binary_search(&j) {
                    rows.val[own.start + at] += by * along * v;
                }
            }
        }
    }
}

impl Turned {
    /// `(A w^2 A')^+ b`
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>> {
        self.inverse.solve(b)
    }

    /// `A y`
    pub fn image(&self, y: &[f64]) -> Vec<f64> {
        self.rows.mul_transposed(y)
    }

    /// `A w^2 y`
    pub fn weighted_image(&self, y: &[f64]) -> Vec<f64> {
        let weighted: Vec<f64> = y.iter().zip(&self.weights).map(|(y, w)| w * y).collect();
        self.weighted.mul_transposed(&weighted)
    }

    /// `y -= w A'(A w^2 A')^+ A w y`: no motion reduces what is left.
    pub fn project(&self, y: &mut [f64]) -> Result<()> {
        let beta = self.solve(&self.weighted.mul_transposed(y))?;
        y.iter_mut().enumerate().for_each(|(i, y)| *y -= self.weighted.row_dot(i, &beta));
        Ok(())
    }

    /// `A w^2 A' beta`
    pub fn resistance(&self, beta: &[f64]) -> Vec<f64> {
        let images: Vec<f64> = (0..self.rows.rows()).map(|i| self.rows.row_dot(i, beta)).collect();
        self.weighted_image(&images)
    }

    /// `y += by w^2 A' beta`
    pub fn add_weighted(&self, by: f64, beta: &[f64], y: &mut [f64]) {
        for (i, (y, w)) in y.iter_mut().zip(&self.weights).enumerate().filter(|(_, (_, w))| **w != 0.0) {
            *y += by * w * w * self.rows.row_dot(i, beta);
        }
    }

    /// `(A'beta)_i`
    pub fn row_dot(&self, i: usize, beta: &[f64]) -> f64 {
        self.rows.row_dot(i, beta)
    }
}
