//! The forms in which the host gives a body: its own numbers, functions, borrowed arrays, other forms of a matrix.

use super::*;
use crate::solver::{Borrowed, Columns, HostFunctions};
use std::ptr::NonNull;

#[test]
fn numbers_of_the_host_come_back_and_rows_go_by_them() {
    let mut problem = small();
    problem.set_numbering(0, &[5]).unwrap();
    problem.set_numbering(1, &[0, 9]).unwrap();
    let bytes = problem.write_bytes().unwrap();
    let mut back = read(&bytes).unwrap();
    assert_eq!(back.write_bytes().unwrap(), bytes, "written again it is the same file");
    let by_number = RowsInput { ptr: &[0, 2], body: None, dof: &[9, 5], val: &[1.0, -2.0], rhs: None };
    for problem in [&mut problem, &mut back] {
        problem.check_whole(10).unwrap();
        problem.add_rows(RowKind::Inequality, by_number).unwrap();
        assert_eq!(problem.model.contact.matrix.row(0).collect::<Vec<_>>(), [(0, 1.0), (1, -1.0)]);
        assert_eq!(problem.model.contact.matrix.row(1).collect::<Vec<_>>(), [(0, -2.0), (2, 1.0)]);
    }
    // a library that does not know the section must refuse the file
    let at = bytes.windows(4).position(|tag| tag == b"NUMB").unwrap();
    let end = at + 16 + 16 + padding(16) as usize;
    let mut section = bytes[at..end].to_vec();
    section[3] = b'X';
    let later = [&bytes[..at], &sealed(section), &bytes[end + 4..]].concat();
    let error = refused(&later);
    assert_eq!(error.kind, Kind::Unsupported);
    assert!(error.what.contains("section NUMX"), "{error}");
}

#[test]
fn what_the_coordinates_are_comes_back_and_a_file_says_nothing_of_candidates() {
    let mut problem = small();
    problem.set_coordinate_modes(1, Modes::Soft).unwrap();
    let bytes = problem.write_bytes().unwrap();
    let back = read(&bytes).unwrap();
    assert_eq!([0, 1].map(|p| back.model.bodies[p].body.coordinate_modes), [Modes::Candidates, Modes::Soft]);
    assert_eq!(back.write_bytes().unwrap(), bytes, "written again it is the same file");
    problem.set_coordinate_modes(1, Modes::Candidates).unwrap();
    assert_eq!(problem.write_bytes().unwrap(), small().write_bytes().unwrap());
    let said = [of_section(b"BODY", 0, &numbers(&[2])), of_section(b"COOF", 0, &numbers(&[1]))];
    let back = read(&of_sections(FORMAT, &said)).unwrap();
    assert_eq!(back.model.bodies[0].body.coordinate_modes, Modes::Candidates);
}

#[test]
fn a_body_given_by_functions_is_not_written_and_the_old_file_stays() {
    let folder = folder("functions");
    let path = folder.join("problem.feti");
    fs::write(&path, b"old").unwrap();
    let mut problem = small();
    let product = || Box::new(|_: &[f64], _: usize, _: &mut [f64]| 0);
    let functions = HostFunctions { kplus: product(), k: product(), concurrent: false };
    problem.set_operator(1, &[4.0, 4.0], functions).unwrap();
    for error in [problem.write_file(&path).unwrap_err(), problem.write_bytes().unwrap_err()] {
        assert_eq!((error.kind, error.place.body), (Kind::Unsupported, Some(1)), "{error}");
        assert!(error.what.contains("feti_body_operator"), "{error}");
    }
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_borrowed_matrix_is_written_like_a_copied_one_and_one_that_was_refused_is_not() {
    let (col, mut val) = ([0_u32, 0, 1], [4.0, -4.0, 4.0]);
    let mut problem = small();
    // SAFETY: the arrays live as long as the problem.
    let values = |val: &[f64; 3]| unsafe { Borrowed::new(NonNull::from(val).cast(), 3) };
    // SAFETY: as above.
    let columns = Columns::Kept(unsafe { Borrowed::new(NonNull::from(&col).cast(), 3) });
    assert!(problem.borrow_stiffness(1, &[0, 1, 3], columns, values(&val)).unwrap());
    assert!(problem.is_borrowed(1));
    let bytes = problem.write_bytes().unwrap();
    assert_eq!(bytes, small().write_bytes().unwrap());
    assert!(!read(&bytes).unwrap().is_borrowed(1));
    val[0] = f64::NAN;
    problem.borrow_values(1, values(&val)).unwrap_err();
    let error = problem.write_bytes().unwrap_err();
    assert_eq!((error.kind, error.place.body), (Kind::State, Some(1)), "{error}");
}

/// K = [4 -1; -1 3] as diagonal and rest, and dense: the file stores the lower triangle by rows for both.
#[test]
fn new_values_of_a_matrix_that_was_read_come_in_the_order_of_its_lower_triangle() {
    let mut problem = Problem::new();
    let beside = SparseInput { ptr: &[0, 0, 1], col: &[0], val: &[-1.0], storage: Storage::Lower };
    for body in [problem.add_body(2).unwrap(), problem.add_body(2).unwrap()] {
        match body {
            0 => problem.set_stiffness_split(0, &[4.0, 3.0], beside).unwrap(),
            _ => problem.set_stiffness_dense(1, 2, &[4.0, -1.0, -1.0, 3.0], 2, Storage::Full).unwrap(),
        }
    }
    let mut back = read(&problem.write_bytes().unwrap()).unwrap();
    assert_eq!(back.set_values_split(0, &[8.0, 5.0], &[-2.0]).unwrap_err().kind, Kind::State);
    let dense = [8.0, -2.0, -2.0, 5.0];
    assert_eq!(back.set_values_dense(1, 2, &dense, 2).unwrap_err().kind, Kind::State);
    problem.set_values_split(0, &[8.0, 5.0], &[-2.0]).unwrap();
    problem.set_values_dense(1, 2, &dense, 2).unwrap();
    for body in 0..2 {
        back.set_values(body, &[8.0, -2.0, 5.0]).unwrap();
    }
    assert_eq!(back.write_bytes().unwrap(), problem.write_bytes().unwrap());
}
