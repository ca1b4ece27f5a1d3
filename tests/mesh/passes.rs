//! How elements come: once each, in any order, pass by pass; what is refused, and that nothing is lost then.

use crate::mesh::bodies::{apart, blocks, give_elements, solved};
use feti_contact::error::Kind;
use feti_contact::solver::{ElementStorage, Problem};

/// A bar of three springs 1, 2, 3 from the held unknown 0 to a free end.
fn springs(pieces: i64) -> Problem {
    let mut problem = Problem::new();
    problem.set_i64("pieces", pieces).unwrap();
    let body = problem.add_body(3).unwrap();
    problem.set_mesh(body, &[0, 2, 4, 6], &[-1, 0, 0, 1, 1, 2]).unwrap();
    problem
}

fn spring(k: f64) -> [f64; 4] {
    [k, -k, -k, k]
}

#[test]
fn held_unknowns_are_left_out_and_their_forces_read_back() {
    for pieces in [1, 2, 3] {
        let mut problem = springs(pieces);
        (0..3).for_each(|e| problem.add_element(0, e, 2, &spring(e as f64 + 1.0), 2).unwrap());
        problem.set_load(0, &[0.0, 0.0, 6.0]).unwrap();
        let (u, ..) = solved(&mut problem);
        for (u, known) in u.iter().zip([6.0, 9.0, 11.0]) {
            assert!((u - known).abs() < 1e-9, "{u} {known}");
        }
        let forces = problem.held_forces(0, 3).unwrap();
        assert!((forces[0] + 6.0).abs() < 1e-9 && forces[1..] == [0.0; 2]);
        for n in [4, 1000, usize::MAX / 8] {
            let error = problem.held_forces(0, n).unwrap_err();
            assert_eq!((error.kind, error.place.limit), (Kind::Argument("n"), Some(3.0)), "{error}");
        }
    }
}

#[test]
fn an_element_is_refused_with_its_number_and_nothing_is_lost() {
    let mut problem = springs(2);
    let refused = |problem: &mut Problem, e: usize, n: usize, ke: &[f64]| {
        let error = problem.add_element(0, e, n, ke, n).unwrap_err();
        assert_eq!(error.place.body, Some(0));
        (error.kind, error.place.element)
    };
    let missing = problem.solve().unwrap_err();
    assert_eq!((missing.kind, missing.place.element), (Kind::State, Some(0)));
    problem.add_element(0, 1, 2, &spring(2.0), 2).unwrap();
    assert_eq!(refused(&mut problem, 1, 2, &spring(2.0)), (Kind::State, Some(1)), "twice");
    assert_eq!(refused(&mut problem, 3, 2, &spring(2.0)), (Kind::Argument("e"), Some(3)));
    assert_eq!(refused(&mut problem, 0, 3, &[0.0; 9]), (Kind::Argument("n"), Some(0)));
    assert_eq!(refused(&mut problem, 0, 2, &[1.0, -1.0, -1.1, 1.0]), (Kind::Argument("ke"), Some(0)));
    assert_eq!(refused(&mut problem, 0, 2, &[1.0, -1.0, f64::NAN, 1.0]), (Kind::Argument("ke"), Some(0)));
    let block = [spring(1.0), spring(9.0)].concat();
    let error = problem.add_elements(0, 0, 2, &block, ElementStorage::Full).unwrap_err();
    assert_eq!((error.kind, error.place.element), (Kind::State, Some(1)), "all of a block or none");
    assert_eq!(problem.solve().unwrap_err().place.element, Some(0));
    problem.add_element(0, 0, 2, &spring(1.0), 2).unwrap();
    assert_eq!(problem.solve().unwrap_err().place.element, Some(2));
    problem.add_element(0, 2, 2, &spring(3.0), 2).unwrap();
    problem.set_load(0, &[0.0, 0.0, 6.0]).unwrap();
    assert!((solved(&mut problem).0[2] - 11.0).abs() < 1e-9);
    let mut other = Problem::new();
    other.add_body(2).unwrap();
    assert_eq!(other.add_element(0, 0, 2, &spring(1.0), 2).unwrap_err().kind, Kind::State, "before the mesh");
    let unknown = other.set_mesh(0, &[0, 2], &[0, 2]).unwrap_err();
    assert_eq!(
        (unknown.kind, unknown.place.element, unknown.place.index),
        (Kind::Argument("dof"), Some(0), Some(2))
    );
}

#[test]
fn blocks_of_elements_are_full_or_packed_triangles() {
    // unsymmetric in its places: every entry counts
    let full = [4.0, 1.0, 2.0, 1.0, 5.0, 3.0, 2.0, 3.0, 6.0];
    let mut answers = Vec::new();
    for (storage, ke) in [
        (ElementStorage::Full, &full[..]),
        (ElementStorage::Lower, &[4.0, 1.0, 2.0, 5.0, 3.0, 6.0]),
        (ElementStorage::Upper, &[4.0, 1.0, 5.0, 2.0, 3.0, 6.0]),
    ] {
        let mut problem = Problem::new();
        let body = problem.add_body(3).unwrap();
        problem.set_mesh(body, &[0, 3], &[0, 1, 2]).unwrap();
        problem.add_elements(body, 0, 1, ke, storage).unwrap();
        problem.set_load(body, &[1.0, 2.0, 3.0]).unwrap();
        answers.push(solved(&mut problem).0);
        let short = problem.add_elements(body, 0, 1, &ke[1..], storage).unwrap_err();
        assert_eq!(short.kind, Kind::Argument("nnz"));
    }
    assert!(answers[0] == answers[1] && answers[1] == answers[2], "{answers:?}");
}

#[test]
fn a_second_pass_brings_new_values_on_the_old_pattern_without_analysis() {
    let mut model = blocks(4);
    let mut problem = model.by_elements(6, true).unwrap();
    let (first, ..) = solved(&mut problem);
    let analyses = problem.work().analyses;
    model.bodies[1].young.iter_mut().for_each(|young| *young *= 3.0);
    give_elements(&mut problem, 1, &model.bodies[1]).unwrap();
    let (second, ..) = solved(&mut problem);
    assert_eq!(problem.work().analyses, analyses);
    let (fresh, ..) = solved(&mut model.by_elements(6, true).unwrap());
    assert!(apart(&second, &fresh) < 1e-9 && apart(&second, &first) > 1e-3);
    // the connectivity again, as a host does that hands everything over in every step
    let (ptr, dof) = model.bodies[1].connectivity();
    problem.set_mesh(1, &ptr, &dof).unwrap();
    assert_eq!(problem.solve().unwrap_err().place.element, Some(0));
    give_elements(&mut problem, 1, &model.bodies[1]).unwrap();
    assert_eq!(solved(&mut problem).0, second);
    assert_eq!(problem.work().analyses, analyses);
}

#[test]
fn a_body_may_be_cut_after_it_was_whole_and_the_other_way_round() {
    let model = blocks(4);
    let mut problem = model.by_elements(1, true).unwrap();
    let (whole, ..) = solved(&mut problem);
    let (ptr, dof) = model.bodies[0].connectivity();
    for pieces in [5, 1, 3] {
        problem.set_i64("pieces", pieces).unwrap();
        problem.set_mesh(0, &ptr, &dof).unwrap();
        give_elements(&mut problem, 0, &model.bodies[0]).unwrap();
        assert!(apart(&solved(&mut problem).0, &whole) < 1e-7);
        assert_eq!(problem.body_facts(0).unwrap().pieces > 1, pieces > 1);
    }
}
