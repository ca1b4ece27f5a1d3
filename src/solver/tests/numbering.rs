//! The host's own numbers of the unknowns.

use crate::error::Kind;
use crate::solver::{Problem, RowKind, RowsInput, SparseInput, Storage};

/// Two springs of stiffness 2 and 4 from the ground, each with a free unknown coupled by 1 to it.
fn pairs() -> Problem {
    let mut problem = Problem::new();
    for s in [2.0, 4.0] {
        let body = problem.add_body(2).unwrap();
        let k = SparseInput {
            ptr: &[0, 1, 3],
            col: &[0, 0, 1],
            val: &[s + 1.0, -1.0, 1.0],
            storage: Storage::Lower,
        };
        problem.set_stiffness(body, k).unwrap();
    }
    problem
}

#[test]
fn a_number_names_one_unknown_of_all_bodies() {
    let mut problem = pairs();
    problem.set_numbering(0, &[7, 3]).unwrap();
    for (numbers, dof, says) in [
        ([3, 8], 0, "another body"),
        ([8, 7], 1, "another body"),
        ([5, 5], 1, "another unknown"),
        ([-1, 2], 0, "no array"),
        ([0, i64::MAX], 1, "no array"),
    ] {
        let error = problem.set_numbering(1, &numbers).unwrap_err();
        assert!(error.what.contains(says), "{error}");
        assert_eq!((error.kind, error.place.body), (Kind::Argument("number"), Some(1)));
        assert_eq!((error.place.dof, error.place.entry), (Some(dof), Some(dof)), "{numbers:?}");
    }
    // a body may permute its own numbers, and numbers it no longer uses are free
    problem.set_numbering(0, &[3, 7]).unwrap();
    problem.set_numbering(0, &[3, 1]).unwrap();
    problem.set_numbering(1, &[7, 0]).unwrap();
    assert_eq!(problem.model.unknowns.len(), 4);
}

#[test]
fn all_bodies_have_numbers_or_none_when_they_are_used() {
    let mut problem = pairs();
    assert!(problem.check_whole(4).is_ok());
    assert_eq!(problem.check_whole(5).unwrap_err().kind, Kind::Argument("n"));
    problem.set_numbering(1, &[5, 0]).unwrap();
    let error = problem.set_all_loads(&[0.0; 6]).unwrap_err();
    assert_eq!((error.kind, error.place.body), (Kind::State, Some(0)));
    problem.set_numbering(0, &[2, 1]).unwrap();
    assert!(problem.check_whole(6).is_ok() && problem.check_whole(9).is_ok());
    assert_eq!(problem.check_whole(5).unwrap_err().place.limit, Some(6.0));
    problem.add_body(1).unwrap();
    assert_eq!(problem.check_whole(6).unwrap_err().place.body, Some(2));
}

/// The end of the first pair is pushed by 1: u = 1/2, 3/2; that of the second by 2: u = 1/2, 5/2.
#[test]
fn loads_rows_and_displacements_go_by_the_numbers() {
    for (numbers, f) in [
        (None, vec![0.0, 1.0, 0.0, 2.0]),
        (Some([[6, 2], [0, 3]]), vec![0.0, f64::NAN, 1.0, 2.0, f64::NAN, 0.0, 0.0, 9.0]),
    ] {
        let mut problem = pairs();
        let place = |body: usize, dof: usize| {
            numbers.map_or(2 * body + dof, |numbers: [[i64; 2]; 2]| numbers[body][dof] as usize)
        };
        for (body, numbers) in numbers.iter().flatten().enumerate() {
            problem.set_numbering(body, numbers).unwrap();
        }
        problem.set_all_loads(&f).unwrap();
        let mut bad = f.clone();
        bad[place(1, 1)] = f64::INFINITY;
        let error = problem.set_all_loads(&bad).unwrap_err();
        assert_eq!(
            (error.place.body, error.place.dof, error.place.entry),
            (Some(1), Some(1), Some(place(1, 1)))
        );
        let dof = [place(1, 1) as i64, place(0, 1) as i64];
        let far = RowsInput { ptr: &[0, 2], body: None, dof: &dof, val: &[1.0, -1.0], rhs: Some(&[9.0]) };
        problem.add_rows(RowKind::Inequality, far).unwrap();
        assert_eq!(problem.model.contact.matrix.row(0).collect::<Vec<_>>(), [(1, -1.0), (3, 1.0)]);
        let nobody = RowsInput { dof: &[place(0, 0) as i64, 11], ..far };
        let error = problem.add_rows(RowKind::Inequality, nobody).unwrap_err();
        assert_eq!(
            (error.kind, error.place.row, error.place.entry),
            (Kind::Argument("dof"), Some(0), Some(1))
        );
        problem.solve().unwrap();
        let mut u = vec![7.0; f.len()];
        problem.spread(problem.displacements().unwrap(), |at, v| u[at] = v).unwrap();
        for (body, dof, by_hand) in [(0, 0, 0.5), (0, 1, 1.5), (1, 0, 0.5), (1, 1, 2.5)] {
            assert!((u[place(body, dof)] - by_hand).abs() < 1e-12, "{u:?}");
        }
        assert_eq!(u.iter().filter(|v| **v == 7.0).count(), f.len() - 4);
    }
}
