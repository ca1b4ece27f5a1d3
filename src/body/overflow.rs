//! Stiffness matrices whose entries are finite, but so far apart that products of them are not.

use crate::error::{Error, Kind, Result};

/// Squares of larger numbers overflow. In the metric of its diagonal no entry of a semidefinite matrix exceeds 1.
const LARGEST: f64 = 1e150;

/// The matrix is refused at the unknown of the first value that is no number or has no square; `dof` tells it from the
/// position.
pub(super) fn refuse_overflow(values: &[f64], dof: impl Fn(usize) -> usize) -> Result<()> {
    let fits = |value: &f64| value.abs() <= LARGEST;
    match values.iter().position(|value| !fits(value)) {
        Some(at) => Err(overflow().dof(dof(at)).value(values[at]).limit(LARGEST)),
        None => Ok(()),
    }
}

pub(super) fn overflow() -> Error {
    let what =
        "the stiffness matrix is indefinite, or its entries are too far apart: products of them overflow";
    Error::new(Kind::Indefinite, what)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{GeneralizedInverse, Modes, NullSpaceInput, Plan};
    use crate::linalg::{Matrix, Multiple, Symmetric};

    fn vectors(data: &[f64], modes: Modes) -> NullSpaceInput {
        NullSpaceInput { vectors: Matrix { rows: 2, cols: data.len() / 2, data: data.to_vec() }, modes }
    }

    fn refused(plan: Result<Plan>) -> Error {
        plan.and_then(Plan::execute).err().unwrap()
    }

    /// K = [a b; b d] with finite entries of which products are not.
    #[test]
    fn finite_entries_whose_products_overflow_are_refused_however_the_null_space_is_given() {
        for [a, b, d] in [[1.0, 1e300, 1.0], [1.0, -1e200, 1e-3], [1.0, 1.5e308, 1e-300]] {
            let k = || Multiple::from(Symmetric::new(vec![0, 1, 3], vec![0, 0, 1], vec![a, b, d]));
            for error in [
                refused(GeneralizedInverse::plan(k(), &vectors(&[], Modes::Exact), 1e-8)),
                refused(GeneralizedInverse::plan(k(), &vectors(&[1.0, 1.0], Modes::Candidates), 1e-8)),
                refused(GeneralizedInverse::search(k(), 1e-8, None)),
            ] {
                assert_eq!(error.kind, Kind::Indefinite, "{a:e} {b:e} {d:e}: {error}");
            }
        }
    }

    /// K = diag(1, 1e-310): its factor is right, but 1e-310 has no reciprocal to measure forces by.
    #[test]
    fn a_diagonal_entry_without_a_reciprocal_is_refused_by_the_probe() {
        let k = Multiple::from(Symmetric::new(vec![0, 1, 2], vec![0, 1], vec![1.0, 1e-310]));
        let error = refused(GeneralizedInverse::plan(k, &vectors(&[], Modes::Exact), 1e-8));
        assert_eq!(error.kind, Kind::Indefinite, "{error}");
    }
}
