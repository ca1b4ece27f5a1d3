//! One problem solved through the interface of the library, as a host would.

use feti_contact::solver::{self, Modes, Outcome, RowKind, Storage};

use super::case::{difference, Case, Sparse};
use super::problems::Problem;

pub struct Run {
    pub outer: usize,
    /// Conjugate gradient steps, those that met a bound included; all steps of the default.
    pub inner: usize,
    pub products: usize,
    pub unknowns: usize,
    pub duals: usize,
    /// max(|g^P| / |b|, |D x - d| / |d|) of the answer, found from outside.
    pub accuracy: f64,
    /// Largest error of a force against the reference, relative to the largest force.
    pub error: f64,
    releases: usize,
    certificate: f64,
    seconds: f64,
    pub forces: Vec<f64>,
    pub displacement: Vec<f64>,
}

impl Run {
    pub fn details(&self) -> String {
        format!(
            "{} proportioning, forces to {:.1e}, certificate {:.1e}, {:.3} s",
            self.releases, self.error, self.certificate, self.seconds
        )
    }
}

/// The paper's method with its printed parameters, in the units of the data. Its own Step 2 decides: the
/// certificate is asked for two digits only.
pub fn by_paper(problem: &Problem) -> Result<Run, String> {
    let case = Case::read(problem.data);
    let mut given = as_in_paper(&case, problem).map_err(|e| e.to_string())?;
    finished(&case, &mut given)
}

pub fn as_in_paper(case: &Case, problem: &Problem) -> feti_contact::error::Result<solver::Problem> {
    let mut given = handed_over(case, problem.name.starts_with("p2"))?;
    for (body, dofs) in problem.fixing.iter().enumerate() {
        given.set_fixing(body, Some(dofs))?;
    }
    given.set_str("method", problem.method)?;
    given.set_str("paper_units", "printed")?;
    given.set_str("paper_step_1", "printed")?;
    given.set_f64("gamma", problem.gamma)?;
    given.set_f64("paper_rho_0", problem.rho_0)?;
    given.set_f64("paper_m", problem.m)?;
    given.set_f64("tolerance", problem.tolerance)?;
    // every row for itself: the stop of the paper is one norm over all
    given.set_f64("certificate_tolerance", 1e-1)?;
    Ok(given)
}

/// The default method with default options.
pub fn by_default(problem: &Problem) -> Result<Run, String> {
    let case = Case::read(problem.data);
    let mut given = handed_over(&case, problem.name.starts_with("p2")).map_err(|e| e.to_string())?;
    finished(&case, &mut given)
}

/// Bodies of boundary elements come as dense matrices.
pub fn handed_over(case: &Case, dense: bool) -> feti_contact::error::Result<solver::Problem> {
    let mut given = case.problem(false);
    if dense {
        for (body, (k, r)) in case.bodies.iter().enumerate() {
            let n = k.ptr.len() - 1;
            given.set_stiffness_dense(body, n, &full(k), n, Storage::Full)?;
            given.set_null_space(body, n, r.len() / n, r, n, Modes::Exact)?;
        }
    }
    Ok(given)
}

/// Column-major from the lower triangle.
fn full(k: &Sparse) -> Vec<f64> {
    let n = k.ptr.len() - 1;
    let mut dense = vec![0.0; n * n];
    for i in 0..n {
        for at in k.ptr[i]..k.ptr[i + 1] {
            let j = k.col[at] as usize;
            (dense[i + j * n], dense[j + i * n]) = (k.val[at], k.val[at]);
        }
    }
    dense
}

pub fn finished(case: &Case, given: &mut solver::Problem) -> Result<Run, String> {
    let report = given.solve().map_err(|e| e.to_string())?;
    let certificate = report.certificate.worst() * report.certificate.limit;
    if report.outcome != Outcome::Solved {
        return Err(format!("{:?} after {} products", report.outcome, report.counts.products));
    }
    let forces = given.multipliers(RowKind::Inequality).map_err(|e| e.to_string())?.to_vec();
    let accuracy = accuracy(case, given, &forces).map_err(|e| e.to_string())?;
    Ok(Run {
        outer: report.counts.outer,
        inner: if report.counts.outer > 0 {
            report.counts.conjugate_gradient + report.counts.expansions
        } else {
            report.counts.steps()
        },
        products: report.counts.products,
        unknowns: report.sizes.dofs,
        duals: report.sizes.rows,
        accuracy,
        error: difference(&forces, &case.lambda),
        releases: report.counts.releases,
        certificate,
        seconds: report.seconds_setup + report.seconds_solve,
        displacement: case.displacement(given),
        forces,
    })
}

/// g = A x - b - B R alpha on the rows with a force, its negative part on the others, against b = B K+ f - c;
/// R'(f - B'x) against R'f, with the R of the data.
fn accuracy(case: &Case, given: &mut solver::Problem, x: &[f64]) -> feti_contact::error::Result<f64> {
    let (m, (rows, _)) = (x.len(), &case.contact);
    let (mut g, mut b) = (vec![0.0; m], vec![0.0; m]);
    given.dual_apply(x, &mut g)?;
    given.dual_rhs(&mut b)?;
    let mut motion = Vec::new();
    for body in 0..case.bodies.len() {
        let (r, basis) = given.null_space(body).map(|(r, basis)| (r, basis.to_vec()))?;
        let (n, alpha) = (case.bodies[body].0.ptr.len() - 1, given.amplitudes(body)?);
        motion.extend((0..n).map(|i| (0..r).map(|k| basis[i + k * n] * alpha[k]).sum::<f64>()));
    }
    let entries = |i: usize| (rows.ptr[i]..rows.ptr[i + 1]).map(|at| (rows.col[at] as usize, rows.val[at]));
    let mut rest = case.load.clone();
    for i in 0..m {
        g[i] -= b[i] + entries(i).map(|(j, v)| v * motion[j]).sum::<f64>();
        g[i] = if x[i] > 0.0 { g[i] } else { g[i].min(0.0) };
        entries(i).for_each(|(j, v)| rest[j] -= v * x[i]);
    }
    Ok((norm(&g) / norm(&b)).max(resultant(case, &rest) / resultant(case, &case.load)))
}

/// |R'f|
fn resultant(case: &Case, f: &[f64]) -> f64 {
    let (mut start, mut parts) = (0, Vec::new());
    for (k, r) in &case.bodies {
        let n = k.ptr.len() - 1;
        let dot = |mode: &[f64]| mode.iter().zip(&f[start..start + n]).map(|(r, f)| r * f).sum::<f64>();
        parts.extend(r.chunks_exact(n).map(dot));
        start += n;
    }
    norm(&parts)
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Products and error of the forces after every step: solved again and again with one more step allowed.
pub fn history(case: &Case, given: &mut solver::Problem, most: i64) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for steps in 1..=most {
        let Ok(()) = given.set_i64("max_steps", steps) else { break };
        let Ok(report) = given.solve() else { break };
        let Ok(forces) = given.multipliers(RowKind::Inequality) else { break };
        points.push((report.counts.products as f64, difference(forces, &case.lambda).max(1e-16)));
        if report.outcome == Outcome::Solved {
            break;
        }
    }
    points
}
