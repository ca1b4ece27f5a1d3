//! Equality rows over all of 200 thousand unknowns: sums whose rounding, term after term, is far more than that of their terms.

use feti_contact::solver::{Modes, Problem, RowKind, RowsInput, SparseInput, Storage};

use crate::scales::solved;

const SIDE: usize = 450;
const NODES: usize = SIDE * SIDE;

/// A free membrane of SIDE x SIDE nodes; two rows hold its mean and a weighted mean, both at `travel`.
fn membrane(travel: f64) -> Problem {
    let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
    for i in 0..NODES {
        let (x, y) = (i % SIDE, i / SIDE);
        let neighbours = [(y > 0).then(|| i - SIDE), (x > 0).then(|| i - 1)].into_iter().flatten();
        for j in neighbours {
            col.push(j as i64);
            val.push(-1.0);
        }
        col.push(i as i64);
        val.push(
            [x > 0, y > 0, x + 1 < SIDE, y + 1 < SIDE].map(|there| f64::from(u8::from(there))).iter().sum(),
        );
        ptr.push(col.len());
    }
    let mut problem = Problem::new();
    let body = problem.add_body(NODES).unwrap();
    let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
    problem.set_stiffness(body, k).unwrap();
    problem.set_null_space(body, NODES, 1, &[1.0; NODES], NODES, Modes::Exact).unwrap();
    let dof: Vec<i64> = (0..2 * NODES).map(|k| (k % NODES) as i64).collect();
    let val: Vec<f64> = (0..NODES).map(|_| 1.0).chain((0..NODES).map(|i| i as f64 / NODES as f64)).collect();
    let rhs = [&val[..NODES], &val[NODES..]].map(|row| travel * row.iter().sum::<f64>());
    let rows = RowsInput { ptr: &[0, NODES, 2 * NODES], body: None, dof: &dof, val: &val, rhs: Some(&rhs) };
    problem.add_rows(RowKind::Equality, rows).unwrap();
    problem
}

/// Nothing but the two rows acts: all nodes move by their common mean, and no row has a force.
#[test]
fn two_rows_over_all_unknowns_of_a_large_body_are_certified_to_the_rounding_of_their_terms() {
    let mut problem = membrane(0.1);
    let mut answer = solved(&mut problem);
    assert!(answer.u.iter().all(|u| (u - 0.1).abs() < 1e-9));
    assert!(problem.check(&answer.u, &[], &answer.mu).unwrap().passed());
    // 450 eps, far less than what plain sums get wrong here, is no rounding of the terms
    answer.u.iter_mut().for_each(|u| *u *= 1.0 + 1e-13);
    assert!(!problem.check(&answer.u, &[], &answer.mu).unwrap().passed());
}
