//! A problem by its matrices, solved; judges that accept.

use feti_contact::error::Result;
use feti_contact::linalg::vector::norm;
use feti_contact::linalg::{Csr, Matrix};
use feti_contact::qp::friction::{
    friction, Cones, FrictionLimits, FrictionProblem, FrictionSolution, FrictionStart, Node,
};
use feti_contact::qp::{AcceptanceTest, Direct, Observer, Qp, StepReport};

use crate::friction::dense::{Dense, OfMatrices};

pub struct Given {
    pub f: Dense,
    pub d: Vec<f64>,
    pub g_transposed: Csr,
    pub e: Vec<f64>,
    pub cones: Cones,
    pub preconditioner: Option<OfMatrices>,
    pub parts: Option<Parts>,
}

/// What the preconditioner of the dual layer is made of.
pub struct Parts {
    /// m x n, scaled.
    pub b: Csr,
    /// diag K
    pub metric: Vec<f64>,
    /// Constrained unknowns of each body with their Schur complement.
    pub boundaries: Vec<(Vec<usize>, Matrix)>,
}

pub struct Content;

impl AcceptanceTest for Content {
    fn scale(&mut self, _: &[f64], _: &[f64]) -> Result<f64> {
        Ok(1.0)
    }

    fn accepts(&mut self, _: &[f64], _: &[f64]) -> Result<bool> {
        Ok(true)
    }
}

impl Observer for Content {
    fn step(&mut self, now: &StepReport) -> Result<()> {
        if std::env::var("TELL").is_ok() {
            println!("{:?}: {} of {}", now.counts, now.residual, now.small);
        }
        Ok(())
    }
}

impl Given {
    /// Without modes and preconditioner.
    pub fn new(f: Matrix, d: Vec<f64>, nodes: Vec<Node>) -> Self {
        let mut g_transposed = Csr::empty(0);
        d.iter().for_each(|_| g_transposed.push_row([]));
        let cones = Cones::new(d.len(), nodes).unwrap();
        Self { f: Dense(f), d, g_transposed, e: Vec::new(), cones, preconditioner: None, parts: None }
    }

    /// With G, r x m, and e.
    pub fn floating(self, g: &[Vec<f64>], e: Vec<f64>) -> Self {
        let mut g_transposed = Csr::empty(g.len());
        for i in 0..self.d.len() {
            g_transposed.push_row(g.iter().enumerate().map(|(k, row)| (k, row[i])));
        }
        Self { g_transposed, e, ..self }
    }

    pub fn problem(&self) -> FrictionProblem<'_> {
        let qp = Qp::plain(&self.f, &self.d, &self.g_transposed, &self.e, &[]);
        FrictionProblem {
            qp,
            cones: &self.cones,
            preconditioner: self.preconditioner.as_ref().map(|m| m as _),
        }
    }

    pub fn limits(&self, tolerance: f64, limit: usize) -> FrictionLimits<'_> {
        let direct = Some(Direct { entries: &self.f, limit });
        FrictionLimits { tolerance, products: 1000, direct }
    }

    pub fn solved(&self) -> FrictionSolution {
        self.from(FrictionStart::default(), 1e-10, 400)
    }

    pub fn from(&self, start: FrictionStart, tolerance: f64, limit: usize) -> FrictionSolution {
        friction(self.problem(), self.limits(tolerance, limit), start, &mut Content, &mut Content).unwrap()
    }

    /// `r = F x - d - G'alpha`
    pub fn gaps(&self, found: &FrictionSolution) -> Vec<f64> {
        let mut r = vec![0.0; self.d.len()];
        self.f.0.mul_add(1.0, &found.x, &mut r);
        for (i, r) in r.iter_mut().enumerate() {
            *r -= self.d[i] + self.g_transposed.row_dot(i, &found.alpha);
        }
        r
    }

    /// `|x - NAT(x - r)|, |G x - e|`: what the laws miss at an answer, against `|d|` and `|e|`.
    pub fn missed(&self, found: &FrictionSolution) -> (f64, f64) {
        let r = self.gaps(found);
        let law = self.cones.law(&found.x, &r, 1.0);
        let mut left = self.e.clone();
        self.g_transposed.mul_transposed_add(-1.0, &found.x, &mut left);
        let against = |v: f64, whole: f64| if v == 0.0 { 0.0 } else { v / whole };
        (against(norm(&law), norm(&self.d)), against(norm(&left), norm(&self.e)))
    }
}

/// Numbers in [-1, 1), the same in every run.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> f64 {
        for _ in 0..2 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
        }
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }

    /// `A A' / n + shift I`
    pub fn positive(&mut self, n: usize, shift: f64) -> Matrix {
        let a: Vec<Vec<f64>> = (0..n).map(|_| self.vector(n)).collect();
        let entry = |i: usize, j: usize| {
            (0..n).map(|k| a[i][k] * a[j][k]).sum::<f64>() / n as f64 + if i == j { shift } else { 0.0 }
        };
        Matrix::from_fn(n, n, entry).unwrap()
    }
}
