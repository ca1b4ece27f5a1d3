//! Solves the linear model of a face exactly with a dense matrix, (m + r) x (m + r), if there are not too many rows and
//! modes.

use crate::error::Result;
use crate::linalg::dense::least_squares::least_squares;
use crate::linalg::vector::axpy;
use crate::linalg::Matrix;
use crate::numbers::friction::RHO;
use crate::numbers::rounding;
use crate::platform::{interrupt, tally};
use crate::qp::friction::coordinates::Law;
use crate::qp::friction::face::{Face, State};
use crate::qp::friction::newton::Point;
use crate::qp::friction::pairs::Step;
use crate::qp::friction::{Cones, FrictionProblem};
use crate::qp::Direct;

/// F, m x m.
pub struct Dense {
    f: Matrix,
}

impl Dense {
    /// None if there are too many rows and modes.
    pub fn new(problem: &FrictionProblem, direct: Direct) -> Result<Option<Self>> {
        let (m, r) = (problem.qp.b.len(), problem.qp.e.len());
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

    /// dx with its image, and da, from a point of the method.
    pub fn solved(&self, problem: &FrictionProblem, face: &Face, now: &Point) -> Result<(Step, Vec<f64>)> {
        let left = problem.qp.left(&now.x);
        let residual = face.residual(&now.x, &now.r);
        let (dx, turn) = self.newton(problem, face, &residual, (&left, &[]))?;
        let mut dg = vec![0.0; dx.len()];
        dx.iter().enumerate().for_each(|(j, by)| axpy(*by, self.f.col(j), &mut dg));
        Ok((Step { dx, dg, rest: 0.0 }, turn))
    }

    /// dx and da with `[L; w (W'F + D S)] dx - w A'da = -residual`, `G dx + S da = left`; `stiffness`: diagonal of S, by modes.
    fn newton(
        &self,
        problem: &FrictionProblem,
        face: &Face,
        residual: &[f64],
        (left, stiffness): (&[f64], &[(usize, f64)]),
    ) -> Result<(Vec<f64>, Vec<f64>)> {
        interrupt::check()?;
        tally::costly();
        let (m, r) = (self.f.rows, left.len());
        let (mut matrix, mut target) = (Matrix::zeros(m + r, m + r)?, vec![0.0; m + r]);
        let weights = face.weights();
        let weight = |k: usize| if face.coordinates[k].is_free() { weights[k] } else { 1.0 };
        for j in 0..m {
            let (column, mut unit) = (matrix.col_mut(j), vec![0.0; m]);
            unit[j] = 1.0;
            let image = face.image(&unit, self.f.col(j));
            image.iter().enumerate().for_each(|(k, v)| column[k] = weight(k) * v);
            problem.qp.g_transposed.row(j).for_each(|(mode, v)| column[m + mode] = v);
        }
        for (k, coordinate) in face.coordinates.iter().enumerate() {
            if !matches!(coordinate.law, Law::Free { .. }) {
                continue;
            }
            for (&row, along) in coordinate.rows.iter().zip(coordinate.along).filter(|(_, v)| *v != 0.0) {
                for (mode, v) in problem.qp.g_transposed.row(row) {
                    let entry = matrix.get(k, m + mode) - weights[k] * along * v;
                    matrix.set(k, m + mode, entry);
                }
            }
        }
        stiffness.iter().for_each(|&(mode, own)| matrix.set(m + mode, m + mode, own));
        residual.iter().enumerate().for_each(|(k, v)| target[k] = -weight(k) * v);
        target[m..].copy_from_slice(left);
        let mut dx = least_squares(&matrix, &target, rounding::SOLVE)?;
        let turn = dx.split_off(m);
        Ok((dx, turn))
    }
}

/// A point of the corrector, in lengths and forces of the dual.
pub struct Corrected<'a> {
    pub x: &'a [f64],
    /// `c + C x - B u`: gaps, and minus the slips.
    pub r: &'a [f64],
    /// The same after K+ has taken the residual loads.
    pub follows: &'a [f64],
    /// What the forces leave of the resultants.
    pub left: &'a [f64],
    /// Modes with negative stiffness.
    pub stiffness: &'a [(usize, f64)],
}

/// The Newton step of a point by dense factors: dx, da, and the states that it assumes; none if rows and modes are too many.
pub fn newton_step(
    problem: &FrictionProblem,
    direct: Direct,
    at: &Corrected,
) -> Result<Option<(Vec<f64>, Vec<f64>, Vec<State>)>> {
    let Some(dense) = Dense::new(problem, direct)? else { return Ok(None) };
    let face = Face::at(problem.cones, at.x, at.r, RHO);
    let residual = face.residual(at.x, at.follows);
    let (dx, turn) = dense.newton(problem, &face, &residual, (at.left, at.stiffness))?;
    Ok(Some((dx, turn, face.states)))
}

/// The rows that carry no force at this point: of nodes that open, tangential ones without a bound.
pub fn without_force(cones: &Cones, x: &[f64], r: &[f64]) -> Vec<bool> {
    let mut open = vec![false; x.len()];
    for at in Face::at(cones, x, r, RHO).coordinates.iter().filter(|at| at.coupling.is_none()) {
        if at.law == (Law::Held { value: 0.0 }) {
            at.rows.into_iter().for_each(|row| open[row] = true);
        }
    }
    open
}

/// The tangential rows of nodes that slip at this point.
pub fn slipping<'c>(cones: &'c Cones, x: &[f64], r: &[f64]) -> impl Iterator<Item = usize> + 'c {
    let states = Face::at(cones, x, r, RHO).states;
    let slips = cones.nodes().iter().zip(states).filter(|(_, state)| *state == State::Slip);
    slips.flat_map(|(node, _)| node.tangents().iter().copied())
}
