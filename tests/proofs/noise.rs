//! Right-hand sides and entries that are rounding demand nothing, and refuse nothing.

use feti_contact::error::{Kind, Result};
use feti_contact::solver::{
    FrictionInput, Modes, Outcome, Problem, Report, RowKind, RowsInput, SparseInput, Storage,
};

use crate::support::warnings::told;

/// `.3 - (.1 + .2)`
const RESIDUE: f64 = -1.0 / (1u64 << 54) as f64;

/// Bodies with K = [2 -1; -1 2] k and these loads.
fn pairs(k: f64, loads: &[[f64; 2]]) -> Problem {
    let mut problem = Problem::new();
    for load in loads {
        let body = problem.add_body(2).unwrap();
        let val = [2.0 * k, -k, 2.0 * k];
        let k = SparseInput { ptr: &[0, 1, 3], col: &[0, 0, 1], val: &val, storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
        problem.set_null_space(body, 2, 0, &[], 2, Modes::Exact).unwrap();
        problem.set_load(body, load).unwrap();
    }
    problem
}

fn add(problem: &mut Problem, kind: RowKind, entries: &[(i64, f64)], rhs: f64) {
    let (dof, val): (Vec<i64>, Vec<f64>) = entries.iter().copied().unzip();
    let rows = RowsInput { ptr: &[0, dof.len()], body: None, dof: &dof, val: &val, rhs: Some(&[rhs]) };
    problem.add_rows(kind, rows).unwrap();
}

fn is_solved(ended: Result<Report>) -> bool {
    match ended {
        Ok(report) => {
            assert_eq!(report.outcome, Outcome::Solved);
            true
        }
        Err(error) => {
            assert_eq!(error.kind, Kind::GapsContradict, "{error}");
            false
        }
    }
}

/// Rows of which the host has struck out all unknowns, beside a row with the gap or right-hand side .3.
#[test]
fn what_is_left_in_a_row_without_entries_contradicts_only_if_it_is_more_than_rounding() {
    for scale in [1e-9, 1.0, 1e9] {
        for kind in [RowKind::Inequality, RowKind::Equality] {
            for (rhs, solved) in
                [(RESIDUE, true), (-1e-17, true), (-1e-300, true), (-1e-12, false), (-0.1, false)]
            {
                let mut problem = pairs(1.0, &[[scale, 0.0]]);
                add(&mut problem, kind, &[(0, 1.0)], 0.3 * scale);
                add(&mut problem, kind, &[], rhs * scale);
                assert_eq!(is_solved(problem.solve()), solved, "{kind:?} {rhs:e}");
            }
        }
    }
}

/// A tied unknown that also has a contact row, in a group of bodies without load, or with a small one: only other gaps, other
/// loads or coordinates say what is rounding.
#[test]
fn a_gap_of_rounding_at_a_tied_unknown_contradicts_nothing_in_a_group_without_load() {
    for (loads, far, placed, gap) in [
        (&[[0.0; 2]][..], Some(0.2), false, RESIDUE),
        (&[[0.0; 2]], None, true, RESIDUE),
        (&[[1.0, 0.0], [0.0; 2]], None, false, RESIDUE),
        (&[[1.0, 0.0], [1e-9, 0.0]], None, false, RESIDUE),
        (&[[1.0, 0.0], [0.0; 2]], Some(0.2), false, RESIDUE),
        (&[[0.0; 2]], Some(0.2), false, -1e-9),
        (&[[0.0; 2]], None, true, -1e-9),
        (&[[1.0, 0.0], [0.0; 2]], None, false, -1e-9),
    ] {
        let mut problem = pairs(1.0, loads);
        let last = 2 * (loads.len() as i64 - 1);
        add(&mut problem, RowKind::Equality, &[(last, 1.0)], 0.0);
        add(&mut problem, RowKind::Inequality, &[(last, -1.0)], gap);
        far.iter().for_each(|far| add(&mut problem, RowKind::Inequality, &[(last + 1, -1.0)], *far));
        if placed {
            problem.set_coordinates(0, 2, &[1, 2], &[1, 1], &[0.0, 0.0, 1.0, 0.0], 2).unwrap();
        }
        assert_eq!(is_solved(problem.solve()), gap == RESIDUE, "{loads:?} {far:?}");
        if gap == RESIDUE {
            assert!(problem.displacements().unwrap()[last as usize].abs() < 1e-15);
        }
    }
}

/// An interference that only the motion of another, far softer body could call rounding.
#[test]
fn an_interference_beside_a_body_that_travels_far_is_kept() {
    for (load, gap) in [(1e9, -5e-6), (1e12, -5e-3), (1e13, -5e-2)] {
        let mut problem = pairs(1.0, &[[-0.6, 0.0], [load, 0.0]]);
        add(&mut problem, RowKind::Inequality, &[(0, -1.0)], 1.0);
        add(&mut problem, RowKind::Inequality, &[(1, -1.0)], gap);
        assert!(is_solved(problem.solve()));
        let u = problem.displacements().unwrap();
        assert!((u[1] + gap).abs() < 1e-14, "{load:e} {u:?}");
        assert!((2.0 * u[0] - u[1] + 0.6).abs() < 1e-12, "{load:e} {u:?}");
    }
}

/// A value prescribed by several rows that say the same, which only the travel of another, far softer body could call rounding.
#[test]
fn a_value_that_two_rows_prescribe_is_kept_beside_a_body_that_travels_far() {
    for (load, value) in [(1e10, 2e-5), (1e13, -5e-2)] {
        let mut problem = pairs(1.0, &[[-0.6, 0.0], [load, 0.0]]);
        add(&mut problem, RowKind::Equality, &[(1, -0.612)], -0.612 * value);
        add(&mut problem, RowKind::Equality, &[(1, 0.371)], 0.371 * value);
        add(&mut problem, RowKind::Equality, &[(0, 0.3), (1, -0.7)], 0.3);
        add(&mut problem, RowKind::Equality, &[(0, -1.5), (1, 3.5)], -1.5);
        assert!(is_solved(problem.solve()));
        let u = problem.displacements().unwrap();
        assert!((u[1] - value).abs() < 1e-14, "{load:e} {u:?}");
        assert!((u[0] - 1.0 - 0.7 * value / 0.3).abs() < 1e-14, "{load:e} {u:?}");
    }
}

/// u_0 = u_1 + .1, and a spring of 1/4 from u_0 to .5; the problem is so long that 64 eps of it exceed .5.
#[test]
fn a_spring_at_a_tied_unknown_keeps_its_length_beside_a_body_that_travels_far() {
    let mut problem = pairs(1.0, &[[3.0, 0.0], [1e14, 0.0]]);
    add(&mut problem, RowKind::Equality, &[(0, 1.0), (1, -1.0)], 0.1);
    add(&mut problem, RowKind::Equality, &[(0, 1.0)], 0.5);
    problem.set_compliance(RowKind::Equality, 1, &[0.25]).unwrap();
    assert!(is_solved(problem.solve()));
    assert!((problem.displacements().unwrap()[0] - 0.85).abs() < 1e-14);
}

/// An interference that only a gap far beyond reach could call rounding is none.
#[test]
fn a_small_interference_beside_a_gap_that_never_closes_is_kept() {
    for never in [1e20, 1e30] {
        let mut problem = pairs(1.0, &[[0.0; 2]]);
        add(&mut problem, RowKind::Inequality, &[(0, -1.0)], -1e-5);
        add(&mut problem, RowKind::Inequality, &[(1, -1.0)], never);
        assert!(is_solved(problem.solve()));
        assert!((problem.displacements().unwrap()[0] / 1e-5 - 1.0).abs() < 1e-10);
    }
}

/// A node tied to its own segment, u_0 - (1 - xi) u_0 - xi u_1 = 0: for xi = 2^-53 that is 1.1e-16 (u_0 - u_1).
#[test]
fn entries_that_cancel_are_no_entries_and_are_told() {
    for xi in [0.0, f64::EPSILON / 2.0, -f64::EPSILON / 2.0, 1e-3] {
        for kind in [RowKind::Inequality, RowKind::Equality] {
            let mut problem = pairs(1.0, &[[3.0, 0.0]]);
            let told = told(&mut problem);
            add(&mut problem, kind, &[(0, 1.0), (0, xi - 1.0), (1, -xi)], 0.0);
            assert!(is_solved(problem.solve()));
            let u = problem.displacements().unwrap();
            let right = if xi == 1e-3 { [1.5, 1.5] } else { [2.0, 1.0] };
            assert!((u[0] - right[0]).abs() + (u[1] - right[1]).abs() < 1e-9, "{kind:?} {xi:e} {u:?}");
            assert_eq!(told.lock().unwrap().contains("cancel"), xi.abs() == f64::EPSILON / 2.0);
        }
    }
}

/// cos(pi/2) = 6e-17 is left where a row has been turned.
#[test]
fn a_row_of_rounding_beside_rows_of_one_is_legal_but_told() {
    let mut problem = pairs(1.0, &[[1.0; 2]]);
    let heard = told(&mut problem);
    add(&mut problem, RowKind::Inequality, &[(0, 1.0)], 0.3);
    add(&mut problem, RowKind::Inequality, &[(1, 6.1e-17)], 1.0);
    let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[1], val: &[6.1e-17], rhs: None };
    let (coefficient, bound) = (Some(&[0.3][..]), None);
    problem.add_friction(FrictionInput { dim: 1, normal: &[0], rows, coefficient, bound }).unwrap();
    problem.solve().unwrap();
    let heard = heard.lock().unwrap();
    assert!(heard.contains("contact row 1: its entries are below"), "{heard}");
    assert!(
        heard.contains("tangential row 0: the entries cancel up to rounding, or are rounding"),
        "{heard}"
    );
}
