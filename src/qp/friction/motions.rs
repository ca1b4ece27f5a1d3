//! The coarse space on a face with friction: `A w^2 A'`, r x r and sparse, A = G W or G Z over the coordinates of the face. All faces
//! share its pattern, which is analysed once.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::semidefinite::clusters::Blocks;
use crate::linalg::semidefinite::sparse::{FaceRows, PseudoInverse};
use crate::linalg::semidefinite::{is_regular_factor, GeneralInverse};
use crate::linalg::sparse::gram::Gram;
use crate::linalg::vector::{norm_max, power_of_two_below};
use crate::linalg::{Analysis, Cholesky, Csr, Symmetric};
use crate::platform::memory::{headroom_with, SMALL_MATRICES};
use crate::platform::{interrupt, tally};
use crate::qp::friction::coordinates::{self, Coordinate};
use crate::qp::friction::FrictionProblem;

/// Motions that weighted rows resist by less than this part of |G| are free: for `A w^2 A'` the limit is its square,
/// 1e-11.
const CUT: f64 = 3e-6;

/// Data common to all faces of one G; none without modes.
pub struct Motions<'a> {
    g_transposed: &'a Csr,
    blocks: &'a [usize],
    rounding: f64,
    /// Pattern of A' of the last face, m x r.
    pattern: Csr,
    gram: Gram,
    analysis: Arc<Analysis>,
    /// The power of two s for which W is divided by s^2, and the diagonal of `G G' / s^2`.
    unit: f64,
    whole: Vec<f64>,
    nothing_held: Vec<bool>,
}

/// Rows of A' with their weights, and `(A w^2 A')^+`.
pub struct Inverse {
    /// m x r
    rows: Csr,
    weights: Vec<f64>,
    unit: f64,
    solver: Solver,
}

enum Solver {
    Cholesky(Cholesky),
    Singular(Box<dyn GeneralInverse>),
}

impl<'a> Motions<'a> {
    pub fn of(problem: &FrictionProblem<'a>) -> Result<Option<Self>> {
        let g_transposed = problem.g_transposed;
        if g_transposed.cols == 0 {
            return Ok(None);
        }
        interrupt::check()?;
        tally::costly();
        let pattern = coordinates::pattern(problem.cones, g_transposed);
        let gram = Gram::of(&pattern)?;
        let analysis = Arc::new(Analysis::new(gram.pattern(), &vec![false; g_transposed.cols])?);
        let mut whole = vec![0.0; g_transposed.cols];
        g_transposed.col.iter().zip(&g_transposed.val).for_each(|(&k, v)| whole[k] += v * v);
        let unit = power_of_two_below(norm_max(&whole).sqrt());
        whole.iter_mut().for_each(|v| *v /= unit * unit);
        let nothing_held = vec![false; pattern.rows()];
        let (blocks, rounding) = (problem.blocks, problem.rounding);
        Ok(Some(Self { g_transposed, blocks, rounding, pattern, gram, analysis, unit, whole, nothing_held }))
    }

    /// `(G G')^+` over all rows, for any coordinates.
    pub fn of_all_rows(&self, coordinates: &[Coordinate]) -> Result<Inverse> {
        self.inverse(self.in_coordinates(coordinates, false), vec![1.0; coordinates.len()], self.rounding)
    }

    /// For A = G W, or, if `through`, for A = G Z, in which normal coordinates also move those along the slip that follow
    /// them.
    pub fn on(&self, coordinates: &[Coordinate], weights: Vec<f64>, through: bool) -> Result<Inverse> {
        self.inverse(self.in_coordinates(coordinates, through), weights, CUT.max(self.rounding))
    }

    /// Factor of `A w^2 A' + shift max diag(G G') I`; none if it is not positive definite.
    pub fn shifted(
        &self,
        coordinates: &[Coordinate],
        weights: Vec<f64>,
        shift: f64,
    ) -> Result<Option<Inverse>> {
        interrupt::check()?;
        tally::costly();
        let rows = self.in_coordinates(coordinates, true);
        let mut w = self.gram.weighted(&rows, |i| weights[i] * weights[i])?;
        self.in_units(&mut w);
        let shift = shift * norm_max(&self.whole);
        (0..w.order()).for_each(|k| w.val[w.ptr[k + 1] - 1] += shift);
        let factor = self.analysis.attempt(&w, 1.0)?.ok();
        let unit = self.unit;
        Ok(factor.map(|factor| Inverse { rows, weights, unit, solver: Solver::Cholesky(factor) }))
    }

    /// The largest diagonal entry of `G G'`.
    pub fn size(&self) -> f64 {
        norm_max(&self.whole) * self.unit * self.unit
    }

    /// Bytes of the rows of a face, with and without weights.
    fn bytes(&self) -> usize {
        2 * (self.pattern.val.len() * (size_of::<f64>() + size_of::<usize>())
            + self.pattern.ptr.len() * size_of::<usize>())
    }

    fn in_units(&self, w: &mut Symmetric) {
        w.val.iter_mut().for_each(|v| *v /= self.unit * self.unit);
    }

    fn inverse(&self, rows: Csr, weights: Vec<f64>, rounding: f64) -> Result<Inverse> {
        interrupt::check()?;
        tally::costly();
        let _room = headroom_with(self.bytes(), SMALL_MATRICES, "the coarse space of a face")?;
        let mut weighted = rows.clone();
        for (i, weight) in weights.iter().enumerate() {
            weighted.val[rows.ptr[i]..rows.ptr[i + 1]].iter_mut().for_each(|v| *v *= weight);
        }
        let mut w = self.gram.sum(&weighted, &self.nothing_held)?;
        self.in_units(&mut w);
        let solver = self.solver(&w, &weighted, rounding)?;
        Ok(Inverse { rows, weights, unit: self.unit, solver })
    }

    fn solver(&self, w: &Symmetric, weighted: &Csr, rounding: f64) -> Result<Solver> {
        if let Ok(factor) = self.analysis.attempt(w, 1.0)? {
            if is_regular_factor(&factor)? {
                return Ok(Solver::Cholesky(factor));
            }
        }
        let (held, unit, whole) = (&self.nothing_held[..], self.unit, &self.whole[..]);
        let rows = FaceRows { g_transposed: weighted, held, unit, whole, rounding };
        if let Some(inverse) = PseudoInverse::new(w, &self.analysis, &rows)? {
            return Ok(Solver::Singular(Box::new(inverse)));
        }
        let mut blocks = Blocks::new(weighted, self.blocks, held, (unit, whole, rounding))?;
        Ok(Solver::Singular(Box::new(blocks.inverse(held)?)))
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

impl Inverse {
    /// `(A w^2 A')^+ b`
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>> {
        interrupt::check()?;
        tally::costly();
        let mut x: Vec<f64> = b.iter().map(|b| b / self.unit).collect();
        match &self.solver {
            Solver::Cholesky(factor) => factor.solve(&mut x)?,
            Solver::Singular(solver) => x = solver.solve(&x)?,
        }
        x.iter_mut().for_each(|x| *x /= self.unit);
        Ok(x)
    }

    /// `A y`
    pub fn image(&self, y: &[f64]) -> Vec<f64> {
        self.rows.mul_transposed(y)
    }

    /// `A w^2 y`
    pub fn weighted_image(&self, y: &[f64]) -> Vec<f64> {
        let weighted: Vec<f64> = y.iter().zip(&self.weights).map(|(y, w)| w * w * y).collect();
        self.rows.mul_transposed(&weighted)
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
