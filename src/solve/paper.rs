//! Option `method` = paper-...: Algorithm 3 on the dual problem as the library scales it, or, with option `paper_units` =
//! printed, in the form of the paper: in the units of the host and with the host's basis of the null spaces,
//!
//! ```text
//! A = B K+ B',  b = B K+ f - c,  D = R'B',  d = R'f   (corrected: printed d = R'c),   lambda >= 0 in forces
//! ```

use crate::body::Modes;
use crate::error::Result;
use crate::linalg::{Csr, Matrix, Operator};
use crate::model::{Method, PaperStep1, PaperUnits, Settings};
use crate::qp::paper::{algorithm_3, PaperRule, Parameters, StepOne, Units, Variant};
use crate::qp::{AcceptanceTest, Observer, Qp, Solution, StepReport};
use crate::setup::Island;
use crate::solve::case::Case;
use crate::solve::gaps::Gaps;

/// The variant of Algorithm 1; none if `method` is not one of the paper.
fn variant(settings: &Settings) -> Option<Variant> {
    match settings.method {
        Method::Proportioning => None,
        Method::PaperFeasible => Some(Variant::Feasible),
        Method::PaperMonotone => Some(Variant::Monotone),
        Method::PaperExtrapolating => Some(Variant::Extrapolating),
    }
}

/// Options of the paper's methods; none if `method` is not one of them.
pub fn parameters(settings: &Settings) -> Option<Parameters> {
    let whole = |n: i64| usize::try_from(n).unwrap_or(usize::MAX);
    Some(Parameters {
        alpha: settings.paper_alpha,
        beta: settings.paper_beta,
        rho_0: settings.paper_rho_0,
        eta_0: settings.paper_eta_0,
        m: Some(settings.paper_m).filter(|m| *m > 0.0),
        mu_0: settings.paper_mu_0,
        outer: whole(settings.paper_outer),
        rule: PaperRule {
            gamma: settings.gamma,
            variant: variant(settings)?,
            extrapolation: settings.paper_extrapolation,
        },
        units: match settings.paper_units {
            PaperUnits::Relative => Units::Relative,
            PaperUnits::Printed => Units::Printed,
        },
        step_1: match settings.paper_step_1 {
            PaperStep1::Corrected => StepOne::Corrected,
            PaperStep1::Printed => StepOne::Printed,
        },
        tolerance: settings.tolerance,
        steps: whole(settings.max_steps),
    })
}

/// The transformation between the dual of the library and that of the host.
pub struct HostUnits {
    parameters: Parameters,
    /// 2^p
    unit: f64,
    /// s_i of every group, 1 of springs of bodies.
    scale: Vec<f64>,
    /// T with `R_host = R T` of every body, and the range of its modes.
    basis: Vec<(std::ops::Range<usize>, Matrix)>,
}

impl HostUnits {
    pub fn new(case: Case, gaps: &Gaps, parameters: Parameters) -> Result<Self> {
        let ready = case.ready;
        let mut scale: Vec<f64> = gaps.holder.iter().map(|&i| ready.rows.scaling.scale[i]).collect();
        scale.resize(ready.dual.order(), 1.0);
        let mut basis = Vec::with_capacity(ready.island.bodies.len());
        let Island { bodies, ranges, unit, .. } = &*ready.island;
        for (k, (&p, range)) in bodies.iter().zip(&**ranges).enumerate() {
            let own = unit / case.prepared.inverse(case.model, p).map_or(*unit, |inverse| inverse.unit);
            let metric: Vec<f64> = ready.rows.metric[range.clone()].iter().map(|d| own * d).collect();
            let mut t = change_of_basis(case, p, &metric)?;
            t.data.iter_mut().for_each(|v| *v *= ready.dual.size_of(k));
            basis.push((ready.dual.modes_of(k), t));
        }
        Ok(Self { parameters, unit: *unit, scale, basis })
    }

    /// Algorithm 3 on the dual in the units of the host; the solution is in the units of the library.
    pub fn solve(
        &self,
        qp: Qp,
        start: &[f64],
        judge: &mut dyn AcceptanceTest,
        observer: &mut dyn Observer,
    ) -> Result<Solution> {
        let a = Rescaled { inner: qp.a, units: self };
        let b: Vec<f64> = qp.b.iter().zip(&self.scale).map(|(b, s)| b / s).collect();
        let d_transposed = self.equalities(qp.g_transposed);
        let d: Vec<f64> = self.to_host_basis(qp.e).iter().map(|d| d * self.unit).collect();
        let host =
            Qp { a: &a, b: &b, g_transposed: &d_transposed, e: &d, preconditioner: None, kept: None, ..qp };
        let start: Vec<f64> = start.iter().zip(&self.scale).map(|(x, s)| x * s * self.unit).collect();
        let mut judge = InHostUnits { units: self, inner: judge };
        let mut observer = WithoutUnit { unit: self.unit, inner: observer };
        let solution = algorithm_3(host, &start, &self.parameters, &mut judge, &mut observer)?;
        let (x, alpha) = (self.forces(&solution.x), self.to_library_basis(&solution.alpha));
        Ok(Solution { x, alpha, ..solution })
    }

    /// x = S^-1 lambda / 2^p
    fn forces(&self, lambda: &[f64]) -> Vec<f64> {
        lambda.iter().zip(&self.scale).map(|(lambda, s)| lambda / (s * self.unit)).collect()
    }

    /// D' of the host: (G T)' by rows, without the scaling of the rows.
    fn equalities(&self, g_transposed: &Csr) -> Csr {
        let mut d_transposed = Csr::empty(g_transposed.cols);
        for (i, s) in self.scale.iter().enumerate() {
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
        for (modes, t) in &self.basis {
            image[modes.clone()].copy_from_slice(&t.mul_transposed(&v[modes.clone()]));
        }
        image
    }

    /// T alpha
    fn to_library_basis(&self, alpha: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; alpha.len()];
        for (modes, t) in &self.basis {
            t.mul_add(1.0, &alpha[modes.clone()], &mut image[modes.clone()]);
        }
        image
    }
}

/// T with `R_host = R T`: R'D R_host, as R'DR = I; the identity if the library has found R itself.
fn change_of_basis(case: Case, p: usize, metric: &[f64]) -> Result<Matrix> {
    let inverse = case.prepared.inverse(case.model, p);
    let cols = inverse.map_or(0, |inverse| inverse.kplus.null_space.cols);
    let mut t = Matrix::zeros(cols, cols)?;
    (0..cols).for_each(|j| t.set(j, j, 1.0));
    let given = case.model.bodies[p].body.null_space.as_ref().filter(|given| given.modes == Modes::Exact);
    if let (Some(given), Some(inverse)) = (given, inverse) {
        for k in 0..cols {
            let weighted: Vec<f64> = given.vectors.col(k).iter().zip(metric).map(|(r, d)| r * d).collect();
            t.col_mut(k).copy_from_slice(&inverse.kplus.null_space.mul_transposed(&weighted));
        }
    }
    Ok(t)
}

/// A = S^-1 F S^-1 / 2^p
struct Rescaled<'a> {
    inner: &'a dyn Operator,
    units: &'a HostUnits,
}

impl Operator for Rescaled<'_> {
    fn order(&self) -> usize {
        self.inner.order()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.inner.apply(&self.units.forces(x), y);
        y.iter_mut().zip(&self.units.scale).for_each(|(y, s)| *y /= s);
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.inner.try_apply(&self.units.forces(x), y)?;
        y.iter_mut().zip(&self.units.scale).for_each(|(y, s)| *y /= s);
        Ok(())
    }
}

/// Passes points in units of the library to the acceptance test.
struct InHostUnits<'a> {
    units: &'a HostUnits,
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
