use super::*;
use crate::error::Kind;

fn contact() -> RowSet {
    let mut contact = RowSet::default();
    let rows = RowsInput { ptr: &[0, 1, 2], body: None, dof: &[0, 2], val: &[1.0, 1.0], rhs: None };
    contact.add(RowKind::Inequality, rows, &[0, 4]).unwrap();
    contact
}

fn input<'a>(normal: &'a [i64], coefficient: &'a [f64], val: &'a [f64]) -> FrictionInput<'a> {
    let ptr: &[usize] = if normal.len() == 1 { &[0, 1] } else { &[0, 1, 2] };
    let rows = RowsInput { ptr, body: None, dof: &[1, 3], val, rhs: None };
    let rows = RowsInput { dof: &rows.dof[..normal.len()], val: &val[..normal.len()], ..rows };
    FrictionInput { dim: 1, normal, rows, coefficient: Some(coefficient), bound: None }
}

#[test]
fn a_refused_node_is_named_and_leaves_nothing_behind() {
    let (contact, mut friction) = (contact(), Friction::default());
    let mut refused = |given: FrictionInput| friction.add(given, &contact, &[0, 4]).unwrap_err();
    for (error, argument, node) in [
        (refused(input(&[0, 2], &[0.5; 2], &[1.0; 2])), "normal_row", 1),
        (refused(input(&[1, 1], &[0.5; 2], &[1.0; 2])), "normal_row", 1),
        (refused(input(&[0, -2], &[0.5; 2], &[1.0; 2])), "normal_row", 1),
        (refused(input(&[0, -1], &[0.5; 2], &[1.0; 2])), "normal_row", 1),
        (refused(input(&[0, 1], &[0.5, -0.1], &[1.0; 2])), "coefficient", 1),
        (refused(input(&[0, 1], &[f64::NAN, 0.1], &[1.0; 2])), "coefficient", 0),
        (refused(input(&[0, 1], &[0.5; 2], &[1.0, f64::NAN])), "val", 1),
    ] {
        assert_eq!((error.kind, error.place.node), (Kind::Argument(argument), Some(node)));
    }
    assert_eq!((friction.len(), friction.rows.len(), friction.dim), (0, 0, 0));
    assert_eq!(friction.add(input(&[1], &[0.5], &[1.0]), &contact, &[0, 4]).unwrap(), 0);
    let taken = friction.add(input(&[1], &[0.5], &[1.0]), &contact, &[0, 4]).unwrap_err();
    assert_eq!((taken.kind, taken.place.row), (Kind::Argument("normal_row"), Some(1)));
    let other = FrictionInput { dim: 2, ..input(&[0], &[0.5], &[1.0]) };
    assert_eq!(friction.add(other, &contact, &[0, 4]).unwrap_err().kind, Kind::Argument("dim"));
}

/// A frame turned in its plane, 1 to 2000 long, is refused; if one of its unknowns is struck out, or the rows touch others,
/// they tell nothing.
#[test]
fn different_factors_are_refused_where_no_support_can_have_shortened_a_row() {
    let (s, c) = 0.7f64.sin_cos();
    let ends = |normal: &[(usize, f64)], tangents: &[&[(usize, f64)]]| {
        let rows = |given: &[&[(usize, f64)]]| {
            let mut ptr = vec![0];
            given.iter().for_each(|row| ptr.push(ptr[ptr.len() - 1] + row.len()));
            let all = given.concat();
            let dof: Vec<i64> = all.iter().map(|(j, _)| *j as i64).collect();
            (ptr, dof, all.iter().map(|(_, v)| *v).collect::<Vec<_>>())
        };
        let (ptr, dof, val) = rows(&[normal]);
        let mut contact = RowSet::default();
        let input = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: None };
        contact.add(RowKind::Inequality, input, &[0, 4]).unwrap();
        let (ptr, dof, val) = rows(tangents);
        let rows = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: None };
        let input = FrictionInput { dim: tangents.len(), normal: &[0], rows, coefficient: None, bound: None };
        let refused = Friction::check_factors(input, |row| entries(&contact, row), &[0, 4]);
        refused.map_err(|error| error.place.value)
    };
    let [n, t] = [2000.0, 1.0].map(|l| [[(0, l * c), (1, l * s)], [(0, -l * s), (1, l * c)]]);
    let end = ends(&n[0], &[&t[1]]);
    assert!(
        end.is_err_and(|ratio| (ratio.unwrap() - 2e3).abs() < 1e-9),
        "lengths of 2000 and 1 are refused, with their ratio: {end:?}"
    );
    assert!(ends(&t[0], &[&n[1]]).is_err());
    assert!(ends(&n[0], &[&n[1]]).is_ok());
    // x struck out of a frame that is turned a little
    assert!(ends(&[(1, 1.0)], &[&[(1, 3e-4)]]).is_ok());
    let turned = [[3e-4, 1.0, 0.0], [3e-4 * c, 0.0, 1.0], [1.0, -3e-4, -3e-4 * c]];
    let [a, b, x] = turned.map(|row| [(1, row[1] + 0.1 * row[2]), (2, row[2] - 0.1 * row[1])]);
    assert!(ends(&a, &[&b, &x]).is_ok() && ends(&x, &[&a, &b]).is_ok());
    assert!(ends(&[(0, 1.0)], &[&[(1, 9e-4)]]).is_ok());
}

/// Of nodes that come one after the other.
#[test]
fn a_row_whose_entries_cancel_is_noticed_by_its_own_number() {
    let (contact, mut friction) = (contact(), Friction::default());
    friction.add(input(&[0], &[0.5], &[1.0]), &contact, &[0, 4]).unwrap();
    let rows = RowsInput { ptr: &[0, 3], body: None, dof: &[1, 1, 1], val: &[0.1, 0.2, -0.3], rhs: None };
    let second = FrictionInput { dim: 1, normal: &[1], rows, coefficient: None, bound: None };
    friction.add(second, &contact, &[0, 4]).unwrap();
    assert_eq!(friction.rows.cancelled(), [1]);
}

#[test]
fn laws_compliances_and_slips_are_those_of_the_nodes_named() {
    let (contact, mut friction) = (contact(), Friction::default());
    friction.add(input(&[0, -1], &[0.5, 0.0], &[1.0; 2]), &contact, &[0, 4]).unwrap();
    assert!(!friction.set_law(0, 1, Some(&[0.25]), None, &contact).unwrap());
    assert!(friction.set_law(1, 1, None, Some(&[3.0]), &contact).unwrap());
    let refused = friction.set_law(1, 1, Some(&[0.1]), None, &contact).unwrap_err();
    assert_eq!(refused.kind, Kind::Argument("coefficient"));
    friction.set_compliance(1, &[0.125]).unwrap();
    assert!(!friction.set_reference(0, 2, 1, &[1.0, 2.0]).unwrap());
    assert_eq!(friction.set_reference(0, 2, 2, &[1.0; 4]).unwrap_err().kind, Kind::Argument("dim"));
    assert_eq!(friction.set_compliance(2, &[1.0]).unwrap_err().kind, Kind::Argument("first"));
    assert_eq!(friction.set_compliance(1, &[1.0; 2]).unwrap_err().kind, Kind::Argument("nodes"));
    assert_eq!((friction.rows.rhs, friction.rows.compliance), (vec![1.0, 2.0], vec![0.0, 0.125].into()));
    let bounds: Vec<_> = friction.nodes.iter().map(|node| (node.coefficient, node.bound)).collect();
    assert_eq!(bounds, [(0.25, 0.0), (0.0, 3.0)]);
}
