//! Dense operators and preconditioners.

use feti_contact::error::Result;
use feti_contact::linalg::{Entries, Matrix, Operator, SpdSolver};
use feti_contact::qp::friction::{Coordinate, Face, FacePreconditioner, Law, OnFace};

pub struct Dense(pub Matrix);

impl Operator for Dense {
    fn order(&self) -> usize {
        self.0.rows
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        self.0.mul_add(1.0, x, y);
    }
}

impl Entries for Dense {
    fn add_block(&self, rows: &[usize], block: &mut Matrix) -> Result<()> {
        for (b, &j) in rows.iter().enumerate() {
            for (a, &i) in rows.iter().enumerate().skip(b) {
                block.set(a, b, block.get(a, b) + self.0.get(i, j));
            }
        }
        Ok(())
    }
}

/// `M = H^-1 (W' middle W + D) H^-1`, `H = W' coupling W + D + 1e-12 max`.
pub struct OfMatrices {
    /// `B K_d^-1 B' + C`
    pub coupling: Matrix,
    /// `B K_d^-1 S K_d^-1 B' + C`
    pub middle: Matrix,
}

struct DenseFace<'a> {
    middle: &'a Matrix,
    free: Vec<(usize, Coordinate, f64)>,
    h: SpdSolver,
}

fn times(a: &Matrix, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; a.rows];
    a.mul_add(1.0, x, &mut y);
    y
}

impl FacePreconditioner for OfMatrices {
    fn on<'a>(&'a self, face: &Face) -> Result<Box<dyn OnFace + 'a>> {
        let damping = |at: &Coordinate| match at.law {
            Law::Free { damping, .. } => Some(damping),
            Law::Held { .. } => None,
        };
        let free: Vec<(usize, Coordinate, f64)> =
            face.coordinates.iter().enumerate().filter_map(|(k, at)| Some((k, *at, damping(at)?))).collect();
        let n = free.len();
        let mut h = Matrix::zeros(n, n)?;
        for (j, (_, at, _)) in free.iter().enumerate() {
            let mut unit = vec![0.0; self.coupling.rows];
            at.add(1.0, &mut unit);
            let image = times(&self.coupling, &unit);
            free.iter().enumerate().for_each(|(i, (_, at, _))| h.set(i, j, at.of(&image)));
        }
        (0..n).for_each(|i| h.set(i, i, h.get(i, i) + free[i].2));
        let largest = (0..n).fold(0.0, |largest: f64, i| largest.max(h.get(i, i)));
        (0..n).for_each(|i| h.set(i, i, h.get(i, i) + 1e-12 * largest));
        let scale: Vec<f64> = (0..n).map(|i| h.get(i, i)).collect();
        Ok(Box::new(DenseFace { middle: &self.middle, h: SpdSolver::new(&h, &scale)?, free }))
    }
}

impl OnFace for DenseFace<'_> {
    fn apply(&self, q: &[f64], z: &mut [f64]) -> Result<()> {
        let own: Vec<f64> = self.free.iter().map(|(k, _, _)| q[*k]).collect();
        let y = self.h.solve(&own);
        let mut v = vec![0.0; self.middle.rows];
        self.free.iter().zip(&y).for_each(|((_, at, _), y)| at.add(*y, &mut v));
        let image = times(self.middle, &v);
        let inner: Vec<f64> =
            self.free.iter().zip(&y).map(|((_, at, damping), y)| at.of(&image) + damping * y).collect();
        z.fill(0.0);
        self.free.iter().zip(self.h.solve(&inner)).for_each(|((k, _, _), y)| z[*k] = y);
        Ok(())
    }
}
