//! Forms of K on several ranks: elements of bodies that are cut, functions of the host.

use super::{add_row, bits, number_chain, on_ranks, serial, N};
use crate::error::Kind;
use crate::setup::Work;
use crate::solver::{ElementStorage, HostFunctions, Outcome, Problem, RowKind, RowsInput};

const COUNT: usize = 4;

/// Springs of chain p as elements; the first of the held chain joins its begin to the ground.
fn add_springs(problem: &mut Problem, body: usize, p: usize, by: f64) {
    let dof: Vec<i64> = (1..N as i64).flat_map(|i| [i - 1, i]).chain((p == 0).then_some(0)).collect();
    let mut ptr: Vec<usize> = (0..N).map(|e| 2 * e).collect();
    ptr.extend((p == 0).then_some(dof.len()));
    problem.set_mesh(body, &ptr, &dof).unwrap();
    let k = by * (2.0 + (p % 3) as f64);
    let mut values: Vec<f64> = (1..N).flat_map(|_| [k, -k, k]).collect();
    values.extend((p == 0).then_some(k));
    problem.add_elements(body, 0, ptr.len() - 1, &values, ElementStorage::Lower).unwrap();
}

/// Entries of these chains are whole numbers: sums of elements have the bits of the matrix, in any order.
#[test]
fn bodies_that_the_options_cut_are_whole_on_several_ranks_and_keep_their_analyses() {
    let (u, lambda, _) = serial(COUNT);
    on_ranks(3, |rank, problem| {
        problem.set_i64("pieces", 2).unwrap();
        let own: Vec<usize> = (0..COUNT).filter(|p| p % 3 == rank).collect();
        for &p in &own {
            let body = problem.add_body(N).unwrap();
            add_springs(problem, body, p, 1.0);
            number_chain(problem, body, p);
        }
        let rows: Vec<usize> = (1..COUNT).filter(|p| p % 2 == rank).collect();
        rows.iter().for_each(|p| add_row(problem, *p));
        for by in [1.0, 4.0, 1.0] {
            own.iter().enumerate().for_each(|(body, p)| add_springs(problem, body, *p, by));
            assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
        }
        for (body, p) in own.iter().enumerate() {
            assert_eq!(bits(problem.displacement(body).unwrap()), u[*p], "chain {p}");
        }
        let own: Vec<u64> = rows.iter().map(|p| lambda[p - 1]).collect();
        assert_eq!(bits(problem.multipliers(RowKind::Inequality).unwrap()), own);
        let Work { analyses, factorisations, .. } = problem.report().unwrap().work;
        assert!(analyses <= COUNT && factorisations > COUNT, "{analyses} {factorisations}");
    });
}

/// One unknown between springs of 4: K and K+ by functions, which return `fails`.
fn add_functions(problem: &mut Problem, fails: i32) -> usize {
    let body = problem.add_body(1).unwrap();
    let product = |by: f64| {
        move |x: &[f64], _: usize, y: &mut [f64]| {
            y.iter_mut().zip(x).for_each(|(y, x)| *y = by * x);
            fails
        }
    };
    let functions =
        HostFunctions { kplus: Box::new(product(0.25)), k: Box::new(product(4.0)), concurrent: false };
    problem.set_operator(body, &[4.0], functions).unwrap();
    problem.set_null_space(body, 1, 0, &[], 1, crate::solver::Modes::Exact).unwrap();
    problem.set_numbering(body, &[-1 + 10 * COUNT as i64]).unwrap();
    body
}

#[test]
fn functions_of_the_host_are_called_on_rank_0_and_refused_on_others() {
    for at in 0..2 {
        let ends = on_ranks(2, |rank, problem| {
            let body = if rank == at { Some(add_functions(problem, 0)) } else { None };
            super::add_chain(problem, rank);
            if rank == 0 {
                add_row(problem, 1);
                // the end of chain 1 is 1 from it
                let number = [10 + N as i64 - 1, 10 * COUNT as i64 - 1];
                let rows = RowsInput {
                    ptr: &[0, 2],
                    body: None,
                    dof: &number,
                    val: &[-1.0, 1.0],
                    rhs: Some(&[1.0]),
                };
                problem.add_rows(RowKind::Inequality, rows).unwrap();
            }
            let ended = problem.solve().map(|report| report.outcome);
            (ended, body.and_then(|body| problem.displacement(body).ok().map(<[f64]>::to_vec)))
        });
        if at == 0 {
            assert!(ends.iter().all(|(ended, _)| *ended == Ok(Outcome::Solved)), "{ends:?}");
            continue;
        }
        for (ended, _) in ends {
            let error = ended.unwrap_err();
            assert_eq!(
                (error.kind, error.place.rank, error.place.body),
                (Kind::Unsupported, Some(1), Some(0))
            );
        }
    }
}

#[test]
fn a_function_of_rank_0_that_fails_is_told_to_all() {
    let ends = on_ranks(3, |rank, problem| {
        super::add_chain(problem, rank);
        if rank == 0 {
            add_functions(problem, -7);
        }
        problem.solve().unwrap_err()
    });
    for error in ends {
        assert_eq!(
            (error.kind, error.place.rank, error.place.body),
            (Kind::Callback, Some(0), Some(1)),
            "{error}"
        );
    }
}
