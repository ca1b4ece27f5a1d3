//! The coarse space of a face: `W_F = G_F G_F'` over the rows F that are not held at their bound, r x r and
//! sparse. Its pattern is analysed once for all faces.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::semidefinite::sparse::{FaceRows, PseudoInverse, SINGULAR};
use crate::linalg::sparse::gram::Gram;
use crate::linalg::vector::{axpy, norm_max, power_of_two_below};
use crate::linalg::{Analysis, Cholesky, Csr, Matrix};
use crate::platform::memory::headroom;

pub struct Coarse<'a> {
    /// `G'`, m x r.
    g_transposed: &'a Csr,
    /// A motion a is free when `|G_F a| <= rounding |G| |a|`.
    rounding: f64,
    /// The power of two s that W is divided by twice.
    unit: f64,
    /// Diagonal of the whole `G G' / s^2`: the largest entry in [1, 4).
    whole: Vec<f64>,
    gram: Option<(Gram, Arc<Analysis>)>,
    /// The face of all rows, and the last other one.
    faces: [Option<CoarseFace>; 2],
    pub solves: usize,
    pub factorisations: usize,
}

struct CoarseFace {
    held: Vec<bool>,
    solver: Solver,
}

enum Solver {
    Cholesky(Cholesky),
    /// Minimum norm.
    Pseudo(PseudoInverse),
}

impl<'a> Coarse<'a> {
    /// The rows of G of stiff and of soft bodies are of one size; `rounding` is how far they are known against it.
    pub fn new(g_transposed: &'a Csr, rounding: f64) -> Result<Self> {
        let mut whole = vec![0.0; g_transposed.cols];
        for (&k, v) in g_transposed.col.iter().zip(&g_transposed.val) {
            whole[k] += v * v;
        }
        let unit = power_of_two_below(norm_max(&whole).sqrt());
        whole.iter_mut().for_each(|v| *v /= unit * unit);
        let gram = if whole.is_empty() { None } else { Some(analysed(g_transposed)?) };
        let faces = [None, None];
        Ok(Self { g_transposed, rounding, unit, whole, gram, faces, solves: 0, factorisations: 0 })
    }

    /// Dimension r of the coarse space.
    pub fn dimension(&self) -> usize {
        self.whole.len()
    }

    /// The space on the rows that are not held: `W_F` is factorised, unless that has just been done.
    pub fn on(&mut self, held: &[bool]) -> Result<OnFace<'_>> {
        let selected = usize::from(held.contains(&true));
        if let Some((gram, analysis)) = &self.gram {
            if self.faces[selected].as_ref().is_none_or(|face| face.held != held) {
                let mut w = gram.sum(self.g_transposed, held)?;
                w.val.iter_mut().for_each(|v| *v /= self.unit * self.unit);
                let (unit, whole, rounding) = (self.unit, &self.whole[..], self.rounding);
                let rows = FaceRows { g_transposed: self.g_transposed, held, unit, whole, rounding };
                let solver = match analysis.attempt(&w, 1.0)? {
                    Ok(factor) if factor.smallest_pivot() > SINGULAR => Solver::Cholesky(factor),
                    _ => Solver::Pseudo(PseudoInverse::new(&w, analysis, &rows)?),
                };
                self.factorisations += 1;
                self.faces[selected] = Some(CoarseFace { held: held.to_vec(), solver });
            }
        }
        let solver = self.faces[selected].as_ref().map(|face| &face.solver);
        Ok(OnFace { unit: self.unit, solver, solves: &mut self.solves })
    }

    /// `argmin |v_F - G_F'alpha|`, alpha of minimum norm.
    pub fn multiplier(&mut self, held: &[bool], v: &[f64]) -> Result<Vec<f64>> {
        /// Rounding of `G_F v` is large against what weakly held motions have of it; of what is left of v it is not.
        const PASSES: usize = 3;
        let mut rest: Vec<f64> = v.iter().zip(held).map(|(v, held)| if *held { 0.0 } else { *v }).collect();
        let (g_transposed, dimension) = (self.g_transposed, self.dimension());
        let image = |x: &[f64]| {
            let mut image = vec![0.0; dimension];
            g_transposed.mul_transposed_add(1.0, x, &mut image);
            image
        };
        let mut face = self.on(held)?;
        let mut alpha = face.solve(&image(&rest))?;
        for _ in 1..if face.is_weak() { PASSES } else { 1 } {
            for i in (0..v.len()).filter(|&i| !held[i]) {
                rest[i] = v[i] - g_transposed.row_dot(i, &alpha);
            }
            axpy(1.0, &face.solve(&image(&rest))?, &mut alpha);
        }
        Ok(alpha)
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
        let alpha = self.multiplier(held, v)?;
        for i in (0..v.len()).filter(|&i| !held[i]) {
            v[i] -= self.g_transposed.row_dot(i, &alpha);
        }
        Ok(())
    }
}

/// The coarse space on one face.
pub struct OnFace<'c> {
    unit: f64,
    /// None where there are no modes.
    solver: Option<&'c Solver>,
    solves: &'c mut usize,
}

impl OnFace<'_> {
    /// `W_F+ rhs`
    pub fn solve(&mut self, rhs: &[f64]) -> Result<Vec<f64>> {
        *self.solves += 1;
        let Some(solver) = self.solver else { return Ok(vec![0.0; rhs.len()]) };
        let mut x = self.in_units(rhs);
        match solver {
            Solver::Cholesky(factor) => factor.solve(&mut x)?,
            Solver::Pseudo(solver) => x = solver.solve(&x)?,
        }
        Ok(self.in_units(&x))
    }

    /// `W_F^-1 rhs`, or `(W_F + 1e-8 N N')^-1 rhs` where W_F has the kernel N.
    pub fn solve_regularised(&mut self, rhs: &[f64]) -> Result<Vec<f64>> {
        const WEIGHT: f64 = 1e-8;
        let mut x = self.solve(rhs)?;
        if let Some(solver) = self.pseudo() {
            solver.add_kernel_part(1.0 / (WEIGHT * self.unit * self.unit), rhs, &mut x);
        }
        Ok(x)
    }

    /// Dimension of the kernel of `W_F`.
    pub fn deficiency(&self) -> usize {
        self.pseudo().map_or(0, PseudoInverse::deficiency)
    }

    /// T with `T'W_F T = I` on all that the face resists, r x rank, where it does not resist all motions well.
    pub fn basis(&self) -> Option<Matrix> {
        let mut basis = self.pseudo()?.basis();
        basis.data.iter_mut().for_each(|v| *v /= self.unit);
        Some(basis)
    }

    /// Some motions are held so weakly that rounding of `G_F v` matters in `W_F+ G_F v`.
    fn is_weak(&self) -> bool {
        self.pseudo().is_some_and(|solver| solver.weak)
    }

    fn pseudo(&self) -> Option<&PseudoInverse> {
        match self.solver {
            Some(Solver::Pseudo(solver)) => Some(solver),
            _ => None,
        }
    }

    /// x / s
    fn in_units(&self, x: &[f64]) -> Vec<f64> {
        x.iter().map(|x| x / self.unit).collect()
    }
}

/// Basis of the free motions, `|G_F a| <= rounding |G| |a|`, r x deficiency: what the rows that are not held do not resist.
pub fn undetermined(g_transposed: &Csr, held: &[bool], rounding: f64) -> Result<Matrix> {
    /// Entries of a basis vector below this, in units of `rounding`, are rounding.
    const DROP: f64 = 16.0;
    let mut coarse = Coarse::new(g_transposed, rounding)?;
    let (dimension, face) = (coarse.dimension(), coarse.on(held)?);
    let Some(solver) = face.pseudo() else { return Matrix::zeros(dimension, 0) };
    let _room = headroom(4 * size_of::<f64>() * dimension * solver.deficiency(), "open motions")?;
    Ok(solver.kernel().reduced(DROP * rounding))
}

/// `argmin |r_F - G_F'alpha|` on the rows that are not held, alpha of minimum norm.
pub fn fitted(g_transposed: &Csr, held: &[bool], r: &[f64], rounding: f64) -> Result<Vec<f64>> {
    Coarse::new(g_transposed, rounding)?.multiplier(held, r)
}

fn analysed(g_transposed: &Csr) -> Result<(Gram, Arc<Analysis>)> {
    let gram = Gram::of(g_transposed)?;
    let analysis = Analysis::new(gram.pattern(), &vec![false; g_transposed.cols])?;
    Ok((gram, Arc::new(analysis)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::random::scattered;
    use crate::linalg::vector::{dot, norm};

    #[test]
    fn the_projected_vector_lies_on_the_face_and_in_the_kernel_of_g() {
        let mut g_transposed = Csr::empty(1);
        for v in [1.0, 2.0, -1.0, 3.0] {
            g_transposed.push_row([(0, v)]);
        }
        let mut coarse = Coarse::new(&g_transposed, 1e-14).unwrap();
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
        let mut coarse = Coarse::new(&g_transposed, 1e-14).unwrap();
        let mut face = coarse.on(&[false, true]).unwrap();
        assert_eq!(face.deficiency(), 1);
        let x = face.solve(&[1.0, 1.0]).unwrap();
        assert!((x[0] - 0.5).abs() < 1e-14 && (x[1] - 0.5).abs() < 1e-14);
        let free = undetermined(&g_transposed, &[false, true], 1e-14).unwrap();
        assert_eq!((free.rows, free.cols), (2, 1));
        assert!((free.get(0, 0) + free.get(1, 0)).abs() < 1e-14 && free.get(0, 0).abs() == 1.0);
        assert_eq!(undetermined(&g_transposed, &[false, false], 1e-14).unwrap().cols, 0);
        assert_eq!(undetermined(&g_transposed, &[true, true], 1e-14).unwrap().data, [1.0, 0.0, 0.0, 1.0]);
    }

    /// Numbers in [-1/2, 1/2) and an orthogonal matrix.
    fn random() -> impl FnMut() -> f64 {
        let mut numbers = scattered(100_000).into_iter();
        move || numbers.next().unwrap()
    }

    fn orthogonal(n: usize, next: &mut impl FnMut() -> f64) -> Matrix {
        let data = (0..n * n).map(|_| next()).collect();
        Matrix { rows: n, cols: n, data }.orthonormalised(0.0)
    }

    /// Rows of `G' T`, |G T|_F = 1.
    fn turned(rows: &[[f64; 6]], t: &Matrix) -> Csr {
        let size = rows.iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
        let mut g_transposed = Csr::empty(6);
        for row in rows {
            g_transposed.push_row((0..6).map(|k| (k, dot(row, t.col(k)) / size)));
        }
        g_transposed
    }

    /// A flat contact resists one translation and two rotations; the others by `weak` of that.
    fn flat(weak: [f64; 3], next: &mut impl FnMut() -> f64) -> Vec<[f64; 6]> {
        (0..300)
            .map(|_| [next(), 1.0, next(), weak[0] * next(), weak[1] * next(), weak[2] * next()])
            .collect()
    }

    /// As many columns of T' are free as `weak` has zeros, and `free` spans them to `accuracy`.
    fn assert_free(g_transposed: &Csr, rounding: f64, t: &Matrix, expected: &[usize], accuracy: f64) {
        let held = vec![false; g_transposed.rows()];
        let free = undetermined(g_transposed, &held, rounding).unwrap();
        let mut coarse = Coarse::new(g_transposed, rounding).unwrap();
        let face = coarse.on(&held).unwrap();
        assert_eq!((free.cols, face.deficiency()), (expected.len(), expected.len()));
        for j in 0..free.cols {
            let mut original = vec![0.0; 6];
            t.mul_add(1.0, free.col(j), &mut original);
            for k in (0..6).filter(|k| !expected.contains(k)) {
                assert!(original[k].abs() <= accuracy * norm(&original), "{k}: {original:?}");
            }
        }
    }

    #[test]
    fn a_flat_contact_leaves_three_motions_free_however_the_modes_are_mixed_and_known() {
        let mut next = random();
        for mixed in 0..6 {
            let rows = flat([0.0; 3], &mut next);
            let mut t = Matrix::zeros(6, 6).unwrap();
            (0..6).for_each(|k| t.set(k, k, 1.0));
            match mixed {
                0 => {}
                1 | 2 => t = orthogonal(6, &mut next),
                3 => t.data.iter_mut().for_each(|v| *v += 1e-9 * next()),
                _ => t.data.iter_mut().for_each(|v| *v += next()),
            }
            let mut g_transposed = turned(&rows, &t);
            assert_free(&g_transposed, 1.5e-14, &t, &[3, 4, 5], 1e-12);
            let size = norm_max(&g_transposed.val);
            g_transposed.val.iter_mut().for_each(|v| *v += 1e-12 * size * next());
            assert_free(&g_transposed, 1e-12, &t, &[3, 4, 5], 1e-10);
        }
    }

    #[test]
    fn a_motion_that_is_resisted_by_little_is_resisted_and_its_forces_are_found() {
        let mut next = random();
        for weak in [1e-5, 1e-7, 1e-10] {
            let rows = flat([weak, 0.0, weak], &mut next);
            let t = orthogonal(6, &mut next);
            let g_transposed = turned(&rows, &t);
            assert_free(&g_transposed, 1.5e-14, &t, &[4], 1e-3 * 1e-12 / weak);
            // nothing is left of G'alpha, though rounding of G G'alpha is large against the weak part of it
            let mut coarse = Coarse::new(&g_transposed, 1.5e-14).unwrap();
            let alpha = [1.0, -2.0, 0.5, 3.0, 1.0, 0.1];
            let mut v: Vec<f64> = (0..300).map(|i| g_transposed.row_dot(i, &alpha)).collect();
            coarse.project(&[false; 300], &mut v).unwrap();
            assert!(norm(&v) < 1e-14, "{weak}: {:e}", norm(&v));
            assert!((0..100).all(|i| coarse.image(&v)[i % 6].abs() < 1e-15));
        }
    }

    #[test]
    fn rows_that_are_rounding_alone_hold_nothing() {
        let mut next = random();
        let mut rows = flat([0.0; 3], &mut next);
        rows.iter_mut().skip(10).for_each(|row| row.iter_mut().for_each(|v| *v *= 1e-16));
        let mut t = Matrix::zeros(6, 6).unwrap();
        (0..6).for_each(|k| t.set(k, k, 1.0));
        let g_transposed = turned(&rows, &t);
        let held: Vec<bool> = (0..300).map(|i| i < 10).collect();
        assert_eq!(undetermined(&g_transposed, &held, 1.5e-14).unwrap().cols, 6);
    }

    /// Two blocks in a flat contact, the lower one on the ground by few rows; modes of the stiff one divided by one number.
    #[test]
    fn a_body_a_million_times_stiffer_counts_alike() {
        let mut next = random();
        let (t, u) = (orthogonal(6, &mut next), orthogonal(6, &mut next));
        let between = flat([0.0; 3], &mut next);
        for stiffer in [1.0, 1e6] {
            let size = (between.iter().flatten().map(|v| v * v).sum::<f64>()).sqrt();
            let mut g_transposed = Csr::empty(12);
            let soft = |row: &[f64; 6], by: f64, t: &Matrix| -> Vec<f64> {
                (0..6).map(|k| by * dot(row, t.col(k)) / size).collect()
            };
            for row in &between {
                let of_stiff = soft(row, 1.0 / stiffer, &u);
                let scaled = of_stiff.iter().map(|v| -v * stiffer);
                g_transposed.push_row(soft(row, 1.0, &t).into_iter().chain(scaled).enumerate());
            }
            (0..6).for_each(|k| g_transposed.push_row([(6 + k, 0.1)]));
            let rows = g_transposed.rows();
            assert_eq!(undetermined(&g_transposed, &vec![false; rows], 1.5e-14).unwrap().cols, 3);
            let ground: Vec<bool> = (0..rows).map(|i| i >= 300).collect();
            assert_eq!(undetermined(&g_transposed, &ground, 1.5e-14).unwrap().cols, 9);
        }
    }
}
