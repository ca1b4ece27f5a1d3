//! The error for loads that friction does not hold, although forces within the cones balance them.

use crate::error::{Error, Kind, Proof, Result};
use crate::qp::friction::Slide;
use crate::solve::case::Case;

/// The error with the body that slides fastest, its motion, and the part that friction holds.
pub fn named(case: Case, slide: &Slide, starts: usize) -> Result<Error> {
    let own = case.rigid_motion(&slide.alpha)?;
    let (v, body, dof) = case.fastest(own)?;
    let sense = if v[case.model.offsets[body] + dof] > 0.0 { "positive" } else { "negative" };
    let what = format!(
            "the body slides: friction holds {:.6} of the load along this motion, fastest at this dof, in the {sense} direction; \
             no rest was found from {starts} starts",
            slide.capacity
        );
    let error = Error::new(Kind::Slides, what).body(body).dof(dof).value(slide.capacity).limit(1.0);
    Ok(error.proved_by(Proof::Motion { margin: 1.0 - slide.capacity, v }))
}
