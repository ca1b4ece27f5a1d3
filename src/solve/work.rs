//! The work of the loads, which measures how far they can move the bodies.

use crate::error::Result;
use crate::linalg::vector::dot;
use crate::linalg::ByBody;
use crate::platform::memory::zeros;
use crate::solve::case::Case;

const WHAT: &str = "the work of the loads";

/// V, force x length: `sum_p (g'v)^2 / v'K v` of the self-equilibrated parts `g = f - D R R'f / unit` of the loads f without the
/// grounded unknowns. For any motion v this is at most `g'K+ g`, the work of the load on the body alone: v = K+ g makes it large,
/// and an inexact K+ cannot make it too large.
pub fn work_of_loads(case: Case) -> Result<f64> {
    let (data, ready) = (case.data()?, case.ready);
    let mut load = ByBody::zeros(data.ranges, WHAT)?;
    for (p, body) in data.bodies.iter().enumerate() {
        let own = load.on_mut(p);
        own.copy_from_slice(body.load.unwrap_or(&vec![0.0; own.len()]));
        body.grounded.iter().for_each(|j| own[*j as usize] = 0.0);
        let resultants = body.null_space.mul_transposed(own);
        let mut rigid = zeros(own.len(), WHAT)?;
        body.null_space.mul_add(1.0 / body.unit, &resultants, &mut rigid);
        let rigid = rigid.iter().zip(ready.metric.on(p));
        own.iter_mut().zip(rigid).for_each(|(f, (rigid, d))| *f -= ready.island.unit * d * rigid);
    }
    let motion = ready.displacement(case.threads(), &load)?;
    let mut work = 0.0;
    for (p, body) in data.bodies.iter().enumerate() {
        let (g, v) = (load.on(p), motion.on(p));
        let mut strain = zeros(v.len(), WHAT)?;
        body.stiffness.mul(v, &mut strain)?;
        let (done, stored) = (dot(g, v), dot(v, &strain));
        work += if stored > 0.0 { done * (done / stored) } else { 0.0 };
    }
    Ok(work)
}
