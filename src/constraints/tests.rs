//! Rows as given.

use super::*;

fn input<'a>(body: Option<&'a [i64]>, dof: &'a [i64], val: &'a [f64]) -> RowsInput<'a> {
    RowsInput { ptr: &[0, 3], body, dof, val, rhs: None }
}

#[test]
fn repeated_entries_of_a_row_are_added_up() {
    let mut rows = RowSet::default();
    assert_eq!(
        rows.add(RowKind::Inequality, input(Some(&[1, 0, 1]), &[2, 0, 2], &[1.0, 4.0, 2.0]), &[0, 3, 6])
            .unwrap(),
        0
    );
    assert_eq!(rows.matrix.row(0).collect::<Vec<_>>(), [(0, 4.0), (5, 3.0)]);
    assert_eq!(
        rows.add(RowKind::Inequality, input(None, &[5, 5, 1], &[1.0, -1.0, 2.0]), &[0, 3, 6]).unwrap(),
        1
    );
    assert_eq!(rows.matrix.row(1).collect::<Vec<_>>(), [(1, 2.0)]);
}

#[test]
fn a_refused_row_leaves_nothing_behind() {
    let mut rows = RowSet::default();
    let error = rows
        .add(RowKind::Inequality, input(Some(&[0, 1, 2]), &[0, 0, 0], &[1.0; 3]), &[0, 3, 6])
        .unwrap_err();
    assert_eq!((error.kind, error.place.row, error.place.entry), (Kind::Argument("body"), Some(0), Some(2)));
    let error = rows
        .add(RowKind::Inequality, input(Some(&[0, 1, 1]), &[0, 3, 0], &[1.0; 3]), &[0, 3, 6])
        .unwrap_err();
    assert_eq!((error.kind, error.place.entry), (Kind::Argument("dof"), Some(1)));
    assert_eq!(rows.len(), 0);
}

#[test]
fn an_empty_row_is_refused_only_where_it_cannot_hold() {
    let mut rows = RowSet::default();
    let empty = |rhs| RowsInput { ptr: &[0, 0], body: None, dof: &[], val: &[], rhs: Some(rhs) };
    rows.add(RowKind::Inequality, empty(&[1.0]), &[0, 3]).unwrap();
    assert!(rows.check_empty_rows(RowKind::Inequality, 0.0).is_ok());
    rows.add(RowKind::Inequality, empty(&[-1.0]), &[0, 3]).unwrap();
    let error = rows.check_empty_rows(RowKind::Inequality, 0.0).unwrap_err();
    assert_eq!((error.kind, error.place.row), (Kind::GapsContradict, Some(1)));
}

#[test]
fn a_row_between_a_soft_and_a_stiff_body_weighs_as_the_soft_one() {
    let mut matrix = Csr::empty(2);
    matrix.push_row([(0, 1.0), (1, -1.0)]);
    let mut rows = RowSet {
        matrix: Arc::new(matrix),
        rhs: vec![0.0],
        compliance: vec![0.0].into(),
        ..RowSet::default()
    };
    let s = row_scales(&rows, &[4.0, 4e12], 1.0);
    assert!((s[0] - 2.0).abs() < 1e-11);
    rows.set_compliance(0, &[0.75]).unwrap(); // 1/4 + 3/4 = 1, D and 1/k in the same unit
    assert!((row_scales(&rows, &[4.0, 4e12], 1.0)[0] - 1.0).abs() < 1e-11);
    rows.set_compliance(0, &[0.75 / 8.0]).unwrap();
    assert!((row_scales(&rows, &[4.0, 4e12], 8.0)[0] - 1.0).abs() < 1e-11);
}

#[test]
fn entries_that_add_up_to_no_number_are_refused() {
    let mut rows = RowSet::default();
    let error =
        rows.add(RowKind::Inequality, input(None, &[5, 5, 1], &[1e308, 1e308, 2.0]), &[0, 3, 6]).unwrap_err();
    assert_eq!((error.kind, error.place.row), (Kind::Argument("val"), Some(0)));
    assert_eq!(rows.len(), 0);
}

#[test]
fn a_refused_value_is_named_by_its_row_and_a_row_that_is_not_there_comes_first() {
    let mut rows = RowSet::default();
    for _ in 0..3 {
        rows.add(RowKind::Inequality, input(None, &[5, 5, 1], &[1.0, -1.0, 2.0]), &[0, 3, 6]).unwrap();
    }
    let bad = [0.0, f64::NAN];
    for error in
        [rows.set_rhs(RowKind::Inequality, 1, &bad).unwrap_err(), rows.set_compliance(1, &bad).unwrap_err()]
    {
        assert_eq!((error.place.row, error.place.entry), (Some(2), Some(1)));
    }
    for first in [3, usize::MAX] {
        assert_eq!(rows.set_rhs(RowKind::Inequality, first, &bad).unwrap_err().kind, Kind::Argument("first"));
        assert_eq!(rows.set_compliance(first, &bad).unwrap_err().kind, Kind::Argument("first"));
    }
    assert_eq!((rows.rhs, rows.compliance), (vec![0.0; 3], vec![0.0; 3].into()));
}

#[test]
fn a_compliance_is_finite_and_not_negative_and_belongs_to_a_row() {
    let mut rows = RowSet::default();
    rows.add(RowKind::Inequality, input(None, &[5, 5, 1], &[1.0, -1.0, 2.0]), &[0, 3, 6]).unwrap();
    rows.add(RowKind::Inequality, input(None, &[5, 4, 1], &[1.0, -1.0, 2.0]), &[0, 3, 6]).unwrap();
    rows.set_compliance(1, &[0.5]).unwrap();
    for value in [-1e-300, f64::NAN, f64::INFINITY] {
        let error = rows.set_compliance(0, &[3.0, value]).unwrap_err();
        assert_eq!((error.kind, error.place.row), (Kind::Argument("inv_k"), Some(1)));
    }
    assert_eq!(rows.set_compliance(1, &[1.0, 1.0]).unwrap_err().kind, Kind::Argument("rows"));
    assert_eq!(rows.set_compliance(2, &[1.0]).unwrap_err().kind, Kind::Argument("first"));
    assert_eq!(*rows.compliance, [0.0, 0.5]);
}

#[test]
fn a_compliant_row_without_entries_is_a_spring_by_itself() {
    let mut rows = RowSet::default();
    let empty = RowsInput { ptr: &[0, 0, 0], body: None, dof: &[], val: &[], rhs: Some(&[-3.0, 3.0]) };
    rows.add(RowKind::Inequality, empty, &[0, 3]).unwrap();
    rows.set_compliance(0, &[0.5, 0.5]).unwrap();
    assert!([RowKind::Inequality, RowKind::Equality]
        .iter()
        .all(|kind| rows.check_empty_rows(*kind, 0.0).is_ok()));
    let forces = |kind| rows.forces_without_entries(kind).collect::<Vec<_>>();
    assert_eq!(forces(RowKind::Inequality), [6.0, 0.0]);
    assert_eq!(forces(RowKind::Equality), [6.0, -6.0]);
    assert_eq!([rows.open_gap(0, &[0.0; 3], 6.0), rows.open_gap(1, &[0.0; 3], -6.0)], [0.0, 0.0]);
}
