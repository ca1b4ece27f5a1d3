//! Why a problem of cut bodies has no answer is told of the bodies of the host.

use crate::mesh::bodies::{apart, blocks, solved, Model};
use feti_contact::error::{Kind, Proof};
use feti_contact::solver::{RowKind, RowsInput};

fn pulled() -> Model {
    let mut model = blocks(4);
    model.loads[1].iter_mut().for_each(|f| *f = -*f);
    model
}

#[test]
fn a_load_that_nothing_holds_is_named_with_the_motion_of_the_body() {
    let model = pulled();
    let told = [1, 7].map(|pieces| {
        let mut problem = model.by_elements(pieces, true).unwrap();
        let error = problem.solve().unwrap_err();
        assert_eq!((error.kind, error.place.body), (Kind::LoadNotHeld, Some(1)), "{error}");
        let motion = problem.findings().unwrap().motion.unwrap();
        (problem.escaping_motion(1).unwrap().to_vec(), problem.escaping_motion(0).unwrap().to_vec(), motion)
    });
    assert!(apart(&told[1].0, &told[0].0) < 1e-6, "{:e}", apart(&told[1].0, &told[0].0));
    assert_eq!(told[1].1, vec![0.0; told[1].1.len()]);
    assert!(apart(&told[1].2, &told[0].2) < 1e-6, "{:?} {:?}", told[1].2, told[0].2);
}

#[test]
fn gaps_that_contradict_each_other_are_told_by_rows_of_the_host() {
    let model = blocks(3);
    let mut problem = model.by_elements(6, true).unwrap();
    let top = model.bodies[1].numbers().1 as i64 - 1;
    let rows = RowsInput {
        ptr: &[0, 1, 2],
        body: Some(&[1, 1]),
        dof: &[top, top],
        val: &[1.0, -1.0],
        rhs: Some(&[1.0, -2.0]),
    };
    let first = problem.add_rows(RowKind::Inequality, rows).unwrap();
    let error = problem.solve().unwrap_err();
    assert_eq!(error.kind, Kind::GapsContradict, "{error}");
    let Some(Proof::Rows { weights, .. }) = error.proof.as_deref() else { panic!("{error:?}") };
    assert_eq!(weights.iter().map(|at| at.0).collect::<Vec<_>>(), [first, first + 1]);
    let equal = RowsInput {
        ptr: &[0, 1, 2],
        body: Some(&[1, 1]),
        dof: &[top, top],
        val: &[1.0, 1.0],
        rhs: Some(&[1.0, 2.0]),
    };
    let mut problem = model.by_elements(6, true).unwrap();
    problem.add_rows(RowKind::Equality, equal).unwrap();
    let error = problem.solve().unwrap_err();
    assert_eq!(error.kind, Kind::GapsContradict, "{error}");
    let Some(Proof::Rows { weights, .. }) = error.proof.as_deref() else { panic!("{error:?}") };
    assert_eq!(weights.iter().map(|at| at.0).collect::<Vec<_>>(), [model.rows.len(), model.rows.len() + 1]);
}

#[test]
fn an_indefinite_body_is_named_with_its_unknown() {
    let mut model = blocks(3);
    model.bodies[1].young[13] = -5.0;
    let error = model.by_elements(4, true).unwrap().solve().unwrap_err();
    assert_eq!((error.kind, error.place.body), (Kind::Indefinite, Some(1)), "{error}");
    assert!(error.place.dof.unwrap() < model.bodies[1].numbers().1);
}

/// What takes most memory is named: a body, and of one that is cut the first element of its piece.
#[test]
fn a_limit_of_memory_names_the_piece_that_exceeds_it_and_loses_nothing() {
    let model = blocks(4);
    for (pieces, is_cut) in [(1, false), (3, true)] {
        let (answer, ..) = solved(&mut model.by_elements(pieces, true).unwrap());
        let mut problem = model.by_elements(pieces, true).unwrap();
        problem.set_i64("memory_limit", 1000).unwrap();
        for error in [problem.setup().unwrap_err(), problem.solve().unwrap_err()] {
            assert_eq!((error.kind, error.place.limit), (Kind::Memory, Some(1000.0)), "{error}");
            let body = error.place.body.unwrap();
            assert!(body < 2 && error.place.element.is_some() == is_cut, "{error}");
            let Some(element) = error.place.element else { continue };
            let (ptr, dof) = model.bodies[body].connectivity();
            let piece_of = problem.pieces(body).unwrap();
            // an unknown of several pieces has the first one: that of an element is its highest
            let of = |e: usize| {
                dof[ptr[e]..ptr[e + 1]].iter().filter(|j| **j >= 0).map(|j| piece_of[*j as usize]).max()
            };
            assert!((0..element).all(|e| of(e) != of(element)), "{error}");
        }
        problem.set_i64("memory_limit", 0).unwrap();
        assert_eq!(solved(&mut problem).0, answer);
    }
}

#[test]
fn motions_left_open_are_those_of_the_bodies() {
    // nothing but normal forces on a flat plane: the upper body may slide and turn
    let mut model = blocks(3);
    model.rows.iter_mut().for_each(|row| row.1 = 0.0);
    let open = [1, 5].map(|pieces| {
        let mut problem = model.by_elements(pieces, true).unwrap();
        solved(&mut problem);
        let count = problem.report().unwrap().undetermined;
        let motions: Vec<_> = (0..count).map(|k| problem.open_motion(k).unwrap()).collect();
        assert!(motions.iter().all(|motion| motion.body == Some(1) && motion.motion.is_some()));
        count
    });
    assert_eq!(open, [3, 3]);
}
