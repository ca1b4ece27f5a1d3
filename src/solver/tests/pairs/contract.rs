//! Numbers of rows, order of calls, refusals.

use super::*;
use crate::error::{Error, Kind};
use crate::solver::{PairField, RigidShape, RowKind, RowsInput};

fn foot() -> (Problem, Block, usize, usize) {
    let upper = block(&[0.0, 0.0], &[2.0, 1.0], &[4, 2], |x| x[1] == 1.0);
    let mut problem = Problem::new();
    let body = upper.give(&mut problem);
    let slave = upper.surface(&mut problem, body, false);
    (problem, upper, body, slave)
}

fn plane(problem: &mut Problem, y: f64) -> usize {
    problem.surface_rigid(2, RigidShape::Plane, &[0.0, y, 0.0, 1.0]).unwrap()
}

fn host_row(problem: &mut Problem) -> usize {
    let rows = RowsInput { ptr: &[0, 1], body: Some(&[0]), dof: &[0], val: &[1.0], rhs: Some(&[0.5]) };
    problem.add_rows(RowKind::Inequality, rows).unwrap()
}

#[test]
fn rows_of_pairs_come_first_and_keep_their_numbers() {
    let (mut problem, _, _, slave) = foot();
    let (near, far) = (plane(&mut problem, -0.01), plane(&mut problem, -0.5));
    let first = problem.pair_add(slave, near, PairMethod::NodeToFace, false, 0.1).unwrap();
    let second = problem.pair_add(slave, far, PairMethod::NodeToFace, false, 0.1).unwrap();
    assert_eq!((first, second), ((0, 0), (1, 5)));
    assert_eq!(host_row(&mut problem), 10);
    let error = problem.pair_add(slave, far, PairMethod::NodeToFace, false, 0.1).unwrap_err();
    assert_eq!((error.kind, error.place.row), (Kind::State, Some(10)));
    problem.pairs_find().unwrap();
    let rows = &problem.model.contact;
    assert!((0..5).all(|i| (rows.rhs[i] - 0.01).abs() < 1e-15 && !rows.is_empty_row(i)));
    assert!((5..10).all(|i| rows.rhs[i] == f64::INFINITY && rows.is_empty_row(i)), "nodes without partner");
    assert_eq!((rows.rhs[10], rows.len()), (0.5, 11));
    // of a pair that is switched off none closes
    problem.pair_set(0, "on", &[0.0]).unwrap();
    problem.pairs_find().unwrap();
    assert!(problem.model.contact.rhs[..10].iter().all(|c| *c == f64::INFINITY));
    problem.pair_set(0, "on", &[1.0]).unwrap();
    problem.pairs_find().unwrap();
    problem.clear_rows(RowKind::Inequality);
    assert_eq!((problem.sizes().rows, problem.model.contact.rhs[0]), (10, 0.01));
    assert_eq!(host_row(&mut problem), 10);
}

#[test]
fn a_second_find_has_the_same_rows_and_leaves_the_setup() {
    let (mut problem, _, _, slave) = foot();
    let master = plane(&mut problem, 0.01);
    let made = pair(&mut problem, slave, master, 0.1);
    problem.pair_set(made, "friction", &[0.2]).unwrap();
    problem.pairs_find().unwrap();
    problem.solve().unwrap();
    let before =
        (problem.model.contact.clone(), problem.work(), problem.pair_field(made, PairField::Force).unwrap());
    problem.pairs_find().unwrap();
    assert!(problem.model.contact.same_but_rhs(&before.0) && problem.model.contact.rhs == before.0.rhs);
    assert_eq!(problem.pair_field(made, PairField::Force).unwrap(), before.2, "the answer is still there");
    problem.solve().unwrap();
    assert_eq!(problem.work(), before.1);
}

#[test]
fn offsets_and_adjusted_gaps_belong_to_their_nodes() {
    let (mut problem, upper, _, slave) = foot();
    let master = plane(&mut problem, -0.01);
    let made = pair(&mut problem, slave, master, 0.1);
    let offset: Vec<f64> = (0..upper.nodes()).map(|node| if node == 1 { 0.004 } else { 0.0 }).collect();
    problem.pair_set(made, "offset", &offset).unwrap();
    problem.pair_set(made, "adjust", &[0.007]).unwrap();
    problem.pairs_find().unwrap();
    let c = |problem: &Problem| problem.model.contact.rhs.clone();
    let near =
        |found: Vec<f64>, expected: [f64; 5]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15);
    assert!(near(c(&problem), [0.01, 0.0, 0.01, 0.01, 0.01]), "{:?}", c(&problem));
    problem.surface_move(master, &[0.0, -0.02, 0.0, 1.0], 2).unwrap();
    problem.pairs_find().unwrap();
    assert!(
        near(c(&problem), [0.02, 0.01, 0.02, 0.02, 0.02]),
        "what was adjusted stays so: {:?}",
        c(&problem)
    );
}

#[test]
fn a_held_node_that_overlaps_is_named_with_its_pair_and_rounding_is_not() {
    METHODS.into_iter().for_each(held_node);
}

fn held_node(method: PairMethod) {
    let upper = block(&[0.0, 0.0], &[2.0, 1.0], &[4, 2], |x| x[0] == 0.0);
    let mut problem = Problem::new();
    let body = upper.give(&mut problem);
    let slave = upper.surface(&mut problem, body, false);
    let master = plane(&mut problem, 1e-17);
    let made = pair_by(&mut problem, method, slave, master, 0.1);
    problem.pairs_find().unwrap();
    assert_eq!(problem.model.contact.rhs[0], f64::INFINITY, "switched off");
    assert!(problem.model.contact.rhs[1] < 1e-15);
    let facts = problem.pair_info(made).unwrap();
    assert!(facts.held == 1 && facts.held_overlap <= 1e-16, "{facts:?}");
    let before = problem.model.contact.rhs.clone();
    problem.surface_move(master, &[0.0, 1e-3, 0.0, 1.0], 2).unwrap();
    let error = problem.pairs_find().unwrap_err();
    assert_eq!((error.kind, error.place.pair, error.place.node), (Kind::GapsContradict, Some(made), Some(0)));
    assert_eq!(problem.model.contact.rhs, before, "a find that fails changes nothing");
}

#[test]
fn a_compliant_node_whose_faces_have_lost_their_area_is_named() {
    let (mut problem, upper, _, slave) = foot();
    let master = plane(&mut problem, 0.0);
    let made = pair(&mut problem, slave, master, 1.0);
    problem.pair_set(made, "compliance", &[1.0]).unwrap();
    problem.surface_move(slave, &vec![0.0; 2 * upper.nodes()], 2).unwrap();
    let error = problem.pairs_find().unwrap_err();
    assert_eq!((error.kind, error.place.pair, error.place.node), (Kind::State, Some(made), Some(0)));
}

#[test]
fn misuse_is_refused_with_its_argument() {
    let (mut problem, upper, body, slave) = foot();
    let master = plane(&mut problem, 0.0);
    let kind = |error: Error| error.kind;
    let argument = Kind::Argument;
    let (x, dof) = (upper.x.clone(), upper.dof.clone());
    let mut add = |dim, x: &[f64], dof: &[i64]| {
        kind(problem.surface_add(Some(body), dim, x, dim, Some((dof, dim))).unwrap_err())
    };
    let mut bad = x.clone();
    bad[3] = f64::NAN;
    assert_eq!(add(2, &bad, &dof), argument("x"));
    assert_eq!(add(4, &x, &dof), argument("dim"));
    assert_eq!(add(2, &x, &dof[2..]), argument("dof"));
    let mut out = dof.clone();
    out[4] = upper.free as i64;
    let error = problem.surface_add(Some(body), 2, &x, 2, Some((&out, 2))).unwrap_err();
    assert_eq!((error.kind, error.place.node, error.place.entry), (argument("dof"), Some(2), Some(4)));
    let error = problem.surface_add(Some(7), 2, &x, 2, Some((&dof, 2))).unwrap_err();
    assert_eq!(error.kind, argument("body"));
    let tool = problem.surface_add(None, 2, &x, 2, None).unwrap();
    let solid = problem.surface_rigid(3, RigidShape::Sphere, &[0.0, 0.0, 0.0, 1.0]).unwrap();
    let mut pair_of = |slave, master, distance| {
        kind(problem.pair_add(slave, master, PairMethod::NodeToFace, false, distance).unwrap_err())
    };
    assert_eq!(pair_of(slave, slave, 1.0), Kind::Unsupported);
    assert_eq!(pair_of(slave, solid, 1.0), argument("master"), "dimensions");
    assert_eq!(pair_of(slave, tool, 1.0), argument("master"), "no faces");
    assert_eq!(pair_of(tool, master, 1.0), argument("slave"), "no unknowns");
    assert_eq!(pair_of(master, slave, 1.0), argument("slave"), "rigid");
    assert_eq!(pair_of(slave, 9, 1.0), argument("master"));
    for distance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(pair_of(slave, master, distance), argument("distance"));
    }
    let cloud = problem.surface_add(Some(body), 2, &x, 2, Some((&dof, 2))).unwrap();
    let refused = problem.pair_add(cloud, master, PairMethod::Mortar, false, 1.0).unwrap_err();
    assert_eq!(kind(refused), Kind::Unsupported, "a cloud has no areas");
    let made = pair(&mut problem, slave, master, 1.0);
    assert_eq!(kind(problem.surface_faces(slave, Shape::Line2, &[0, 1]).unwrap_err()), Kind::State);
    assert_eq!(kind(problem.surface_move(slave, &x[2..], 2).unwrap_err()), argument("x"));
    assert_eq!(kind(problem.surface_move(slave, &bad, 2).unwrap_err()), argument("x"));
    for (name, value) in
        [("friction", -1.0), ("angle", 181.0), ("on", 0.5), ("thickness", 0.0), ("offset", f64::NAN)]
    {
        let error = problem.pair_set(made, name, &[value]).unwrap_err();
        assert_eq!((error.kind, error.place.pair), (argument("value"), Some(made)), "{name}");
    }
    assert_eq!(kind(problem.pair_set(made, "stiffness", &[1.0]).unwrap_err()), argument("name"));
    assert_eq!(kind(problem.pair_set(made, "depth", &[1.0, 1.0]).unwrap_err()), argument("n"));
    assert_eq!(kind(problem.pair_set(5, "depth", &[1.0]).unwrap_err()), argument("pair"));
    assert_eq!(kind(problem.pair_field(made, PairField::Force).unwrap_err()), Kind::State, "no answer");
    host_row(&mut problem);
    let rows = RowsInput { ptr: &[0, 1], body: Some(&[0]), dof: &[1], val: &[1.0], rhs: None };
    let input = crate::solver::FrictionInput { dim: 1, normal: &[5], rows, coefficient: None, bound: None };
    problem.add_friction(input).unwrap();
    assert_eq!(
        kind(problem.pair_set(made, "friction", &[0.1]).unwrap_err()),
        Kind::State,
        "after nodes of the host"
    );
}
