//! The error for loads that friction does not hold, although forces within the cones balance them.

use crate::error::{Error, Kind, Proof, Result};
use crate::platform::memory::zeros;
use crate::qp::friction::Slide;
use crate::solve::case::Case;

/// The error with the body that slides fastest, its motion, and the part that friction holds.
pub fn named(case: Case, slide: &Slide, starts: usize) -> Result<Error> {
    let (ready, island) = (case.ready, case.island());
    let own = ready.dual.rigid_motion(&slide.alpha, island.unknowns());
    let mut v = zeros(case.model.sizes().dofs, "a motion")?;
    island.scatter(case.model, &own, &mut v);
    let fastest = (0..v.len()).fold(0, |best, i| if v[i].abs() > v[best].abs() { i } else { best });
    let body = case.model.offsets[1..].partition_point(|end| *end <= fastest);
    let dof = fastest - case.model.offsets[body];
    let sense = if v[fastest] > 0.0 { "positive" } else { "negative" };
    let largest = v[fastest].abs();
    v.iter_mut().for_each(|v| *v /= largest);
    let what = format!(
            "the body slides: friction holds {:.6} of the load along this motion, fastest at this dof, in the {sense} direction; \
             no rest was found from {starts} starts",
            slide.capacity
        );
    let error = Error::new(Kind::Slides, what).body(body).dof(dof).value(slide.capacity).limit(1.0);
    Ok(error.proved_by(Proof::Motion { margin: 1.0 - slide.capacity, v }))
}
