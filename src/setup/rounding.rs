//! Which factors are rounded to single precision: those of the pieces of a body that is cut, if they are only used for
//! products, whose time is the time to read the factors.

use crate::model::SolvedModel;
use crate::setup::operators::Operators;

/// True for the bodies whose factor may be rounded; `owner`: the body whose factor a body shares.
pub(super) fn may_be_rounded(
    model: &SolvedModel,
    operators: &Operators,
    owner: impl Fn(usize) -> usize,
) -> Vec<bool> {
    let mut rounded: Vec<bool> = (0..model.bodies.len()).map(|p| model.is_piece(p)).collect();
    (0..rounded.len()).filter(|&p| !operators.implicit[p]).for_each(|p| rounded[owner(p)] = false);
    rounded
}
