//! Unknowns of several bodies that share one number, solved by hand.

use crate::error::{Kind, Proof};
use crate::solver::{Problem, RowKind, RowsInput, SparseInput, Storage};

/// Springs s to the ground, each coupled by a spring 1 from its unknown 0 to an end; body p has the numbers `[10 + p,
/// 5]`.
///
/// An end pulled to u moves unknown 0 by u / (s + 1) and needs the force u - u / (s + 1): 2/3 u, 4/5 u, 8/9 u for s = 2,
/// 4, 8.
fn chains(stiffness: &[f64]) -> Problem {
    let mut problem = Problem::new();
    problem.set_i64("glue", 1).unwrap();
    for (p, s) in stiffness.iter().enumerate() {
        let body = problem.add_body(2).unwrap();
        let k = SparseInput {
            ptr: &[0, 1, 3],
            col: &[0, 0, 1],
            val: &[s + 1.0, -1.0, 1.0],
            storage: Storage::Lower,
        };
        problem.set_stiffness(body, k).unwrap();
        problem.set_numbering(body, &[10 + p as i64, 5]).unwrap();
    }
    problem
}

fn close(found: &[f64], by_hand: &[f64]) {
    let near = found.iter().zip(by_hand).all(|(a, b)| (a - b).abs() < 1e-11);
    assert!(found.len() == by_hand.len() && near, "{found:?} {by_hand:?}");
}

/// Three ends at u = 45 need 30, 36, 40 of the load 106 on number 5, which acts on the first copy.
#[test]
fn the_first_copy_has_the_load_and_the_glue_hands_on_what_the_others_take() {
    let mut problem = chains(&[2.0, 4.0, 8.0]);
    let mut f = vec![0.0; 13];
    f[5] = 106.0;
    problem.set_all_loads(&f).unwrap();
    let report = problem.solve().unwrap();
    assert_eq!((report.sizes.rows, report.sizes.equalities), (0, 0));
    close(problem.displacements().unwrap(), &[15.0, 45.0, 9.0, 45.0, 5.0, 45.0]);
    let r = problem.reactions(None).unwrap();
    close(&r, &[0.0, -76.0, 0.0, 36.0, 0.0, 40.0]);
    close(&problem.reactions(Some(RowKind::Equality)).unwrap(), &[0.0; 6]);
    let mut by_number = [7.0; 13];
    problem.spread(&problem.summed(r).unwrap(), |at, v| by_number[at] = v).unwrap();
    close(&by_number[10..], &[0.0; 3]);
    close(&by_number[5..7], &[0.0, 7.0]);
    problem.spread(problem.displacements().unwrap(), |at, v| by_number[at] = v).unwrap();
    close(&[by_number[5], by_number[10], by_number[11], by_number[12]], &[45.0, 15.0, 9.0, 5.0]);
    assert_eq!(problem.findings().unwrap().untouched, [0; 0]);
    assert_eq!(problem.dual_rhs(&mut []).unwrap_err().kind, Kind::State);
    assert_eq!(problem.dual_apply(&[], &mut []).unwrap_err().kind, Kind::State);
}

/// A wall stops all ends at u = 9, where they need 6, 7.2 and 8 of the load 106 on the last one; the wall carries the
/// rest.
#[test]
fn a_row_by_number_acts_on_the_first_copy() {
    let mut problem = chains(&[2.0, 4.0, 8.0]);
    let wall = RowsInput { ptr: &[0, 1], body: None, dof: &[5], val: &[1.0], rhs: Some(&[9.0]) };
    problem.add_rows(RowKind::Inequality, wall).unwrap();
    assert_eq!(problem.model.contact.matrix.row(0).collect::<Vec<_>>(), [(1, 1.0)]);
    problem.set_load(2, &[0.0, 106.0]).unwrap();
    problem.solve().unwrap();
    close(problem.multipliers(RowKind::Inequality).unwrap(), &[106.0 - 21.2]);
    close(&problem.reactions(Some(RowKind::Inequality)).unwrap(), &[0.0, -84.8, 0.0, 0.0, 0.0, 0.0]);
    close(&problem.reactions(None).unwrap(), &[0.0, 6.0, 0.0, 7.2, 0.0, -98.0]);
}

#[test]
fn numbers_are_shared_on_request_alone_and_the_request_stays_while_they_are() {
    let mut problem = chains(&[2.0, 4.0]);
    let twice = problem.set_numbering(1, &[5, 5]).unwrap_err();
    assert_eq!((twice.kind, twice.place.dof), (Kind::Argument("number"), Some(1)));
    assert!(twice.what.contains("another unknown of the body"), "{twice}");
    for (refused, argument) in
        [(problem.set_i64("glue", 0), "value"), (problem.set_text("threads=1 glue=0"), "text")]
    {
        let error = refused.unwrap_err();
        assert_eq!(error.kind, Kind::Argument(argument));
        assert!(error.what.contains("stays 1"), "{error}");
    }
    assert_eq!((problem.get_i64("glue").unwrap(), problem.get_i64("threads").unwrap()), (1, 0));
    problem.set_numbering(0, &[10, 6]).unwrap();
    problem.set_i64("glue", 0).unwrap();
    let error = problem.set_numbering(0, &[10, 5]).unwrap_err();
    assert!(error.what.contains("option glue = 1"), "{error}");
}

/// Numbers are set and removed in any order: the first body with a number represents it.
#[test]
fn a_number_that_a_body_gives_up_is_that_of_the_next_one() {
    let mut problem = chains(&[2.0, 4.0, 8.0]);
    assert_eq!(problem.model.unknowns[&5], (0, 1));
    problem.set_numbering(0, &[10, 99]).unwrap();
    assert_eq!(problem.model.unknowns[&5], (1, 1));
    problem.set_numbering(0, &[5, 10]).unwrap();
    assert_eq!((problem.model.unknowns[&5], problem.model.unknowns.get(&99)), ((0, 0), None));
    let ends: Vec<_> =
        problem.model.joints().unwrap().iter().map(|joint| (joint.number, joint.ends)).collect();
    assert_eq!(ends, [(5, [0, 3]), (5, [3, 5])]);
}

/// Two ends held apart by rows of the host: by one row, by two, and by two of different kinds through three bodies.
#[test]
fn a_contradiction_with_the_glue_is_told_by_the_rows_of_the_host_and_the_number() {
    let told = |given: &[(RowKind, &[i64], &[f64], f64)], base: i64| {
        let mut problem = chains(&[2.0, 4.0, 8.0]);
        problem.set_i64("index_base", base).unwrap();
        for (kind, body, val, rhs) in given {
            let dof = vec![1; body.len()];
            let row =
                RowsInput { ptr: &[0, body.len()], body: Some(body), dof: &dof, val, rhs: Some(&[*rhs]) };
            problem.add_rows(*kind, row).unwrap();
        }
        let error = problem.solve().unwrap_err();
        assert_eq!((error.kind, error.place.index), (Kind::GapsContradict, Some(5)), "{error}");
        let Some(Proof::Rows { weights, heaviest, .. }) = error.proof.as_deref() else { panic!("{error:?}") };
        assert!(*heaviest < given.len(), "{error:?}");
        (error.what.clone(), weights.iter().map(|at| at.0).collect::<Vec<_>>())
    };
    let apart = told(&[(RowKind::Equality, &[0, 1], &[1.0, -1.0], 1.0)], 0);
    let says = "this equality row and the glue of the unknowns with number 5 contradict each other";
    assert!(apart.0.starts_with(says) && apart.1 == [0], "{apart:?}");
    let (one, two) =
        ((RowKind::Equality, &[0][..], &[1.0][..], 1.0), (RowKind::Equality, &[1][..], &[1.0][..], 2.0));
    let apart = told(&[one, two], 1);
    let says =
        "this equality row, another row and the glue of the unknowns with number 6 contradict each other";
    assert!(apart.0.starts_with(says) && apart.1 == [0, 1], "{apart:?}");
    let below = (RowKind::Inequality, &[2][..], &[1.0][..], 0.5);
    let apart = told(&[below, one], 0);
    assert!(apart.0.contains("another row and the glue") && apart.1 == [0, 1], "{apart:?}");
}
