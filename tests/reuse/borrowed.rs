//! Matrices whose values stay with the host, who rewrites them in place.

use std::ptr::NonNull;

use feti_contact::error::Kind;
use feti_contact::solver::{Borrowed, Columns, Modes, Problem};

use crate::reuse::{assert_near, spent};

const PTR: [usize; 3] = [0, 1, 3];
const COL: [i64; 3] = [0, 0, 1];

fn host<T>(start: *mut T) -> Borrowed<T> {
    // SAFETY: the tests keep their arrays of three numbers and write to them between two calls.
    unsafe { Borrowed::new(NonNull::new(start).unwrap(), 3) }
}

/// s times [2 -1; -1 1], in the memory of the host.
fn rewrite(start: *mut f64, s: f64) {
    for (at, v) in [2.0, -1.0, 1.0].into_iter().enumerate() {
        // SAFETY: three numbers that nobody reads now.
        unsafe { start.add(at).write(s * v) };
    }
}

/// Two bodies that borrow one array, their second unknowns pushed by 1: u = (1, 2) / s.
fn twins(start: *mut f64) -> Problem {
    let mut problem = Problem::new();
    for body in 0..2 {
        problem.add_body(2).unwrap();
        let column = |at: usize| COL[at];
        assert!(problem.borrow_stiffness(body, &PTR, Columns::Given(&column), host(start)).unwrap());
        problem.set_null_space(body, 2, 0, &[], 2, Modes::Exact).unwrap();
        problem.set_load(body, &[0.0, 1.0]).unwrap();
    }
    problem
}

fn assert_answer(problem: &Problem, s: f64) {
    for body in 0..2 {
        assert_near(problem.displacement(body).unwrap(), &[1.0 / s, 2.0 / s], 1e-14, "displacements");
    }
}

#[test]
fn values_rewritten_in_place_count_for_every_body_that_borrows_them() {
    let mut array = [0.0; 3];
    let start = array.as_mut_ptr();
    rewrite(start, 1.0);
    let mut problem = twins(start);
    let mut before = [0; 4];
    assert_eq!(spent(&mut problem, &mut before)[..2], [1, 1]);
    assert_answer(&problem, 1.0);
    rewrite(start, 2.5);
    problem.borrow_values(1, host(start)).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..2], [0, 1]);
    assert_answer(&problem, 2.5);
    problem.borrow_values(0, host(start)).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..2], [0, 1], "they count as changed");
    rewrite(start, 5.0);
    let column = |at: usize| COL[at];
    assert!(problem.borrow_stiffness(0, &PTR, Columns::Given(&column), host(start)).unwrap());
    problem.borrow_values(1, host(start)).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..2], [0, 1], "given again with their pattern");
    assert_answer(&problem, 5.0);
}

#[test]
fn refused_values_leave_no_matrix_where_they_were_rewritten_and_the_old_one_elsewhere() {
    let mut array = [0.0; 3];
    let start = array.as_mut_ptr();
    rewrite(start, 1.0);
    let mut problem = twins(start);
    let mut before = [0; 4];
    spent(&mut problem, &mut before);
    let mut other = [4.0, f64::NAN, 2.0];
    let error = problem.borrow_values(0, host(other.as_mut_ptr())).unwrap_err();
    assert_eq!((error.kind, error.place.row, error.place.entry), (Kind::Argument("val"), Some(1), Some(1)));
    assert_eq!(spent(&mut problem, &mut before), [0; 4]);
    // SAFETY: nobody reads now.
    unsafe { start.write(f64::INFINITY) };
    let error = problem.borrow_values(0, host(start)).unwrap_err();
    assert_eq!((error.kind, error.place.body, error.place.row), (Kind::Argument("val"), Some(0), Some(0)));
    let error = problem.solve().unwrap_err();
    assert_eq!((error.kind, error.place.body), (Kind::State, Some(0)));
    rewrite(start, f64::NAN);
    assert!(problem.borrow_values(1, host(start)).is_err());
    assert_eq!(problem.solve().unwrap_err().kind, Kind::State);
    rewrite(start, 2.0);
    problem.borrow_values(1, host(start)).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..2], [0, 1]);
    assert_answer(&problem, 2.0);
}

#[test]
fn a_borrowed_matrix_takes_the_memory_of_its_pattern() {
    let mut array = [0.0; 3];
    let start = array.as_mut_ptr();
    rewrite(start, 1.0);
    let mut problem = twins(start);
    let mut columns = [0_u32, 0, 1];
    problem.borrow_stiffness(1, &PTR, Columns::Kept(host(columns.as_mut_ptr())), host(start)).unwrap();
    let facts = [0, 1].map(|p| problem.body_facts(p).unwrap());
    assert_eq!(facts.each_ref().map(|facts| facts.borrowed), [[true, false], [true, true]]);
    assert_eq!(facts.map(|facts| facts.matrix_bytes), [3 * 8 + 3 * 4, 3 * 8]);
    problem.solve().unwrap();
    assert_answer(&problem, 1.0);
}
