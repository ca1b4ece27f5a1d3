//! Connected parts of one K lent to other ranks.

use crate::body::{Lending, Name};
use crate::solver::tests::lent::{served, set_chains, solved, N};
use crate::solver::{Problem, RowKind, RowsInput};

/// Chains of these springs in one K, the first held, each pushed to the one before.
fn chains_in_one(stiffness: &[f64], lending: Option<Lending>) -> Problem {
    let mut problem = Problem::new();
    problem.prepared.lending = lending;
    let body = problem.add_body(N * stiffness.len()).unwrap();
    set_chains(&mut problem, body, stiffness, true);
    let f: Vec<f64> = (0..N * stiffness.len()).map(|i| if i % N == N - 1 { -1.0 } else { 0.125 }).collect();
    problem.set_load(body, &f).unwrap();
    (1..stiffness.len()).for_each(|p| touch(&mut problem, [N * p - 1, N * p], 0.1));
    problem
}

fn touch(problem: &mut Problem, [i, j]: [usize; 2], gap: f64) {
    let (dof, val) = ([i as i64, j as i64], [1.0, -1.0]);
    let rows = RowsInput { ptr: &[0, 2], body: Some(&[0, 0]), dof: &dof, val: &val, rhs: Some(&[gap]) };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
}

/// Those here keep it, and those that need it again get it from the host's.
#[test]
fn a_lent_part_of_a_matrix_has_no_copy_of_it_on_rank_0() {
    let served = served(|_, _| None);
    let stiffness = [4.0, 3.0, 2.0, 1.0, 5.0];
    let (mut lent, mut alone) =
        (chains_in_one(&stiffness, served.lending()), chains_in_one(&stiffness, None));
    let mut agree = |change: fn(&mut Problem), lent: &mut Problem| {
        change(&mut alone);
        change(lent);
        assert_eq!(solved(lent), solved(&mut alone));
    };
    let here = |problem: &Problem| {
        let parts = problem.solved().bodies.iter();
        parts.map(|given| given.body.stiffness.is_some()).collect::<Vec<_>>()
    };
    let at_first = [false, false, true, false, false];
    agree(|_| {}, &mut lent);
    assert_eq!(here(&lent), at_first);
    let factorised = served.asked(Name::Factorise);
    agree(|problem| problem.set_load(0, &[-0.5; 5 * N]).unwrap(), &mut lent);
    agree(|problem| touch(problem, [2, N + 2], 0.05), &mut lent);
    assert_eq!((here(&lent), served.asked(Name::Factorise)), (at_first.to_vec(), factorised), "new rows");
    agree(|problem| set_chains(problem, 0, &[4.0, 3.0, 2.0, 8.0, 5.0], true), &mut lent);
    assert_eq!(here(&lent), at_first, "new values");
    served.leader.end().unwrap();
    agree(|problem| problem.set_load(0, &[-0.25; 5 * N]).unwrap(), &mut lent);
    assert_eq!(here(&lent), [true; 5], "without other ranks");
    drop(lent);
    served.end();
}
