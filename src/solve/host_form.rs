//! The form of the dual problem in the units of the host and with its basis of the null spaces.

use crate::error::Result;
use crate::linalg::Operator;
use crate::solve::case::Case;
use crate::solve::gaps::Gaps;
use crate::solve::local::Basis;
use crate::solve::method::HostForm;

pub fn host_form(case: Case, gaps: &Gaps) -> Result<HostForm> {
    let (ready, island, bodies) = (case.ready, case.island(), case.locals()?);
    let mut scale: Vec<f64> = gaps.holder.iter().map(|&i| ready.rows.scaling.scale[i]).collect();
    scale.resize(ready.dual.order(), 1.0);
    let basis = (0..bodies.len()).map(|k| ready.dual.modes_of(k)).zip(bodies.ask(|_| Basis, ())?).collect();
    Ok(HostForm { unit: island.unit, scale, basis })
}
