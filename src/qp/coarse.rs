//! The coarse space of a face: `W_F = G_F G_F'` over the rows F that are not held at their bound, r x r and sparse. Its
//! pattern is analysed once for all faces, and the part that they share is factorised once.

use crate::error::Result;
use crate::linalg::vector::{axpy, norm};
use crate::linalg::{Csr, Matrix, Runs};
use crate::numbers::linalg::{ROOT, SHIFT};
use crate::numbers::qp::{DROP, ERROR_OF_ALPHA};
use crate::platform::memory::headroom;
use crate::platform::{interrupt, tally};
use crate::qp::between_solves::BetweenSolves;
use crate::qp::space::{CoarseInverse, Space};
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
    /// The face of all rows, and the last other face.
    faces: [Option<CoarseFace>; 2],
    pub solves: usize,
    pub factorisations: usize,
}

struct CoarseFace {
    held: Vec<bool>,
    inverse: CoarseInverse,
}

impl<'a> Coarse<'a> {
    /// The space of a problem; the rows of G of stiff and soft bodies have similar size.
    pub fn of(qp: &Qp<'a>) -> Result<Self> {
        let kept = qp.kept.and_then(|kept| kept.take_space(qp.g_transposed, qp.bounded));
        let space =
            kept.map_or_else(|| Space::new(qp.g_transposed, qp.g_transposed, qp.bounded.to_vec()), Ok)?;
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
        self.space.largest()
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
            let inverse = self.space.inverse(self.g_transposed, self.blocks, held, self.rounding)?;
            self.faces[selected] = Some(CoarseFace { held: held.to_vec(), inverse });
            self.factorisations += 1;
        }
        let inverse = self.faces[selected].as_ref().map_or(&CoarseInverse::NOTHING, |face| &face.inverse);
        Ok(OnFace { inverse, solves: &mut self.solves })
    }

    /// `G D G' + rho I`, D = diag(`weights`) >= 0; none if there are no modes or the weights resist some mode too little.
    pub fn weighted(&mut self, weights: &[f64], rho: f64) -> Result<Option<CoarseInverse>> {
        self.factorisations += usize::from(self.dimension() > 0);
        let rho = rho / (self.space.unit * self.space.unit);
        let held = |whole: f64| rho + if whole > 0.0 { SHIFT * whole } else { 1.0 };
        self.space.weighted(self.g_transposed, |i| weights[i], held)
    }

    /// `alpha = argmin |v_F - G_F'alpha|` of minimum norm, and the remainder of v on F, 0 on the rows that are held.
    pub fn fitted(&mut self, held: &[bool], v: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        /// The rounding of `G_F v` is large relative to the part of weakly resisted motions; that of the remainder is
        /// not.
        const PASSES: usize = 3;
        let amplified = self.dimension() as f64;
        let mut rest: Vec<f64> = v.iter().zip(held).map(|(v, held)| if *held { 0.0 } else { *v }).collect();
        let image = self.image(&rest);
        let mut alpha = self.on(held)?.solve(&image)?;
        for pass in 1.. {
            let image = self.space.rows.residual(held, v, &alpha, &mut rest);
            let unit = self.space.unit;
            let mut face = self.on(held)?;
            let known = !face.is_weak() && amplified * norm(&image) <= ERROR_OF_ALPHA * unit * norm(&rest);
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

/// The coarse space on one face.
pub struct OnFace<'c> {
    inverse: &'c CoarseInverse,
    solves: &'c mut usize,
}

impl std::ops::Deref for OnFace<'_> {
    type Target = CoarseInverse;

    fn deref(&self) -> &CoarseInverse {
        self.inverse
    }
}

impl OnFace<'_> {
    /// `W_F+ rhs`, counted.
    pub fn solve(&mut self, rhs: &[f64]) -> Result<Vec<f64>> {
        *self.solves += 1;
        self.inverse.solve(rhs)
    }

    /// `W_F^-1 rhs`, or `(W_F + 1e-8 N N')^-1 rhs` if W_F has the kernel N.
    pub fn solve_regularised(&mut self, rhs: &[f64]) -> Result<Vec<f64>> {
        let mut x = self.solve(rhs)?;
        if let Some(solver) = self.singular() {
            solver.add_kernel_part(1.0 / (ROOT * self.unit * self.unit), rhs, &mut x);
        }
        Ok(x)
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
        let space = Space::new(g_transposed, g_transposed, vec![true; held.len()])?;
        Ok(Self { coarse: Coarse::on_space(space, g_transposed, blocks, rounding), held })
    }

    /// The face of a problem, with the data that methods have stored about the space.
    pub fn of(qp: &Qp<'a>, held: &'a [bool]) -> Result<Self> {
        Ok(Self { coarse: Coarse::of(qp)?, held })
    }

    /// Basis of the free motions, `|G_F a| <= rounding |G| |a|`, r x deficiency, which the rows that are not held do not
    /// resist.
    pub fn undetermined(&mut self) -> Result<Matrix> {
        let (dimension, rounding) = (self.coarse.dimension(), self.coarse.rounding);
        let face = self.coarse.on(self.held)?;
        let Some(solver) = face.singular() else { return Matrix::zeros(dimension, 0) };
        let _room = headroom(4 * size_of::<f64>() * dimension * solver.deficiency(), "open motions")?;
        Ok(solver.kernel().reduced(DROP * rounding))
    }

    /// The motion a without the part that the rows resist well: `a - (W_F + rho I)^-1 W_F a`.
    pub fn hardly_resisted(&mut self, a: &[f64]) -> Result<Vec<f64>> {
        let (mut along, mut left) = (vec![0.0; self.held.len()], a.to_vec());
        self.coarse.g_transposed.mul(a, &mut along);
        along.iter_mut().zip(self.held).filter(|(_, held)| **held).for_each(|(v, _)| *v = 0.0);
        let weights: Vec<f64> = self.held.iter().map(|held| f64::from(u8::from(!held))).collect();
        let (image, rho) = (self.coarse.image(&along), ROOT * self.coarse.largest());
        if let Some(weighted) = self.coarse.weighted(&weights, rho)? {
            axpy(-1.0, &weighted.solve(&image)?, &mut left);
        }
        Ok(left)
    }

    /// `G_F'W_F+ e`, the forces of least norm with the resultants e; 0 on the rows that are held.
    pub fn forces(&mut self, e: &[f64]) -> Result<Vec<f64>> {
        let mut x = vec![0.0; self.held.len()];
        self.coarse.g_transposed.mul(&self.coarse.on(self.held)?.solve(e)?, &mut x);
        x.iter_mut().zip(self.held).filter(|(_, held)| **held).for_each(|(x, _)| *x = 0.0);
        Ok(x)
    }

    /// `argmin |r_F - G_F'alpha|` on the rows that are not held, alpha of minimum norm.
    pub fn fitted(&mut self, r: &[f64]) -> Result<Vec<f64>> {
        Ok(self.coarse.fitted(self.held, r)?.0)
    }
}

#[cfg(test)]
mod tests;
