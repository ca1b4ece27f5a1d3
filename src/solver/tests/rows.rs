//! Rows that no scaling brings to unit length.

use crate::error::Kind;
use crate::solver::{Modes, Problem, RowKind, RowsInput, SparseInput, Storage};

/// A spring 1 pushed by 2 against a wall at 1, the row times t: u = 1 for every t whose square is finite and positive.
#[test]
fn rows_that_no_scale_brings_to_unit_length_are_refused_and_never_left_out() {
    for (t, fits) in [(1e150, true), (1e-150, true), (1e160, false), (1e-160, false), (1e-300, false)] {
        let mut problem = Problem::new();
        let body = problem.add_body(1).unwrap();
        let k = SparseInput { ptr: &[0, 1], col: &[0], val: &[1.0], storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
        problem.set_null_space(body, 1, 0, &[], 1, Modes::Exact).unwrap();
        problem.set_load(body, &[2.0]).unwrap();
        let empty = RowsInput { ptr: &[0, 0], body: None, dof: &[], val: &[], rhs: Some(&[1.0]) };
        let wall = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[t], rhs: Some(&[t]) };
        problem.add_rows(RowKind::Inequality, empty).unwrap();
        problem.add_rows(RowKind::Inequality, wall).unwrap();
        match problem.solve() {
            Ok(_) => assert!(fits && problem.displacement(body).unwrap() == [1.0], "{t:e}"),
            Err(error) => {
                assert_eq!((fits, error.kind, error.place.row), (false, Kind::Overflow, Some(1)), "{t:e}");
            }
        }
    }
}
