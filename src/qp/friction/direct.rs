//! Solves the linear model of a face exactly with a dense matrix, (m + r) x (m + r), if there are not too many rows and
//! modes.

use crate::error::Result;
use crate::linalg::dense::least_squares::least_squares;
use crate::linalg::vector::axpy;
use crate::linalg::Matrix;
use crate::platform::{interrupt, tally};
use crate::qp::friction::coordinates::Law;
use crate::qp::friction::face::Face;
use crate::qp::friction::newton::Point;
use crate::qp::friction::pairs::Step;
use crate::qp::friction::FrictionProblem;
use crate::qp::Direct;

/// A pivot of the matrix with columns of unit length is rounding if it is below this.
const CUT: f64 = 1e-13;

/// F, m x m.
pub struct Dense {
    f: Matrix,
}

impl Dense {
    /// None if there are too many rows and modes.
    pub fn new(problem: &FrictionProblem, direct: Direct) -> Result<Option<Self>> {
        let (m, r) = (problem.b.len(), problem.e.len());
        if m + r > direct.limit {
            return Ok(None);
        }
        interrupt::check()?;
        let mut f = Matrix::zeros(m, m)?;
        let rows: Vec<usize> = (0..m).collect();
        direct.entries.add_block(&rows, &mut f)?;
        for j in 0..m {
            (j + 1..m).for_each(|i| f.set(j, i, f.get(i, j)));
        }
        Ok(Some(Self { f }))
    }

    /// F with supports of this stiffness as further rows.
    pub fn supported(&self, supports: usize, kappa: f64) -> Result<Self> {
        let m = self.f.rows;
        let mut f = Matrix::zeros(m + supports, m + supports)?;
        (0..m).for_each(|j| f.col_mut(j)[..m].copy_from_slice(self.f.col(j)));
        (m..m + supports).for_each(|k| f.set(k, k, 1.0 / kappa));
        Ok(Self { f })
    }

    pub fn step(&self, problem: &FrictionProblem, face: &Face, now: &Point) -> Result<Step> {
        self.solved(problem, face, now).map(|(step, _)| step)
    }

    /// dx and da with `[L; w (W'F + D S)] dx - w A'da = -residual`, `G dx = e - G x`.
    pub fn solved(&self, problem: &FrictionProblem, face: &Face, now: &Point) -> Result<(Step, Vec<f64>)> {
        interrupt::check()?;
        tally::costly();
        let (m, r) = (problem.b.len(), problem.e.len());
        let (mut matrix, mut target) = (Matrix::zeros(m + r, m + r)?, vec![0.0; m + r]);
        let weights = face.weights();
        let weight = |k: usize| if face.coordinates[k].is_free() { weights[k] } else { 1.0 };
        for j in 0..m {
            let (column, mut unit) = (matrix.col_mut(j), vec![0.0; m]);
            unit[j] = 1.0;
            let image = face.image(&unit, self.f.col(j));
            image.iter().enumerate().for_each(|(k, v)| column[k] = weight(k) * v);
            problem.g_transposed.row(j).for_each(|(mode, v)| column[m + mode] = v);
        }
        for (k, coordinate) in face.coordinates.iter().enumerate() {
            if !matches!(coordinate.law, Law::Free { .. }) {
                continue;
            }
            for (&row, along) in coordinate.rows.iter().zip(coordinate.along).filter(|(_, v)| *v != 0.0) {
                for (mode, v) in problem.g_transposed.row(row) {
                    let entry = matrix.get(k, m + mode) - weights[k] * along * v;
                    matrix.set(k, m + mode, entry);
                }
            }
        }
        let residual = face.residual(&now.x, &now.r);
        residual.iter().enumerate().for_each(|(k, v)| target[k] = -weight(k) * v);
        let mut left = problem.e.to_vec();
        problem.g_transposed.mul_transposed_add(-1.0, &now.x, &mut left);
        target[m..].copy_from_slice(&left);
        let mut dx = least_squares(&matrix, &target, CUT)?;
        let turn = dx.split_off(m);
        let mut dg = vec![0.0; m];
        dx.iter().enumerate().for_each(|(j, by)| axpy(*by, self.f.col(j), &mut dg));
        Ok((Step { dx, dg, rest: 0.0 }, turn))
    }
}
