//! The motions of an island with negative stiffness, and how they affect each other on one face: P of `negative.rs`.

use crate::error::Result;
use crate::linalg::dense::spectrum::symmetric_eigen;
use crate::linalg::vector::norm_max;
use crate::linalg::Matrix;
use crate::numbers::solve::FREE_PART;
use crate::qp::{AnswerFace, Direct, Face, Qp};
use crate::setup::Ready;

/// The motions of an island with negative stiffness: modes, and square roots of the negative stiffness.
pub struct NegativeMotions {
    pub modes: Vec<usize>,
    roots: Vec<f64>,
}

/// How these motions affect each other on one face.
pub struct Feedback<'a> {
    pub face: Face<'a>,
    /// Eigenvalues of P, ascending, and its eigenvectors.
    rates: Vec<f64>,
    vectors: Matrix,
    /// `(S+ + G_F F_FF^-1 G_F')^-1 S-^1/2`, r x d, and the forces of these motions on the rows F.
    motions: Matrix,
    forces: Matrix,
}

impl NegativeMotions {
    pub fn of(ready: &Ready) -> Self {
        let negative = &ready.dual.negative;
        let modes = negative.iter().map(|(mode, _)| *mode).collect();
        Self { modes, roots: negative.iter().map(|(_, stiffness)| (-stiffness).sqrt()).collect() }
    }

    /// `S-^1/2 a`
    pub fn forced(&self, alpha: &[f64]) -> Vec<f64> {
        self.modes.iter().zip(&self.roots).map(|(&mode, root)| root * alpha[mode]).collect()
    }

    /// `S-^-1/2 b`
    pub fn amplitudes(&self, b: &[f64]) -> Vec<f64> {
        b.iter().zip(&self.roots).map(|(b, root)| b / root).collect()
    }

    /// `e + S-^1/2 b`
    pub fn resultants(&self, e: &[f64], b: &[f64]) -> Vec<f64> {
        let mut all = e.to_vec();
        self.modes.iter().zip(self.roots.iter().zip(b)).for_each(|(&mode, (root, b))| all[mode] += root * b);
        all
    }

    /// A motion with negative stiffness that the rows of a face do not resist.
    pub fn free(&self, qp: Qp, held: &[bool]) -> Result<Option<Vec<f64>>> {
        let free = AnswerFace::of(&qp, held)?.undetermined()?;
        let is_negative = |v: &[f64]| self.modes.iter().any(|&mode| v[mode].abs() > FREE_PART * norm_max(v));
        Ok((0..free.cols).map(|j| free.col(j)).find(|v| is_negative(v)).map(<[f64]>::to_vec))
    }
}

impl<'a> Feedback<'a> {
    /// None if the face is too large for dense factors.
    pub fn of(
        direct: Direct<'a>,
        qp: Qp<'a>,
        held: &[bool],
        negative: &NegativeMotions,
    ) -> Result<Option<Self>> {
        let rows: Vec<usize> = (0..held.len()).filter(|&i| !held[i]).collect();
        if rows.len() + qp.e.len() > direct.limit {
            return Ok(None);
        }
        let face = Face::new(qp, direct.entries, rows)?;
        face.map(|face| Self::on(face, qp.e.len(), negative)).transpose()
    }

    pub fn on(face: Face<'a>, modes: usize, negative: &NegativeMotions) -> Result<Self> {
        let (n, d) = (face.rows().len(), negative.modes.len());
        let (mut motions, mut forces) = (Matrix::zeros(modes, d)?, Matrix::zeros(n, d)?);
        for (j, (&mode, root)) in negative.modes.iter().zip(&negative.roots).enumerate() {
            let mut e = vec![0.0; modes];
            e[mode] = *root;
            let (x, alpha) = face.solve(vec![0.0; n], &e)?;
            motions.col_mut(j).copy_from_slice(&alpha);
            forces.col_mut(j).copy_from_slice(&x);
        }
        let p = |i: usize, j: usize| negative.roots[i] * motions.get(negative.modes[i], j);
        let (rates, vectors) = symmetric_eigen(&Matrix::from_fn(d, d, |i, j| 0.5 * (p(i, j) + p(j, i)))?)?;
        Ok(Self { face, rates, vectors, motions, forces })
    }

    /// rho
    pub fn rate(&self) -> f64 {
        self.rates.last().copied().unwrap_or(0.0)
    }

    /// The motion of the eigenvalue rho: its forces on `rows` rows, its amplitudes, rho.
    pub fn motion(&self, rows: usize) -> (Vec<f64>, Vec<f64>, f64) {
        let v = self.vectors.col(self.vectors.cols - 1);
        let (mut alpha, mut on_face) = (vec![0.0; self.motions.rows], vec![0.0; self.forces.rows]);
        self.motions.mul_add(1.0, v, &mut alpha);
        self.forces.mul_add(1.0, v, &mut on_face);
        (self.on_all(rows, &on_face), alpha, self.rate())
    }

    /// x on the face and alpha for these forces and resultants, including the feedback of the motions with negative
    /// stiffness; without the feedback if rho >= 1.
    pub fn solve(
        &self,
        negative: &NegativeMotions,
        force: Vec<f64>,
        e: &[f64],
    ) -> Result<(Vec<f64>, Vec<f64>)> {
        let (mut x, mut alpha) = self.face.solve(force, e)?;
        if !negative.modes.is_empty() && self.rate() < 1.0 {
            let b = negative.forced(&alpha);
            let mut more = b.clone();
            self.add_feedback(&b, &mut more);
            self.forces.mul_add(1.0, &more, &mut x);
            self.motions.mul_add(1.0, &more, &mut alpha);
        }
        Ok((x, alpha))
    }

    /// x on the face, 0 on the others.
    fn on_all(&self, rows: usize, on_face: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; rows];
        self.face.rows().iter().zip(on_face).for_each(|(&i, v)| x[i] = *v);
        x
    }

    /// `b + (I - P)^-1 (b' - b)`, by b' and `change = b' - b`.
    pub fn settled(&self, next: &[f64], change: &[f64]) -> Vec<f64> {
        let mut settled = next.to_vec();
        self.add_feedback(change, &mut settled);
        settled
    }

    /// `sum += (I - P)^-1 P b`
    fn add_feedback(&self, b: &[f64], sum: &mut [f64]) {
        let parts = self.vectors.mul_transposed(b);
        let parts: Vec<f64> =
            parts.iter().zip(&self.rates).map(|(part, rate)| part * rate / (1.0 - rate)).collect();
        self.vectors.mul_add(1.0, &parts, sum);
    }

    /// x and alpha on the face for these resultants.
    pub fn point(&self, qp: Qp, e: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        let force = self.face.rows().iter().map(|&i| qp.b[i]).collect();
        let (on_face, alpha) = self.face.solve(force, e)?;
        Ok((self.on_all(qp.b.len(), &on_face), alpha))
    }
}
