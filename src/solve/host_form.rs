//! The form of the dual problem in the units of the host and with its basis of the null spaces.

use crate::body::Modes;
use crate::error::Result;
use crate::linalg::{Matrix, Operator};
use crate::setup::Island;
use crate::solve::case::Case;
use crate::solve::gaps::Gaps;
use crate::solve::method::HostForm;

pub fn host_form(case: Case, gaps: &Gaps) -> Result<HostForm> {
    let ready = case.ready;
    let mut scale: Vec<f64> = gaps.holder.iter().map(|&i| ready.rows.scaling.scale[i]).collect();
    scale.resize(ready.dual.order(), 1.0);
    let mut basis = Vec::with_capacity(ready.island.bodies.len());
    let Island { bodies, unit, .. } = &*ready.island;
    for (k, &p) in bodies.iter().enumerate() {
        let own = unit / case.prepared.inverse(case.model, p).map_or(*unit, |inverse| inverse.unit);
        let metric: Vec<f64> = ready.metric.on(k).iter().map(|d| own * d).collect();
        let mut t = change_of_basis(case, p, &metric)?;
        t.data.iter_mut().for_each(|v| *v *= ready.dual.size_of(k));
        basis.push((ready.dual.modes_of(k), t));
    }
    Ok(HostForm { unit: *unit, scale, basis })
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
