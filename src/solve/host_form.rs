//! The form of the dual problem in the units of the host and with its basis of the null spaces.

use crate::body::Modes;
use crate::error::Result;
use crate::linalg::{Matrix, Operator};
use crate::platform::memory::zeros;
use crate::solve::case::Case;
use crate::solve::gaps::Gaps;
use crate::solve::local::Rigid;
use crate::solve::method::HostForm;

pub fn host_form(case: Case, gaps: &Gaps) -> Result<HostForm> {
    let (ready, island, bodies) = (case.ready, case.island(), case.locals()?);
    let mut scale: Vec<f64> = gaps.holder.iter().map(|&i| ready.rows.scaling.scale[i]).collect();
    scale.resize(ready.dual.order(), 1.0);
    // T with R_host = R T: R'D R_host, as R'DR = I; the identity if the library has found R itself
    let given = |k: usize| {
        let given = case.model.bodies[island.bodies[k]].body.null_space.as_ref();
        given.filter(|given| given.modes == Modes::Exact).map(|given| &given.vectors)
    };
    let mut basis = Vec::with_capacity(bodies.len());
    for k in 0..bodies.len() {
        let modes = ready.dual.modes_of(k);
        let mut t = Matrix::zeros(modes.len(), modes.len())?;
        (0..modes.len()).for_each(|j| t.set(j, j, ready.dual.size_of(k)));
        basis.push((modes, t));
    }
    let columns = |k: usize| given(k).map_or(0, |vectors| vectors.cols.min(basis[k].1.cols));
    for j in 0..(0..bodies.len()).map(columns).max().unwrap_or(0) {
        let column = |k: usize| match given(k).filter(|vectors| j < vectors.cols) {
            Some(vectors) => Ok(vectors.col(j).to_vec()),
            None => zeros(bodies.body(k).order(), "a null vector"),
        };
        let all = bodies.put((0..bodies.len()).map(column).collect::<Result<_>>()?)?;
        for (k, amplitudes) in bodies.ask(|_| Rigid, &all)?.into_iter().enumerate() {
            if given(k).is_some_and(|vectors| j < vectors.cols.min(basis[k].1.cols)) {
                basis[k].1.col_mut(j).copy_from_slice(&amplitudes);
            }
        }
    }
    Ok(HostForm { unit: island.unit, scale, basis })
}
