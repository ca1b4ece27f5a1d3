//! Option `paper_units` = printed: Algorithm 3 in the form of the paper, in the units of the host and with the host's basis of the
//! null spaces,
//!
//! ```text
//! A = B K+ B',  b = B K+ f - c,  D = R'B',  d = R'f   (corrected: printed d = R'c),   lambda >= 0 in forces
//! ```

use feti_contact::error::Result;
use feti_contact::linalg::{Csr, Operator};
use feti_contact::qp::{AcceptanceTest, Observer, Qp, Solution, StepReport};
use feti_contact::solver::HostForm;

use super::{algorithm_3, Parameters};

/// The transformation between the dual of the library and that of the host.
pub struct HostUnits<'a> {
    pub parameters: Parameters,
    pub form: &'a HostForm,
}

impl HostUnits<'_> {
    /// Algorithm 3 on the dual in the units of the host; the solution is in the units of the library.
    pub fn solve(
        &self,
        qp: Qp,
        start: &[f64],
        judge: &mut dyn AcceptanceTest,
        observer: &mut dyn Observer,
    ) -> Result<Solution> {
        let a = Rescaled { inner: qp.a, units: self };
        let b: Vec<f64> = qp.b.iter().zip(&self.form.scale).map(|(b, s)| b / s).collect();
        let d_transposed = self.equalities(qp.g_transposed);
        let d: Vec<f64> = self.to_host_basis(qp.e).iter().map(|d| d * self.form.unit).collect();
        let host =
            Qp { a: &a, b: &b, g_transposed: &d_transposed, e: &d, preconditioner: None, kept: None, ..qp };
        let start: Vec<f64> =
            start.iter().zip(&self.form.scale).map(|(x, s)| x * s * self.form.unit).collect();
        let mut judge = InHostUnits { units: self, inner: judge };
        let mut observer = WithoutUnit { unit: self.form.unit, inner: observer };
        let solution = algorithm_3(host, &start, &self.parameters, &mut judge, &mut observer)?;
        let (x, alpha) = (self.forces(&solution.x), self.to_library_basis(&solution.alpha));
        Ok(Solution { x, alpha, ..solution })
    }

    /// x = S^-1 lambda / 2^p
    fn forces(&self, lambda: &[f64]) -> Vec<f64> {
        lambda.iter().zip(&self.form.scale).map(|(lambda, s)| lambda / (s * self.form.unit)).collect()
    }

    /// D' of the host: (G T)' by rows, without the scaling of the rows.
    fn equalities(&self, g_transposed: &Csr) -> Csr {
        let mut d_transposed = Csr::empty(g_transposed.cols);
        for (i, s) in self.form.scale.iter().enumerate() {
            let mut row = vec![0.0; g_transposed.cols];
            g_transposed.row(i).for_each(|(j, v)| row[j] = v / s);
            let entries = self.to_host_basis(&row).into_iter().enumerate();
            d_transposed.push_row(entries.filter(|(_, v)| *v != 0.0));
        }
        d_transposed
    }

    /// T'v
    fn to_host_basis(&self, v: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; v.len()];
        for (modes, t) in &self.form.basis {
            image[modes.clone()].copy_from_slice(&t.mul_transposed(&v[modes.clone()]));
        }
        image
    }

    /// T alpha
    fn to_library_basis(&self, alpha: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; alpha.len()];
        for (modes, t) in &self.form.basis {
            t.mul_add(1.0, &alpha[modes.clone()], &mut image[modes.clone()]);
        }
        image
    }
}

/// A = S^-1 F S^-1 / 2^p
struct Rescaled<'a> {
    inner: &'a dyn Operator,
    units: &'a HostUnits<'a>,
}

impl Operator for Rescaled<'_> {
    fn order(&self) -> usize {
        self.inner.order()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.inner.apply(&self.units.forces(x), y);
        y.iter_mut().zip(&self.units.form.scale).for_each(|(y, s)| *y /= s);
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.inner.try_apply(&self.units.forces(x), y)?;
        y.iter_mut().zip(&self.units.form.scale).for_each(|(y, s)| *y /= s);
        Ok(())
    }
}

/// Passes points in units of the library to the acceptance test.
struct InHostUnits<'a> {
    units: &'a HostUnits<'a>,
    inner: &'a mut dyn AcceptanceTest,
}

impl AcceptanceTest for InHostUnits<'_> {
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64> {
        self.inner.scale(&self.units.forces(x), &self.units.to_library_basis(alpha))
    }

    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool> {
        self.inner.accepts(&self.units.forces(x), &self.units.to_library_basis(alpha))
    }
}

/// The observer multiplies theta by 2^p.
struct WithoutUnit<'a> {
    unit: f64,
    inner: &'a mut dyn Observer,
}

impl Observer for WithoutUnit<'_> {
    fn step(&mut self, now: &StepReport) -> Result<()> {
        self.inner.step(&StepReport { theta: now.theta / self.unit, ..*now })
    }
}
