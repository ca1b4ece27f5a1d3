//! The file contains the pieces of a body that is cut.

use super::*;
use crate::solver::ElementStorage;

/// A chain of six springs with its end held, cut in three, pushed against a wall.
fn chain() -> Problem {
    let mut problem = Problem::new();
    problem.set_i64("pieces", 3).unwrap();
    problem.add_body(6).unwrap();
    let places: Vec<f64> = (0..6).map(f64::from).collect();
    problem.set_coordinates(0, 1, &[0, 1, 2, 3, 4, 5], &[1; 6], &places, 1).unwrap();
    let dof: Vec<i64> = (0..6).flat_map(|e| [e - 1, e]).collect();
    problem.set_mesh(0, &[0, 2, 4, 6, 8, 10, 12], &dof).unwrap();
    let springs = (0..6).flat_map(|e| [1.0, -1.0, 1.0].map(|k| k * (3.0 + f64::from(e) / 7.0)));
    let springs: Vec<f64> = springs.collect();
    problem.add_elements(0, 0, 6, &springs, ElementStorage::Lower).unwrap();
    problem.set_load(0, &[0.0, 0.1, 0.0, 0.0, 0.0, 5.0]).unwrap();
    let wall = RowsInput { ptr: &[0, 1], body: None, dof: &[5], val: &[1.0], rhs: Some(&[0.7]) };
    problem.add_rows(RowKind::Inequality, wall).unwrap();
    problem
}

fn answer(problem: &mut Problem) -> Vec<u64> {
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let lambda = problem.multipliers(RowKind::Inequality).unwrap().to_vec();
    problem.displacements().unwrap().iter().chain(&lambda).map(|v| v.to_bits()).collect()
}

#[test]
fn a_body_that_is_cut_comes_back_as_its_pieces_and_solves_to_the_same_bits() {
    let mut problem = chain();
    let bytes = problem.write_bytes().unwrap();
    assert_eq!(bytes.len() as u64, expected_length(&problem));
    let mut back = read(&bytes).unwrap();
    assert_eq!(back.body_facts(0).unwrap().pieces, 3);
    assert_eq!(answer(&mut back), answer(&mut problem));
    assert_eq!(back.write_bytes().unwrap(), bytes, "written again it is the same file");
    assert_eq!(back.pieces(0).unwrap(), problem.pieces(0).unwrap());
    // the file does not contain the elements: the host gives them again
    let error = back.add_element(0, 0, 2, &[1.0; 4], 2).unwrap_err();
    assert_eq!(error.kind, Kind::State);
    assert_eq!(back.held_forces(0, 1).unwrap_err().kind, Kind::State);
    back.set_mesh(0, &[0, 6], &[0, 1, 2, 3, 4, 5]).unwrap();
    assert_eq!(back.solve().unwrap_err().place.element, Some(0));
}

#[test]
fn a_body_by_elements_that_is_not_cut_is_written_as_a_matrix_and_a_part_of_one_not_at_all() {
    let mut problem = chain();
    problem.add_element(0, 2, 2, &[1.0, -1.0, -1.0, 1.0], 2).unwrap();
    let error = problem.write_bytes().unwrap_err();
    assert_eq!((error.kind, error.place.element), (Kind::State, Some(0)));
    problem.set_i64("pieces", 1).unwrap();
    problem.set_mesh(0, &[0, 2, 3], &[0, 1, 2]).unwrap();
    problem.add_elements(0, 0, 2, &[1.0, -1.0, 1.0, 1.0], ElementStorage::Upper).unwrap();
    let bytes = problem.write_bytes().unwrap();
    assert!(bytes.windows(4).any(|tag| tag == b"STIF") && !bytes.windows(4).any(|tag| tag == b"PIEC"));
}

/// Two unknowns that two pieces share: the payload with one number changed.
#[test]
fn pieces_that_contradict_themselves_are_refused() {
    let payload = |change: fn(&mut Vec<u64>, &mut Vec<f64>, &mut Vec<u32>)| {
        let mut head = vec![2, 3, 4, 0, 2, 3, 0, 1, 1, 0, 1, 3, 4];
        let (mut val, mut col) = (vec![2.0, -1.0, 1.0, 4.0], vec![0, 0, 1, 0]);
        change(&mut head, &mut val, &mut col);
        let val = val.iter().flat_map(|v| v.to_le_bytes());
        let body = of_section(b"BODY", 0, &numbers(&[2]));
        let all = numbers(&head).into_iter().chain(val).chain(col.iter().flat_map(|c| c.to_le_bytes()));
        of_sections(FORMAT, &[body, of_section(b"PIEC", 0, &all.collect::<Vec<u8>>())])
    };
    let whole = read(&payload(|_, _, _| {})).unwrap();
    assert_eq!(whole.body_facts(0).unwrap().pieces, 2);
    type Change = fn(&mut Vec<u64>, &mut Vec<f64>, &mut Vec<u32>);
    let changes: [(Change, &str); 9] = [
        (|head, _, _| head[0] = 0, "at least one piece"),
        (|head, _, _| head[5] = 2, "do not go from 0 to 3"),
        (|head, _, _| head[7] = 0, "do not ascend"),
        (|head, _, _| head[8] = 2, "outside the 2 unknowns"),
        (|head, _, _| head[8] = u64::MAX, "outside the 2 unknowns"),
        (|head, _, _| head[10] = 4, "ends before it begins"),
        (|_, val, _| val[3] = f64::NAN, "not a finite number"),
        (|_, _, col| col[3] = 1, "diagonal"),
        (|_, _, col| col[1] = 1, "diagonal"),
    ];
    for (change, says) in changes {
        let error = refused(&payload(change));
        assert!(error.what.contains(says), "{says}: {error}");
    }
    let mut alone = payload(|_, _, _| {});
    alone.truncate(alone.len() - 8);
    refused(&alone);
    let unmet = numbers(&[1, 1, 1, 0, 1, 0, 0, 1, 1.0_f64.to_bits()]);
    let unmet = [unmet, 0_u32.to_le_bytes().to_vec()].concat();
    let bytes =
        of_sections(FORMAT, &[of_section(b"BODY", 0, &numbers(&[2])), of_section(b"PIEC", 0, &unmet)]);
    let error = refused(&bytes);
    assert!(error.what.contains("no piece has the unknown") && error.place.dof == Some(1), "{error}");
}
