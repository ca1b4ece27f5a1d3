//! Room for the vectors of a call.

use crate::error::Kind;
use crate::solver::{Problem, SparseInput, Storage};

/// Six dense matrices over the modes of all bodies would take 700 GB, if no null space is known yet.
#[test]
fn the_room_of_many_bodies_grows_with_their_number() {
    let mut problem = Problem::new();
    for body in 0..20_000 {
        problem.add_body(1).unwrap();
        let k = SparseInput { ptr: &[0, 1], col: &[0], val: &[1.0], storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
    }
    assert!(problem.working_headroom().is_ok());
}

/// The solve says that it is missing.
#[test]
fn a_huge_body_without_a_matrix_needs_no_room() {
    let mut problem = Problem::new();
    problem.add_body(1_000_000_000_000).unwrap();
    assert!(problem.working_headroom().is_ok());
    assert_eq!(problem.solve().unwrap_err().kind, Kind::State);
}
