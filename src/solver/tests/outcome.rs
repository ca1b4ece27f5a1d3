//! How a solve ends.

use crate::error::Kind;
use crate::solver::{Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

/// Two springs pushed against walls, each with nothing to do with the other; the second is stopped by its limit of steps.
#[test]
fn the_group_that_ended_worst_is_named_where_there_are_several() {
    for bodies in [1, 2] {
        let mut problem = Problem::new();
        for p in 0..bodies {
            let body = problem.add_body(2).unwrap();
            let k = SparseInput {
                ptr: &[0, 1, 3],
                col: &[0, 0, 1],
                val: &[2.0, -1.0, 2.0],
                storage: Storage::Lower,
            };
            problem.set_stiffness(body, k).unwrap();
            problem.set_null_space(body, 2, 0, &[], 2, Modes::Exact).unwrap();
            problem.set_load(body, &[3.0, if p + 1 < bodies { -5.0 } else { 4.0 }]).unwrap();
            let first = 2 * p as i64;
            let dof = [first, first + 1];
            let walls = RowsInput {
                ptr: &[0, 1, 2],
                body: None,
                dof: &dof,
                val: &[1.0, 1.5],
                rhs: Some(&[1.0, 0.7]),
            };
            problem.add_rows(RowKind::Inequality, walls).unwrap();
        }
        problem.set_i64("max_steps", 1).unwrap();
        problem.set_i64("direct_limit", 0).unwrap();
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Iterations);
        assert_eq!(report.body, (bodies == 2).then_some(1));
        assert_eq!(problem.findings().unwrap().place.body, report.body);
    }
}

/// A free spring, pulled.
#[test]
fn both_methods_say_that_nothing_holds_the_load() {
    for method in ["proportioning", "smalbe"] {
        let mut problem = Problem::new();
        let body = problem.add_body(2).unwrap();
        let k =
            SparseInput { ptr: &[0, 1, 3], col: &[0, 0, 1], val: &[1.0, -1.0, 1.0], storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
        problem.set_load(body, &[1.0, 1.0]).unwrap();
        problem.set_str("method", method).unwrap();
        assert_eq!(problem.solve().unwrap_err().kind, Kind::LoadNotHeld, "{method}: no row");
        let row = RowsInput { ptr: &[0, 1], body: None, dof: &[1], val: &[-1.0], rhs: None };
        problem.add_rows(RowKind::Inequality, row).unwrap();
        assert_eq!(problem.solve().unwrap_err().kind, Kind::LoadNotHeld, "{method}: the wrong side");
    }
}
