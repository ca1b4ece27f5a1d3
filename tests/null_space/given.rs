//! Null spaces that the host gives, against option null_space_tolerance.

use feti_contact::error::{Error, Kind};
use feti_contact::solver::{Modes, Problem, SparseInput, Storage};

/// A spring 1 between two unknowns, the first held by another one.
fn spring(held: f64) -> Result<Problem, Error> {
    let mut problem = Problem::new();
    problem.add_body(2)?;
    let (ptr, col, val) = ([0, 1, 3], [0, 0, 1], [1.0 + held, -1.0, 1.0]);
    problem.set_stiffness(0, SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower })?;
    Ok(problem)
}

/// The free spring with the null vector (1, 1 + 2 e): `|K R| = e |K||R|`.
fn set_up(e: f64, tolerance: Option<f64>) -> Result<(), Error> {
    let mut problem = spring(0.0)?;
    problem.set_null_space(0, 2, 1, &[1.0, 1.0 + 2.0 * e], 2, Modes::Exact)?;
    tolerance.map_or(Ok(()), |tolerance| problem.set_f64("null_space_tolerance", tolerance))?;
    problem.setup()
}

#[test]
fn a_null_space_is_refused_from_the_tolerance_on_with_its_error_and_the_limit() {
    for (asked, tolerance) in [(None, 1e-8), (Some(1e-5), 1e-5), (Some(1e-12), 1e-12)] {
        assert!(set_up(0.5 * tolerance, asked).is_ok(), "{tolerance:e}");
        let refused = set_up(2.0 * tolerance, asked).unwrap_err();
        assert_eq!((refused.kind, refused.place.body), (Kind::NullSpace, Some(0)), "{refused}");
        assert_eq!(refused.place.limit, Some(tolerance));
        let found = refused.place.value.unwrap();
        assert!((found / (2.0 * tolerance) - 1.0).abs() < 1e-3, "{found:e} of {tolerance:e}");
    }
}

/// `|D^-1 K v|` of the unit vector v = (1, 1) / 2^1/2 is 0.7 of the spring that holds it.
#[test]
fn a_candidate_that_a_weak_spring_resists_is_no_null_vector() {
    for (held, dimension) in [(0.0, 1), (1e-12, 1), (1e-10, 0), (1e-9, 0), (1e-3, 0)] {
        let mut problem = spring(held).unwrap();
        problem.set_null_space(0, 2, 1, &[1.0, 1.0], 2, Modes::Candidates).unwrap();
        assert_eq!(problem.null_space(0).unwrap().0, dimension, "{held:e}");
    }
}
