//! The form of the dual problem in the units of the host and with its basis of the null spaces.

use crate::body::Modes;
use crate::error::Result;
use crate::linalg::Operator;
use crate::solve::case::Case;
use crate::solve::gaps::Gaps;
use crate::solve::local::Rebased;
use crate::solve::method::HostForm;

pub fn host_form(case: Case, gaps: &Gaps) -> Result<HostForm> {
    let (ready, island) = (case.ready, case.island());
    let mut scale: Vec<f64> = gaps.holder.iter().map(|&i| ready.rows.scaling.scale[i]).collect();
    scale.resize(ready.dual.order(), 1.0);
    // the identity if the library has found R itself
    let given = |k: usize| {
        let given = case.model.bodies[island.bodies[k]].body.null_space.as_ref();
        Rebased {
            vectors: given.filter(|given| given.modes == Modes::Exact).map(|given| given.vectors.clone()),
        }
    };
    let mut basis = Vec::with_capacity(island.bodies.len());
    for (k, mut t) in case.locals()?.ask(given, ())?.into_iter().enumerate() {
        t.data.iter_mut().for_each(|v| *v *= ready.dual.size_of(k));
        basis.push((ready.dual.modes_of(k), t));
    }
    Ok(HostForm { unit: island.unit, scale, basis })
}
