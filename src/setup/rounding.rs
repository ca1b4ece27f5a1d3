//! Which factors are in single precision. Those of the pieces of a body that is cut are rounded if they are only used for products, whose
//! time is the time to read the factors. Whole bodies are factorised in single precision if few solves are expected: each later solve
//! takes more corrections than a factor in double precision takes time.

use crate::body::Precision;
use crate::model::SolvedModel;
use crate::numbers::setup::FEW_STEPS;
use crate::setup::operators::Operators;

/// The precision of the factor of each body, where K allows it; `owner`: the body whose factor a body shares.
pub(super) fn precisions(
    model: &SolvedModel,
    operators: &Operators,
    owner: impl Fn(usize) -> usize,
) -> Vec<Precision> {
    let whole =
        if (1..=FEW_STEPS).contains(&model.settings.steps) { Precision::Single } else { Precision::Double };
    let of = |p: usize| if model.is_piece(p) { Precision::Rounded } else { whole };
    let mut all: Vec<Precision> = (0..model.bodies.len()).map(of).collect();
    for owner in (0..all.len()).filter(|&p| !operators.implicit[p]).map(owner) {
        if model.is_piece(owner) {
            all[owner] = Precision::Double;
        }
    }
    all
}
