//! The coarse space of a face: `W_F = G_F G_F'` over the rows F that are not held at their bound, r x r and
//! sparse. Its pattern is analysed once for all faces.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::gram::Gram;
use crate::linalg::memory::room;
use crate::linalg::pseudo::{Pseudo, SINGULAR};
use crate::linalg::{Analysis, Cholesky, Csr, Matrix, Symmetric};

pub struct Coarse<'a> {
    /// `G'`, m x r.
    g_transposed: &'a Csr,
    /// Square roots of the diagonal of the whole `G G'`, 1 where it vanishes: W is scaled by them, so that
    /// modes of stiff and of soft bodies count alike.
    root: Vec<f64>,
    gram: Option<(Gram, Arc<Analysis>)>,
    /// The face of all rows, and the last other one.
    faces: [Option<Face>; 2],
    selected: usize,
    pub solves: usize,
    pub factorisations: usize,
}

struct Face {
    held: Vec<bool>,
    /// `D^-1/2 W_F D^-1/2`
    w: Symmetric,
    solver: Solver,
}

enum Solver {
    Cholesky(Cholesky),
    /// Minimum norm.
    Pseudo(Pseudo),
}

impl<'a> Coarse<'a> {
    pub fn new(g_transposed: &'a Csr) -> Result<Self> {
        let mut root = vec![0.0; g_transposed.cols];
        for (&k, v) in g_transposed.col.iter().zip(&g_transposed.val) {
            root[k] += v * v;
        }
        root.iter_mut().for_each(|s| *s = if *s > 0.0 { s.sqrt() } else { 1.0 });
        let gram = if root.is_empty() { None } else { Some(analysed(g_transposed)?) };
        let faces = [None, None];
        Ok(Self { g_transposed, root, gram, faces, selected: 0, solves: 0, factorisations: 0 })
    }

    /// Dimension r of the coarse space.
    pub fn dimension(&self) -> usize {
        self.root.len()
    }

    /// `D_kk`: diagonal entry of the whole `G G'`, 1 where it vanishes.
    pub fn weight(&self, k: usize) -> f64 {
        self.root[k] * self.root[k]
    }

    /// Factorises `W_F` of the rows that are not held, unless that has just been done.
    pub fn select(&mut self, held: &[bool]) -> Result<()> {
        let Some((gram, analysis)) = &self.gram else { return Ok(()) };
        self.selected = usize::from(held.contains(&true));
        let slot = &mut self.faces[self.selected];
        if slot.as_ref().is_some_and(|face| face.held == held) {
            return Ok(());
        }
        let mut w = gram.sum(self.g_transposed, held)?;
        for k in 0..w.order() {
            for at in w.ptr[k]..w.ptr[k + 1] {
                w.val[at] /= self.root[k] * self.root[w.col[at] as usize];
            }
        }
        let solver = match analysis.attempt(&w, 1.0)? {
            Ok(factor) if factor.smallest_pivot() > SINGULAR => Solver::Cholesky(factor),
            _ => Solver::Pseudo(Pseudo::new(&w, analysis)?),
        };
        self.factorisations += 1;
        *slot = Some(Face { held: held.to_vec(), w, solver });
        Ok(())
    }

    /// `W_F+ rhs` on the selected face.
    pub fn solve(&mut self, rhs: &[f64]) -> Result<Vec<f64>> {
        self.solves += 1;
        let Some(face) = &self.faces[self.selected] else { return Ok(vec![0.0; rhs.len()]) };
        let mut x = self.scaled(rhs);
        match &face.solver {
            Solver::Cholesky(factor) => factor.solve(&mut x)?,
            Solver::Pseudo(solver) => x = solver.solve(&x)?,
        }
        Ok(self.scaled(&x))
    }

    /// `W_F^-1 rhs`, or `(W_F + 1e-8 diag W)^-1 rhs` where W_F is singular.
    pub fn solve_regularised(&mut self, rhs: &[f64]) -> Result<Vec<f64>> {
        const WEIGHT: f64 = 1e-8;
        let (Some(face), Some((_, analysis))) = (&self.faces[self.selected], &self.gram) else {
            return Ok(vec![0.0; rhs.len()]);
        };
        if matches!(face.solver, Solver::Cholesky(_)) {
            return self.solve(rhs);
        }
        let mut w = face.w.clone();
        for k in 0..w.order() {
            w.val[w.ptr[k + 1] - 1] += WEIGHT;
        }
        let Ok(factor) = analysis.attempt(&w, 1.0)? else { return self.solve(rhs) };
        let mut x = self.scaled(rhs);
        factor.solve(&mut x)?;
        self.solves += 1;
        self.factorisations += 1;
        Ok(self.scaled(&x))
    }

    /// `D^-1/2 x`
    fn scaled(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.root).map(|(x, root)| x / root).collect()
    }

    /// Dimension of the kernel of `W_F` on the selected face.
    pub fn deficiency(&self) -> usize {
        match &self.faces[self.selected] {
            Some(Face { solver: Solver::Pseudo(solver), .. }) => solver.deficiency(),
            _ => 0,
        }
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
        let alpha = self.solve(&image)?;
        for i in (0..v.len()).filter(|&i| !held[i]) {
            v[i] -= self.g_transposed.row_dot(i, &alpha);
        }
        Ok(())
    }
}

/// Basis of all a with `G_F'a = 0` on the rows that are not held, r x deficiency: motions that these rows do not resist.
pub fn undetermined(g_transposed: &Csr, held: &[bool]) -> Result<Matrix> {
    const ROUNDING: f64 = 1e-9;
    let mut coarse = Coarse::new(g_transposed)?;
    coarse.select(held)?;
    let Some(Face { solver: Solver::Pseudo(solver), .. }) = &coarse.faces[coarse.selected] else {
        return Matrix::zeros(coarse.dimension(), 0);
    };
    let _room = room(4 * size_of::<f64>() * coarse.dimension() * solver.deficiency(), "open motions")?;
    let mut kernel = solver.kernel();
    for j in 0..kernel.cols {
        kernel.col_mut(j).iter_mut().zip(&coarse.root).for_each(|(v, root)| *v /= root);
    }
    Ok(kernel.reduced(ROUNDING))
}

fn analysed(g_transposed: &Csr) -> Result<(Gram, Arc<Analysis>)> {
    let gram = Gram::of(g_transposed)?;
    let analysis = Analysis::new(gram.pattern(), &vec![false; g_transposed.cols])?;
    Ok((gram, Arc::new(analysis)))
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
        let mut coarse = Coarse::new(&g_transposed).unwrap();
        let mut v = [1.0, 1.0, 1.0, 1.0];
        coarse.project(&[false, true, false, false], &mut v).unwrap();
        assert_eq!(v[1], 0.0);
        assert!(coarse.image(&v)[0].abs() < 1e-15);
        let before = v;
        coarse.project(&[false, true, false, false], &mut v).unwrap();
        assert!(v.iter().zip(&before).all(|(a, b)| (a - b).abs() < 1e-15), "a projection repeats itself");
    }

    #[test]
    fn a_face_without_a_mode_has_a_kernel_and_its_solution_minimum_norm() {
        let mut g_transposed = Csr::empty(2);
        g_transposed.push_row([(0, 1.0), (1, 1.0)]);
        g_transposed.push_row([(0, 1.0), (1, -1.0)]);
        let mut coarse = Coarse::new(&g_transposed).unwrap();
        coarse.select(&[false, true]).unwrap();
        assert_eq!(coarse.deficiency(), 1);
        let x = coarse.solve(&[1.0, 1.0]).unwrap();
        assert!((x[0] - 0.5).abs() < 1e-14 && (x[1] - 0.5).abs() < 1e-14);
        let free = undetermined(&g_transposed, &[false, true]).unwrap();
        assert_eq!((free.rows, free.cols), (2, 1));
        assert!((free.get(0, 0) + free.get(1, 0)).abs() < 1e-14 && free.get(0, 0).abs() == 1.0);
        assert_eq!(undetermined(&g_transposed, &[false, false]).unwrap().cols, 0);
        assert_eq!(undetermined(&g_transposed, &[true, true]).unwrap().data, [1.0, 0.0, 0.0, 1.0]);
    }
}
