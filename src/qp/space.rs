//! The coarse matrix `W = G_F G_F'` over some rows, r x r and sparse, and its inverses. Its pattern is analysed once for all faces, and the
//! part that they share is factorised once.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::semidefinite::clusters::{Blocks, ClusterInverse};
use crate::linalg::semidefinite::faces::FaceFactors;
use crate::linalg::semidefinite::is_regular;
use crate::linalg::vector::{norm_max, power_of_two_below};
use crate::linalg::{Cholesky, Csr, Matrix, Runs};
use crate::numbers::linalg::WEAK;
use crate::platform::{interrupt, tally};

/// Depends on G and on which rows faces may hold, not on loads and gaps.
#[derive(Default)]
pub struct Space {
    /// `G'`, m x r.
    pub rows: Runs,
    /// The power of two s for which W is divided by s^2.
    pub unit: f64,
    /// Diagonal of `G G' / s^2` with all rows: its largest entry is in [1, 4).
    pub whole: Vec<f64>,
    /// Rows that faces may hold.
    pub bounded: Vec<bool>,
    /// None without modes.
    pub factors: Option<FaceFactors>,
    /// Made for the first face that leaves many motions free.
    pub by_blocks: Option<Blocks>,
}

/// `W+` of some rows.
pub struct CoarseInverse {
    /// s
    pub unit: f64,
    solver: Solver,
}

enum Solver {
    /// Without modes.
    Nothing,
    Cholesky(Arc<Cholesky>),
    /// Solution of minimum norm.
    Singular(Box<ClusterInverse>),
}

impl Space {
    /// `pattern`: G', or rows with more entries, if W is also that of other rows with this pattern.
    pub fn new(g_transposed: &Csr, pattern: &Csr, bounded: Vec<bool>) -> Result<Self> {
        let mut whole = vec![0.0; g_transposed.cols];
        for (&k, v) in g_transposed.col.iter().zip(&g_transposed.val) {
            whole[k] += v * v;
        }
        let unit = power_of_two_below(norm_max(&whole).sqrt());
        whole.iter_mut().for_each(|v| *v /= unit * unit);
        let factors = match whole.len() {
            0 => None,
            _ => Some(FaceFactors::new(pattern, bounded.clone())?),
        };
        Ok(Self { rows: Runs::of(g_transposed)?, unit, whole, bounded, factors, by_blocks: None })
    }

    /// The largest diagonal entry of `G G'`.
    pub fn largest(&self) -> f64 {
        self.unit * self.unit * norm_max(&self.whole)
    }

    /// `W^-1` of the rows that are not held, or W+ if some motions are free or resisted weakly. `rows`: G', or other rows with its
    /// pattern; a motion a is free if `|G_F a| <= rounding |G| |a|`.
    pub fn inverse(
        &mut self,
        rows: &Csr,
        blocks: &[usize],
        held: &[bool],
        rounding: f64,
    ) -> Result<CoarseInverse> {
        let &mut Self { unit, ref whole, ref mut factors, ref mut by_blocks, .. } = self;
        let Some(factors) = factors else { return Ok(CoarseInverse::NOTHING) };
        if !by_blocks.as_ref().is_some_and(|known| known.left_free) {
            if let Ok(factor) = factors.factor(rows, held, (1.0 / (unit * unit), 0.0), |_| ())? {
                if is_regular(&factor)? {
                    return Ok(CoarseInverse { unit, solver: Solver::Cholesky(factor) });
                }
            }
        }
        let mut known = match by_blocks.take() {
            Some(known) => known,
            None => Blocks::new(rows, blocks, &self.bounded, (unit, whole, rounding))?,
        };
        let found = known.inverse(held)?;
        *by_blocks = Some(known);
        Ok(CoarseInverse { unit, solver: Solver::Singular(Box::new(found)) })
    }

    /// `(G D G' + s^2 D_+)^-1`, D = diag(`weight`), `D_+` by the diagonal of `G G' / s^2`; none without modes, or if it is not positive
    /// definite.
    pub fn weighted(
        &self,
        rows: &Csr,
        weight: impl Fn(usize) -> f64,
        added: impl Fn(f64) -> f64,
    ) -> Result<Option<CoarseInverse>> {
        let Self { factors: Some(factors), unit, whole, .. } = self else { return Ok(None) };
        interrupt::check()?;
        tally::costly();
        let mut w = factors.gram().weighted(rows, weight)?;
        w.val.iter_mut().for_each(|v| *v /= unit * unit);
        whole.iter().enumerate().for_each(|(k, whole)| w.val[w.ptr[k + 1] - 1] += added(*whole));
        let factor = factors.analysis().attempt(&w, 1.0)?.ok();
        Ok(factor.map(|factor| CoarseInverse { unit: *unit, solver: Solver::Cholesky(Arc::new(factor)) }))
    }
}

impl CoarseInverse {
    pub const NOTHING: Self = Self { unit: 1.0, solver: Solver::Nothing };

    /// `W+ rhs`
    pub fn solve(&self, rhs: &[f64]) -> Result<Vec<f64>> {
        if matches!(self.solver, Solver::Nothing) {
            return Ok(vec![0.0; rhs.len()]);
        }
        interrupt::check()?;
        tally::costly();
        let mut x = self.in_units(rhs);
        match &self.solver {
            Solver::Nothing => {}
            Solver::Cholesky(factor) => factor.solve(&mut x)?,
            Solver::Singular(solver) => x = solver.solve(&x)?,
        }
        Ok(self.in_units(&x))
    }

    /// `x += N N'b`, N the kernel of `W_F`: the part of b along free motions.
    pub fn add_free_part(&self, b: &[f64], x: &mut [f64]) {
        if let Some(solver) = self.singular() {
            solver.add_kernel_part(1.0, b, x);
        }
    }

    /// Dimension of the kernel of `W_F`.
    pub fn deficiency(&self) -> usize {
        self.singular().map_or(0, ClusterInverse::deficiency)
    }

    /// T with `T'W_F T = I` for all motions that the face resists, r x rank; none if it resists all motions well.
    pub fn basis(&self) -> Option<Matrix> {
        let mut basis = self.singular()?.basis();
        basis.data.iter_mut().for_each(|v| *v /= self.unit);
        Some(basis)
    }

    /// Some motion is resisted so weakly (`WEAK`) that rounding of `G_F v` matters in `W_F+ G_F v`.
    pub fn is_weak(&self) -> bool {
        match &self.solver {
            Solver::Nothing => false,
            Solver::Cholesky(factor) => factor.smallest_pivot() < WEAK,
            Solver::Singular(solver) => solver.weak,
        }
    }

    pub fn singular(&self) -> Option<&ClusterInverse> {
        match &self.solver {
            Solver::Singular(solver) => Some(solver),
            _ => None,
        }
    }

    /// x / s
    fn in_units(&self, x: &[f64]) -> Vec<f64> {
        x.iter().map(|x| x / self.unit).collect()
    }
}
