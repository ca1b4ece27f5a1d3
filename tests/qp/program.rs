//! A dense program `1/2 x'A x - b'x -> min, x_i >= 0 (i bounded), G x = e`, its solution by the library, and
//! the residuals of its optimality conditions.

use feti_contact::error::Result;
use feti_contact::linalg::Csr;
use feti_contact::qp::{
    minimise, AcceptanceTest, Limits, Observer, Preconditioner, Qp, Solution, StepReport, Verdict,
};

use crate::qp::dense::{dot, norm, Dense};

#[derive(Clone, Debug)]
pub struct Program {
    /// m x m
    pub a: Dense,
    pub b: Vec<f64>,
    /// r x m
    pub g: Dense,
    pub e: Vec<f64>,
    pub bounded: Vec<bool>,
}

/// How far a point with its multiplier is from optimal, each in its own unit.
#[derive(Clone, Copy, Debug)]
pub struct Residuals {
    /// `A x - b - G'alpha`: its part on x > 0, its negative part on x = 0.
    pub gradient: f64,
    /// `|A x| + |b| + |G'alpha|`
    pub gradient_size: f64,
    /// `|G x - e|`
    pub equality: f64,
    /// `|G||x| + |e|`
    pub equality_size: f64,
    /// `min x_i` over the bounded rows, at most 0.
    pub lowest: f64,
}

impl Residuals {
    /// Both conditions to `tolerance`, the bounds exactly.
    pub fn within(&self, tolerance: f64) -> bool {
        self.gradient <= tolerance * self.gradient_size
            && self.equality <= tolerance * self.equality_size
            && self.lowest >= 0.0
    }
}

impl Program {
    /// `A`, `b`, all rows bounded, no equalities.
    pub fn new(a: Dense, b: &[f64]) -> Self {
        let m = b.len();
        Self { a, b: b.to_vec(), g: Dense::zeros(0, m), e: vec![], bounded: vec![true; m] }
    }

    pub fn with_equalities(self, g: &[&[f64]], e: &[f64]) -> Self {
        Self { g: Dense(g.iter().map(|row| row.to_vec()).collect()), e: e.to_vec(), ..self }
    }

    pub fn with_free_rows(mut self, free: &[usize]) -> Self {
        free.iter().for_each(|&i| self.bounded[i] = false);
        self
    }

    /// theta(x)
    pub fn value(&self, x: &[f64]) -> f64 {
        0.5 * dot(x, &self.a.times(x)) - dot(&self.b, x)
    }

    /// Column i of G is row i of the result.
    pub fn g_transposed(&self) -> Csr {
        let mut rows = Csr::empty(self.e.len());
        for i in 0..self.b.len() {
            let column = self.g.0.iter().map(|row| row[i]).enumerate();
            rows.push_row(column.filter(|(_, v)| *v != 0.0));
        }
        rows
    }

    pub fn qp<'a>(&'a self, g_transposed: &'a Csr, preconditioner: Option<&'a dyn Preconditioner>) -> Qp<'a> {
        let Self { a, b, e, bounded, .. } = self;
        Qp { preconditioner, ..Qp::plain(a, b, g_transposed, e, bounded) }
    }

    pub fn residuals(&self, x: &[f64], alpha: &[f64]) -> Residuals {
        let (image, coarse) = (self.a.times(x), self.g.transpose_times(alpha, x.len()));
        let part = |i: usize| {
            let r = image[i] - self.b[i] - coarse[i];
            if self.bounded[i] && x[i] <= 0.0 {
                r.min(0.0)
            } else {
                r
            }
        };
        let gradient: Vec<f64> = (0..x.len()).map(part).collect();
        let left: Vec<f64> = self.g.times(x).iter().zip(&self.e).map(|(gx, e)| gx - e).collect();
        let terms = |row: &Vec<f64>| row.iter().zip(x).map(|(g, x)| (g * x).abs()).sum::<f64>();
        let lengths: Vec<f64> = self.g.0.iter().map(terms).collect();
        Residuals {
            gradient: norm(&gradient),
            gradient_size: norm(&image) + norm(&self.b) + norm(&coarse),
            equality: norm(&left),
            equality_size: norm(&lengths) + norm(&self.e),
            lowest: (0..x.len()).filter(|&i| self.bounded[i]).fold(0.0, |low, i| x[i].min(low)),
        }
    }

    /// Solves from x = 0 to 1e-12; accepted when the optimality conditions hold to 1e-9.
    pub fn minimise(&self) -> Solution {
        self.minimise_from(&vec![0.0; self.b.len()], 1e-12, 1e-9)
    }

    pub fn minimise_from(&self, start: &[f64], tolerance: f64, accepted: f64) -> Solution {
        self.run(start, tolerance, accepted, None)
    }

    pub fn minimise_with(&self, preconditioner: Option<&dyn Preconditioner>) -> Solution {
        self.run(&vec![0.0; self.b.len()], 1e-12, 1e-9, preconditioner)
    }

    fn run(
        &self,
        start: &[f64],
        tolerance: f64,
        accepted: f64,
        preconditioner: Option<&dyn Preconditioner>,
    ) -> Solution {
        let limits = Limits { tolerance, gamma: 1.0, steps: 5000 };
        let mut judge = Conditions { program: self, accepted };
        let g_transposed = self.g_transposed();
        let qp = self.qp(&g_transposed, preconditioner);
        minimise(qp, start, limits, &mut judge, &mut Silent).unwrap()
    }

    /// To 1e-12 from a start, by any method, watched.
    pub fn watched(&self, method: Method, start: &[f64], observer: &mut dyn Observer) -> Solution {
        let limits = Limits { tolerance: 1e-12, gamma: 1.0, steps: 20_000 };
        let mut judge = Conditions { program: self, accepted: 1e-9 };
        let g_transposed = self.g_transposed();
        method(self.qp(&g_transposed, None), start, limits, &mut judge, observer).unwrap()
    }

    /// The solution, which must have been accepted.
    pub fn solved(&self) -> Solution {
        let solution = self.minimise();
        let residuals = self.residuals(&solution.x, &solution.alpha);
        assert_eq!(solution.verdict, Verdict::Solved, "{:?} {residuals:?}", solution.counts);
        assert!(residuals.within(1e-9), "{residuals:?}");
        solution
    }
}

/// `minimise`, or a method of the paper.
pub type Method = fn(Qp, &[f64], Limits, &mut dyn AcceptanceTest, &mut dyn Observer) -> Result<Solution>;

/// Accepts by the residuals of the optimality conditions.
pub struct Conditions<'a> {
    pub program: &'a Program,
    pub accepted: f64,
}

impl AcceptanceTest for Conditions<'_> {
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64> {
        Ok(self.program.residuals(x, alpha).gradient_size)
    }

    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool> {
        Ok(self.program.residuals(x, alpha).within(self.accepted))
    }
}

pub struct Silent;

impl Observer for Silent {
    fn step(&mut self, _: &StepReport) -> Result<()> {
        Ok(())
    }
}
