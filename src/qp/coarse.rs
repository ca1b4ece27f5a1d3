//! The coarse space of a face: `W_F = G_F G_F'` over the rows F that are not held at their bound.

use crate::error::Result;
use crate::linalg::{Csr, Matrix, SpdSolver};

pub struct Coarse<'a> {
    /// `G'`, m x r.
    g_transposed: &'a Csr,
    /// Diagonal of the whole `G G'`, 1 where it vanishes.
    pub scale: Vec<f64>,
    face: Option<Face>,
    pub solves: usize,
}

struct Face {
    held: Vec<bool>,
    w: Matrix,
    solver: SpdSolver,
}

impl<'a> Coarse<'a> {
    pub fn new(g_transposed: &'a Csr) -> Self {
        let mut scale = vec![0.0; g_transposed.cols];
        for (&k, v) in g_transposed.col.iter().zip(&g_transposed.val) {
            scale[k] += v * v;
        }
        scale.iter_mut().filter(|s| **s == 0.0).for_each(|s| *s = 1.0);
        Self { g_transposed, scale, face: None, solves: 0 }
    }

    /// Dimension r of the coarse space.
    pub fn dimension(&self) -> usize {
        self.g_transposed.cols
    }

    /// Factorises `W_F` of the rows that are not held, unless they are those of the last call.
    pub fn select(&mut self, held: &[bool]) -> Result<()> {
        if self.face.as_ref().is_some_and(|face| face.held == held) {
            return Ok(());
        }
        let w = self.gram(held)?;
        let solver = SpdSolver::new(&w, &self.scale)?;
        self.face = Some(Face { held: held.to_vec(), w, solver });
        Ok(())
    }

    fn gram(&self, held: &[bool]) -> Result<Matrix> {
        let r = self.dimension();
        let mut w = Matrix::zeros(r, r)?;
        for i in (0..held.len()).filter(|&i| !held[i]) {
            for (k, a) in self.g_transposed.row(i) {
                for (l, b) in self.g_transposed.row(i) {
                    w.data[k + l * r] += a * b;
                }
            }
        }
        Ok(w)
    }

    /// `W_F+ rhs` on the selected face.
    pub fn solve(&mut self, rhs: &[f64]) -> Vec<f64> {
        self.solves += 1;
        self.face.as_ref().map_or_else(|| vec![0.0; rhs.len()], |face| face.solver.solve(rhs))
    }

    /// Dimension of the kernel of `W_F` on the selected face.
    pub fn deficiency(&self) -> usize {
        self.face.as_ref().map_or(self.dimension(), |face| face.solver.deficiency())
    }

    /// `W_F^-1 rhs`, or `(W_F + 1e-8 diag W)^-1 rhs` where W_F is singular.
    pub fn solve_regularised(&mut self, rhs: &[f64]) -> Result<Vec<f64>> {
        const WEIGHT: f64 = 1e-8;
        let Some(face) = self.face.as_ref().filter(|face| face.solver.deficiency() > 0) else {
            return Ok(self.solve(rhs));
        };
        let mut w = face.w.clone();
        for (k, s) in self.scale.iter().enumerate() {
            w.data[k + k * w.rows] += WEIGHT * s;
        }
        self.solves += 1;
        Ok(SpdSolver::new(&w, &self.scale)?.solve(rhs))
    }

    /// `G x`
    pub fn image(&self, x: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; self.dimension()];
        self.g_transposed.mul_transposed_add(1.0, x, &mut image);
        image
    }

    /// `v <- P_F v`: held entries to zero, then `v_F - G_F' W_F+ G_F v_F`.
    pub fn project(&mut self, held: &[bool], v: &mut [f64]) -> Result<()> {
        v.iter_mut().zip(held).filter(|(_, held)| **held).for_each(|(v, _)| *v = 0.0);
        if self.dimension() == 0 {
            return Ok(());
        }
        self.select(held)?;
        let image = self.image(v);
        let alpha = self.solve(&image);
        for i in (0..v.len()).filter(|&i| !held[i]) {
            v[i] -= self.g_transposed.row_dot(i, &alpha);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_projected_vector_lies_on_the_face_and_in_the_kernel_of_g() {
        let mut g_transposed = Csr::empty(1);
        for v in [1.0, 2.0, -1.0, 3.0] {
            g_transposed.push_row([(0, v)]);
        }
        let mut coarse = Coarse::new(&g_transposed);
        let mut v = [1.0, 1.0, 1.0, 1.0];
        coarse.project(&[false, true, false, false], &mut v).unwrap();
        assert_eq!(v[1], 0.0);
        assert!(coarse.image(&v)[0].abs() < 1e-15);
        let before = v;
        coarse.project(&[false, true, false, false], &mut v).unwrap();
        assert!(v.iter().zip(&before).all(|(a, b)| (a - b).abs() < 1e-15), "a projection repeats itself");
    }
}
