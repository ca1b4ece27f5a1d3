//! The coarse space of a face: `W_F = G_F G_F'` over the rows F that are not held at their bound, r x r and sparse. Its
//! pattern is analysed once for all faces, and the part that they share is factorised once.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::semidefinite::clusters::Blocks;
use crate::linalg::semidefinite::sparse::{FaceRows, PseudoInverse, WEAK};
use crate::linalg::semidefinite::{is_regular_factor, GeneralInverse};
use crate::linalg::vector::{axpy, norm, norm_max};
use crate::linalg::{Cholesky, Csr, Matrix, Runs};
use crate::platform::memory::headroom;
use crate::platform::{interrupt, tally};
use crate::qp::between_solves::{BetweenSolves, Space};
use crate::qp::{Qp, Rung};

pub struct Coarse<'a> {
    /// `G'`, m x r.
    g_transposed: &'a Csr,
    blocks: &'a [usize],
    /// A motion a is free if `|G_F a| <= rounding |G| |a|`.
    rounding: f64,
    space: Space,
    /// Receives the space when this is dropped.
    kept: Option<&'a BetweenSolves>,
    /// The last face solved by blocks had free motions: the next face is likely to have some.
    left_free: bool,
    /// The face of all rows, and the last other face.
    faces: [Option<CoarseFace>; 2],
    pub solves: usize,
    pub factorisations: usize,
}

struct CoarseFace {
    held: Vec<bool>,
    solver: Solver,
}

enum Solver {
    Cholesky {
        factor: Arc<Cholesky>,
        /// Some motion is resisted weakly: see `WEAK`.
        weak: bool,
    },
    /// Solution of minimum norm.
    Singular(Box<dyn GeneralInverse>),
}

impl<'a> Coarse<'a> {
    /// The space of a problem; the rows of G of stiff and soft bodies have similar size.
    pub fn of(qp: &Qp<'a>) -> Result<Self> {
        let kept = qp.kept.and_then(|kept| kept.take_space(qp.g_transposed, qp.bounded));
        let space = kept.map_or_else(|| Space::new(qp.g_transposed, qp.bounded), Ok)?;
        let mut coarse = Self::on_space(space, qp.g_transposed, qp.blocks, qp.rounding);
        coarse.kept = qp.kept;
        Ok(coarse)
    }

    /// `rounding`: accuracy of the rows of G relative to their size.
    fn on_space(space: Space, g_transposed: &'a Csr, blocks: &'a [usize], rounding: f64) -> Self {
        Self {
            g_transposed,
            blocks,
            rounding,
            space,
            kept: None,
            left_free: false,
            faces: [None, None],
            solves: 0,
            factorisations: 0,
        }
    }

    /// `G'`
    pub fn rows(&self) -> &Runs {
        &self.space.rows
    }

    /// Dimension r of the coarse space.
    pub fn dimension(&self) -> usize {
        self.space.whole.len()
    }

    /// The largest diagonal entry of `G G'`.
    pub fn largest(&self) -> f64 {
        self.space.unit * self.space.unit * norm_max(&self.space.whole)
    }

    /// The space on the rows that are not held: factorises `W_F` if it is not the last face, unless the host or the time
    /// limit forbids it.
    pub fn on(&mut self, held: &[bool]) -> Result<OnFace<'_>> {
        let selected = usize::from(held.contains(&true));
        if self.space.factors.is_some() && self.faces[selected].as_ref().is_none_or(|face| face.held != held)
        {
            interrupt::check()?;
            tally::costly();
            self.faces[selected] = None;
            self.faces[selected] = Some(CoarseFace { held: held.to_vec(), solver: self.solver(held)? });
            self.factorisations += 1;
        }
        let solver = self.faces[selected].as_ref().map(|face| &face.solver);
        Ok(OnFace { unit: self.space.unit, solver, solves: &mut self.solves })
    }

    /// `G D G' + rho I`, D = diag(`weights`) >= 0; none if there are no modes or the weights resist some mode too little.
    pub fn weighted(&mut self, weights: &[f64], rho: f64) -> Result<Option<Weighted>> {
        /// Added part of the diagonal entry in `G G'`, for motions that only rows with vanishing weights resist.
        const HELD: f64 = 1e-10;
        let Space { factors: Some(factors), unit, whole, .. } = &self.space else { return Ok(None) };
        interrupt::check()?;
        tally::costly();
        let mut w = factors.gram().weighted(self.g_transposed, |i| weights[i])?;
        w.val.iter_mut().for_each(|v| *v /= unit * unit);
        for (k, whole) in whole.iter().enumerate() {
            let held = if *whole > 0.0 { HELD * whole } else { 1.0 };
            w.val[w.ptr[k + 1] - 1] += rho / (unit * unit) + held;
        }
        self.factorisations += 1;
        let factor = factors.analysis().attempt(&w, 1.0)?.ok();
        Ok(factor.map(|factor| Weighted { factor, unit: *unit }))
    }

    /// `W_F^-1`, or W_F+ if some motions are free or resisted weakly: by dense parts if these are small.
    fn solver(&mut self, held: &[bool]) -> Result<Solver> {
        let (g_transposed, rounding) = (self.g_transposed, self.rounding);
        let Space { unit, whole, factors, bounded, by_blocks, .. } = &mut self.space;
        let (unit, whole) = (*unit, &whole[..]);
        if let Some(factors) = factors.as_mut().filter(|_| !self.left_free) {
            let by = 1.0 / (unit * unit);
            if let Ok(factor) = factors.factor(g_transposed, held, (by, 0.0), |_| ())? {
                if is_regular_factor(&factor)? {
                    let weak = factor.smallest_pivot() < WEAK;
                    return Ok(Solver::Cholesky { factor, weak });
                }
            }
            let mut w = factors.gram().sum(g_transposed, held)?;
            w.val.iter_mut().for_each(|v| *v *= by);
            let rows = FaceRows { g_transposed, held, unit, whole, rounding };
            if Rung::SparseInverse.is_tried() {
                if let Some(inverse) = PseudoInverse::new(&w, factors.analysis(), &rows)? {
                    return Ok(Solver::Singular(Box::new(inverse)));
                }
            }
        }
        let mut known = match by_blocks.take() {
            Some(known) => known,
            None => Blocks::new(g_transposed, self.blocks, bounded, (unit, whole, rounding))?,
        };
        let inverse = known.inverse(held)?;
        self.left_free = inverse.deficiency() > 0;
        *by_blocks = Some(known);
        Ok(Solver::Singular(Box::new(inverse)))
    }

    /// `argmin |v_F - G_F'alpha|`, alpha of minimum norm.
    pub fn multiplier(&mut self, held: &[bool], v: &[f64]) -> Result<Vec<f64>> {
        Ok(self.fitted(held, v)?.0)
    }

    /// `alpha = argmin |v_F - G_F'alpha|` of minimum norm, and the remainder of v on F, 0 on the rows that are held.
    pub fn fitted(&mut self, held: &[bool], v: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        /// The rounding of `G_F v` is large relative to the part of weakly resisted motions; that of the remainder is
        /// not.
        const PASSES: usize = 3;
        /// Limit of the error: the residual `G_F (v - G'alpha)` times the inverse root of the smallest expected
        /// eigenvalue of W_F (the factor is r for a chain of r motions), relative to the remainder of v.
        const ERROR: f64 = 0.1;
        let amplified = self.dimension() as f64;
        let mut rest: Vec<f64> = v.iter().zip(held).map(|(v, held)| if *held { 0.0 } else { *v }).collect();
        let image = self.image(&rest);
        let mut alpha = self.on(held)?.solve(&image)?;
        for pass in 1.. {
            let image = self.space.rows.residual(held, v, &alpha, &mut rest);
            let unit = self.space.unit;
            let mut face = self.on(held)?;
            let known = !face.is_weak() && amplified * norm(&image) <= ERROR * unit * norm(&rest);
            if known || pass == PASSES || !Rung::Fit.is_tried() {
                break;
            }
            axpy(1.0, &face.solve(&image)?, &mut alpha);
        }
        Ok((alpha, rest))
    }

    /// `G x`
    pub fn image(&self, x: &[f64]) -> Vec<f64> {
        self.space.rows.mul_transposed(x)
    }

    /// `e - G x`
    pub fn left(&self, e: &[f64], x: &[f64]) -> Vec<f64> {
        self.space.rows.mul_transposed_add(-1.0, x, e.to_vec())
    }

    /// `|G||x|`
    pub fn terms(&self, x: &[f64]) -> Vec<f64> {
        self.space.rows.mul_transposed_abs(x)
    }

    /// `v <- P_F v`: sets held entries to zero, then `v_F - G_F' W_F+ G_F v_F`.
    pub fn project(&mut self, held: &[bool], v: &mut [f64]) -> Result<()> {
        if self.dimension() == 0 {
            v.iter_mut().zip(held).filter(|(_, held)| **held).for_each(|(v, _)| *v = 0.0);
        } else {
            v.copy_from_slice(&self.fitted(held, v)?.1);
        }
        Ok(())
    }
}

impl Drop for Coarse<'_> {
    fn drop(&mut self) {
        if let Some(kept) = self.kept {
            self.faces = [None, None];
            kept.keep(std::mem::take(&mut self.space));
        }
    }
}

/// `G D G' + rho I` over all rows.
pub struct Weighted {
    factor: Cholesky,
    unit: f64,
}

impl Weighted {
    pub fn solve(&self, rhs: &[f64]) -> Result<Vec<f64>> {
        interrupt::check()?;
        tally::costly();
        let mut x: Vec<f64> = rhs.iter().map(|x| x / self.unit).collect();
        self.factor.solve(&mut x)?;
        x.iter_mut().for_each(|x| *x /= self.unit);
        Ok(x)
    }
}

/// The coarse space on one face.
pub struct OnFace<'c> {
    unit: f64,
    /// None without modes.
    solver: Option<&'c Solver>,
    solves: &'c mut usize,
}

impl OnFace<'_> {
    /// `W_F+ rhs`
    pub fn solve(&mut self, rhs: &[f64]) -> Result<Vec<f64>> {
        *self.solves += 1;
        let Some(solver) = self.solver else { return Ok(vec![0.0; rhs.len()]) };
        interrupt::check()?;
        tally::costly();
        let mut x = self.in_units(rhs);
        match solver {
            Solver::Cholesky { factor, .. } => factor.solve(&mut x)?,
            Solver::Singular(solver) => x = solver.solve(&x)?,
        }
        Ok(self.in_units(&x))
    }

    /// `W_F^-1 rhs`, or `(W_F + 1e-8 N N')^-1 rhs` if W_F has the kernel N.
    pub fn solve_regularised(&mut self, rhs: &[f64]) -> Result<Vec<f64>> {
        const WEIGHT: f64 = 1e-8;
        let mut x = self.solve(rhs)?;
        if let Some(solver) = self.singular() {
            solver.add_kernel_part(1.0 / (WEIGHT * self.unit * self.unit), rhs, &mut x);
        }
        Ok(x)
    }

    /// `x += N N'b`, N the kernel of `W_F`: the part of b along free motions.
    pub fn add_free_part(&self, b: &[f64], x: &mut [f64]) {
        if let Some(solver) = self.singular() {
            solver.add_kernel_part(1.0, b, x);
        }
    }

    /// Dimension of the kernel of `W_F`.
    pub fn deficiency(&self) -> usize {
        self.singular().map_or(0, GeneralInverse::deficiency)
    }

    /// T with `T'W_F T = I` for all motions that the face resists, r x rank; none if it resists all motions well.
    pub fn basis(&self) -> Option<Matrix> {
        let mut basis = self.singular()?.basis();
        basis.data.iter_mut().for_each(|v| *v /= self.unit);
        Some(basis)
    }

    /// Some motions are resisted so weakly that rounding of `G_F v` matters in `W_F+ G_F v`.
    fn is_weak(&self) -> bool {
        match self.solver {
            Some(Solver::Cholesky { weak, .. }) => *weak,
            Some(Solver::Singular(solver)) => solver.is_weak(),
            None => false,
        }
    }

    fn singular(&self) -> Option<&dyn GeneralInverse> {
        match self.solver {
            Some(Solver::Singular(solver)) => Some(&**solver),
            _ => None,
        }
    }

    /// x / s
    fn in_units(&self, x: &[f64]) -> Vec<f64> {
        x.iter().map(|x| x / self.unit).collect()
    }
}

/// The coarse space on the face of an answer.
pub struct AnswerFace<'a> {
    coarse: Coarse<'a>,
    held: &'a [bool],
}

impl<'a> AnswerFace<'a> {
    /// `rounding`: accuracy of the rows of G.
    pub fn new(g_transposed: &'a Csr, blocks: &'a [usize], held: &'a [bool], rounding: f64) -> Result<Self> {
        // there will be no other face
        let space = Space::new(g_transposed, &vec![true; held.len()])?;
        Ok(Self { coarse: Coarse::on_space(space, g_transposed, blocks, rounding), held })
    }

    /// The face of a problem, with the data that methods have stored about the space.
    pub fn of(qp: &Qp<'a>, held: &'a [bool]) -> Result<Self> {
        Ok(Self { coarse: Coarse::of(qp)?, held })
    }

    /// Basis of the free motions, `|G_F a| <= rounding |G| |a|`, r x deficiency, which the rows that are not held do not
    /// resist.
    pub fn undetermined(&mut self) -> Result<Matrix> {
        /// Entries of a basis vector below this, in units of `rounding`, are rounding.
        const DROP: f64 = 16.0;
        let (dimension, rounding) = (self.coarse.dimension(), self.coarse.rounding);
        let face = self.coarse.on(self.held)?;
        let Some(solver) = face.singular() else { return Matrix::zeros(dimension, 0) };
        let _room = headroom(4 * size_of::<f64>() * dimension * solver.deficiency(), "open motions")?;
        Ok(solver.kernel().reduced(DROP * rounding))
    }

    /// The motion a without the part that the rows resist well: `a - (W_F + rho I)^-1 W_F a`.
    pub fn hardly_resisted(&mut self, a: &[f64]) -> Result<Vec<f64>> {
        /// rho, relative to the largest diagonal entry of `G G'`.
        const RHO: f64 = 1e-8;
        let (mut along, mut left) = (vec![0.0; self.held.len()], a.to_vec());
        self.coarse.g_transposed.mul(a, &mut along);
        along.iter_mut().zip(self.held).filter(|(_, held)| **held).for_each(|(v, _)| *v = 0.0);
        let weights: Vec<f64> = self.held.iter().map(|held| f64::from(u8::from(!held))).collect();
        let (image, rho) = (self.coarse.image(&along), RHO * self.coarse.largest());
        if let Some(weighted) = self.coarse.weighted(&weights, rho)? {
            axpy(-1.0, &weighted.solve(&image)?, &mut left);
        }
        Ok(left)
    }

    /// `argmin |r_F - G_F'alpha|` on the rows that are not held, alpha of minimum norm.
    pub fn fitted(&mut self, r: &[f64]) -> Result<Vec<f64>> {
        self.coarse.multiplier(self.held, r)
    }
}

#[cfg(test)]
mod tests;
