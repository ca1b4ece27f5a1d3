//! The three variants of Algorithm 1 for a conjugate gradient step that leaves the bounds (end of Section 4).

use super::face::PaperFace;
use super::Quadratic;
use feti_contact::error::Result;
use feti_contact::linalg::vector::axpy;
use feti_contact::qp::feasible_step;

/// Limit of trial steps of the extrapolating variant.
const TRIALS: usize = 20;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Feasible proportioning: stop at the first bound.
    Feasible,
    /// Monotone proportioning: continue while theta(Py) does not rise; many indices join the active set at once.
    Monotone,
    /// Projected extrapolation, as in box-QUACAN: increasing steps beyond the first bound, projected.
    Extrapolating,
}

/// x^{k+1} with its gradient, and the conjugate gradients if they continue.
pub(super) struct Moved {
    pub x: Vec<f64>,
    pub g: Vec<f64>,
    pub face: Option<PaperFace>,
}

/// `x^{k+1} = y^{i-1} - a~ p`, a~ the largest feasible step (corrected index): the active set grows. Also returns a~;
/// `image` = H p.
pub(super) fn feasible(bounded: &[bool], face: &PaperFace, image: &[f64]) -> (Moved, f64) {
    let hits = |i: &usize| bounded[*i] && face.p[*i] > 0.0;
    let step = feasible_step(&face.y, &face.p, |i| bounded[i]);
    let (mut x, mut g) = (face.y.clone(), face.g.clone());
    for (i, x) in x.iter_mut().enumerate() {
        let reached = hits(&i) && *x <= step * face.p[i];
        *x = if reached { 0.0 } else { *x - step * face.p[i] };
    }
    axpy(-step, image, &mut g);
    (Moved { x, g, face: None }, step)
}

/// From the first bound, reached with `step`, trial steps `extrapolation`, `extrapolation^2`, ... times as long,
/// projected, until theta rises; every trial takes a product.
pub(super) fn extrapolate(
    q: &mut Quadratic,
    face: &PaperFace,
    mut step: f64,
    extrapolation: f64,
    moved: &mut Moved,
) -> Result<()> {
    let mut lowest = q.value(&moved.x, &moved.g);
    for _ in 0..TRIALS {
        step *= extrapolation;
        let mut y = face.y.clone();
        axpy(-step, &face.p, &mut y);
        let y = q.projection(y);
        if y == moved.x {
            break;
        }
        let g = q.gradient(&y)?;
        let value = q.value(&y, &g);
        if value.is_nan() || value >= lowest {
            break;
        }
        lowest = value;
        (moved.x, moved.g) = (y, g);
    }
    Ok(())
}

/// `Py^{i+1}` while theta does not rise, and conjugate gradients continue from `y^{i+1} = y^i - a p` outside the bounds.
/// If theta rises, x^{k+1} = Py^i, which is the present point with the gradient g; at the first step of a face, where
/// this would not change x^k, the feasible step.
pub(super) fn monotone(
    q: &mut Quadratic,
    (x, g): (&[f64], &[f64]),
    mut face: PaperFace,
    (a, y): (f64, Vec<f64>),
    image: &[f64],
) -> Result<Option<Moved>> {
    let projected = q.projection(y.clone());
    let gradient = q.gradient(&projected)?;
    let before = q.value(x, g);
    if q.value(&projected, &gradient) <= before {
        face.feasible = false;
        let face = face.advance(a, y, image).then_some(face);
        return Ok(Some(Moved { x: projected, g: gradient, face }));
    }
    Ok(face.feasible.then(|| feasible(q.qp.bounded, &face, image).0))
}
