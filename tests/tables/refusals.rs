//! What a table is refused for, each by its own text; nothing changes.

use feti_contact::error::{Error, Kind};
use feti_contact::solver::{DofTableInput, Problem, RowKind, SparseInput, Storage};

fn one_body() -> Problem {
    let mut problem = Problem::new();
    problem.add_body(2).unwrap();
    let k = SparseInput { ptr: &[0, 1, 2], col: &[0, 1], val: &[2.0; 2], storage: Storage::Lower };
    problem.set_stiffness(0, k).unwrap();
    problem
}

fn table<'a>(
    number: &'a [i64],
    ptr: &'a [usize],
    term: &'a [i64],
    coefficient: &'a [f64],
) -> DofTableInput<'a> {
    DofTableInput { number, ptr: Some(ptr), term, coefficient, constant: None }
}

fn refused(input: DofTableInput<'_>, argument: &'static str, text: &str) -> Error {
    let error = one_body().set_dof_table(input).unwrap_err();
    assert_eq!(error.kind, Kind::Argument(argument), "{error}");
    assert!(error.to_string().contains(text), "{error}");
    error
}

#[test]
fn numbers_and_terms_that_do_not_exist() {
    refused(table(&[0, 0], &[0; 3], &[], &[]), "number", "unknown 0 of the table has this number, too");
    refused(table(&[0, 2], &[0; 3], &[], &[]), "number", "no unknown of K has the number 2");
    refused(
        table(&[0, -1], &[0, 0, 1], &[2], &[1.0]),
        "term",
        "unknown 2 is outside the 2 unknowns of the table",
    );
    refused(table(&[0, 1], &[0, 0, 1], &[0], &[1.0]), "term", "unknown 1 of the table has a number of K");
    refused(table(&[0, -1], &[0, 0, 1], &[0], &[f64::NAN]), "coefficient", "not a finite number");
}

#[test]
fn a_circle_is_named_by_its_members() {
    let terms = [4, 2, 3, 1];
    let input = table(&[0, -1, -1, -1, -1], &[0, 0, 1, 2, 3, 4], &terms, &[1.0; 4]);
    let error = refused(input, "term", "in a circle: ");
    assert!(error.to_string().contains("1, 4") || error.to_string().contains("2"), "{error}");
    let input = table(&[0, -1, -1, -1], &[0, 0, 1, 2, 3], &[2, 3, 1], &[1.0; 3]);
    refused(input, "term", "in a circle: 1, 2, 3");
}

#[test]
fn values_that_are_no_numbers_and_constants_of_unknowns_that_k_has() {
    let constant =
        |constant| DofTableInput { constant: Some(constant), ..table(&[0, -1], &[0; 3], &[], &[]) };
    refused(constant(&[0.0, f64::INFINITY]), "constant", "not a finite number");
    refused(constant(&[1.0, 0.0]), "constant", "its constant is 0");
    let overflow = table(&[0, -1, -1], &[0, 0, 1, 2], &[0, 1], &[1e200; 2]);
    refused(overflow, "coefficient", "not a finite number");
}

#[test]
fn bodies_and_numbers_after_the_table_and_rows_beyond_a_shorter_one() {
    let mut problem = one_body();
    problem.set_dof_table(table(&[0, 1, -1], &[0, 0, 0, 1], &[1], &[1.0])).unwrap();
    assert_eq!(problem.add_body(1).unwrap_err().kind, Kind::State);
    assert_eq!(problem.set_numbering(0, &[5, 6]).unwrap_err().kind, Kind::State);
    super::add(&mut problem, RowKind::Equality, &[(2, 1.0)], 1.0).unwrap();
    let beyond = super::add(&mut problem, RowKind::Equality, &[(3, 1.0)], 1.0).unwrap_err();
    assert_eq!((beyond.kind, beyond.place.index), (Kind::Argument("dof"), Some(3)));
    let shorter = problem.set_dof_table(table(&[0, 1], &[0; 3], &[], &[])).unwrap_err();
    assert_eq!((shorter.kind, shorter.place.row), (Kind::Argument("n"), Some(0)), "{shorter}");
    problem.solve().unwrap();
    assert_eq!(problem.displacements().unwrap(), [0.0, 1.0]);
    problem.clear_rows(RowKind::Equality);
    problem.set_dof_table(table(&[0, 1], &[0; 3], &[], &[])).unwrap();
}
