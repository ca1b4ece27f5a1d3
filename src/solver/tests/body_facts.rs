//! Information about one body.

use crate::error::Kind;
use crate::solver::{Modes, Origin, Problem, SparseInput, Storage};

/// Two springs that are not connected, one on the ground; a second such body; a dense body.
#[test]
fn facts_tell_what_was_given_and_what_was_made_of_it() {
    let mut problem = Problem::new();
    let (ptr, col, val) = ([0, 1, 3, 4], [0, 0, 1, 2], [1.0, -1.0, 1.0, 2.0]);
    for _ in 0..2 {
        let body = problem.add_body(3).unwrap();
        assert_eq!(problem.components(body).unwrap_err().kind, Kind::State);
        let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
    }
    problem.add_body(2).unwrap();
    let before = problem.body_facts(2).unwrap();
    assert_eq!((before.entries, before.components, before.matrix_bytes), (None, None, 0));
    problem.set_stiffness_dense(2, 2, &[4.0, 0.0, 0.0, 4.0], 2, Storage::Full).unwrap();
    problem.set_null_space(2, 2, 0, &[], 2, Modes::Exact).unwrap();
    assert_eq!(problem.components(0).unwrap(), (vec![0, 0, 1], 2));
    assert_eq!(problem.body_facts(0).unwrap().factors, None);
    problem.setup().unwrap();
    let [first, second, dense] = [0, 1, 2].map(|p| problem.body_facts(p).unwrap());
    assert_eq!((first.unknowns, first.entries, first.components), (3, Some(4), Some(2)));
    assert_eq!((first.origin, first.borrowed), (Origin::Found, [false; 2]));
    let factors = first.factors.unwrap();
    assert_eq!((factors.null_space, factors.shared_with), (1, Some(1)));
    assert!(factors.gap.is_some() && factors.entries > 0 && factors.bytes > 0, "{factors:?}");
    assert_eq!(second.factors.unwrap().shared_with, Some(0));
    assert_eq!((dense.entries, dense.components, dense.origin), (Some(4), Some(2), Origin::Given));
    let factors = dense.factors.unwrap();
    assert_eq!((factors.null_space, factors.shared_with, factors.gap), (0, None, None));
    assert!(dense.operator == Some(Some(0)) && dense.matrix_bytes >= 40, "no row touches it");
    assert!(problem.body_facts(3).is_err());
}
