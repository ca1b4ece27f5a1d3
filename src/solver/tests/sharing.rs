//! Bodies that share factors and analyses.

use crate::solver::{Problem, RowKind, RowsInput, Storage};

/// Six free chains of springs of 1, 2 and 3 times `stiffness`; rows tie the middle dofs together in sequence and hold the
/// first end of each chain.
fn chains(stiffness: [f64; 6]) -> Problem {
    let mut problem = Problem::new();
    for s in stiffness {
        let k = [1.0, -1.0, 0.0, 0.0, -1.0, 3.0, -2.0, 0.0, 0.0, -2.0, 5.0, -3.0, 0.0, 0.0, -3.0, 3.0];
        let body = problem.add_body(4).unwrap();
        problem.set_stiffness_dense(body, 4, &k.map(|v| s * v), 4, Storage::Full).unwrap();
        problem.set_load(body, &[0.1, 0.02 * body as f64, -0.7, 0.3]).unwrap();
    }
    let rows = |ptr: &[usize], dof: &[i64], val: &[f64], rhs: &[f64], problem: &mut Problem, kind| {
        problem.add_rows(kind, RowsInput { ptr, body: None, dof, val, rhs: Some(rhs) }).unwrap();
    };
    let ties: Vec<i64> = (0..5).flat_map(|p| [4 * p + 1, 4 * p + 5]).collect();
    rows(&[0, 2, 4, 6, 8, 10], &ties, &[1.0, -1.0].repeat(5), &[0.0; 5], &mut problem, RowKind::Equality);
    let ends: Vec<i64> = (0..6).map(|p| 4 * p).collect();
    rows(&[0, 1, 2, 3, 4, 5, 6], &ends, &[-1.0; 6], &[0.01; 6], &mut problem, RowKind::Inequality);
    problem
}

/// u of all bodies, lambda, mu.
fn answer(problem: &mut Problem) -> Vec<f64> {
    problem.solve().unwrap();
    let mut all: Vec<f64> = (0..6).flat_map(|p| problem.displacement(p).unwrap().to_vec()).collect();
    all.extend(problem.multipliers(RowKind::Inequality).unwrap());
    all.extend(problem.multipliers(RowKind::Equality).unwrap());
    all
}

/// Bodies with different keys are never compared.
#[test]
fn answers_have_the_same_bits_whether_bodies_share_or_not() {
    for (stiffness, expected) in [([1.0; 6], [1, 1]), ([1.0, 1.3, 1.0, 1.3, 1.7, 1.0], [1, 3])] {
        let (mut shared, mut apart) = (chains(stiffness), chains(stiffness));
        apart.prepared.set_keys(&apart.model, |p| [p as u64; 2]);
        assert!(answer(&mut shared) == answer(&mut apart), "bits differ");
        assert_eq!([shared.work().analyses, shared.work().factorisations], expected);
        assert_eq!([apart.work().analyses, apart.work().factorisations], [6, 6]);
    }
}

#[test]
fn keys_alone_make_no_two_bodies_equal() {
    let stiffness = [1.0, 1.1, 1.2, 1.3, 1.4, 1.5];
    let (mut honest, mut colliding) = (chains(stiffness), chains(stiffness));
    colliding.prepared.set_keys(&colliding.model, |_| [7; 2]);
    assert!(answer(&mut honest) == answer(&mut colliding), "bits differ");
    assert_eq!(colliding.work().factorisations, 6);
}
