//! Bodies and rows given on several ranks: the bits of one rank, whoever gives what.

mod forms;
mod made;
mod mistakes;
mod surfaces;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use crate::error::{Error, Kind};
use crate::ranks::loopback::linked;
use crate::ranks::Ranks;
use crate::serving::Rank;
use crate::solver::tests::lent::{set_chains, N};
use crate::solver::{LogLevel, Outcome, Problem, Reply, RowKind, RowsInput};

/// Runs `host` on every rank, each with its part of a problem; what the ranks return.
fn on_ranks<T: Send>(size: usize, host: impl Fn(usize, &mut Problem) -> T + Sync) -> Vec<T> {
    let (leader, others) = linked(size);
    let run = |ranks: Arc<Ranks>| {
        let (number, mut problem) = (ranks.rank, Problem::new());
        problem.join(Rank::new(ranks)).unwrap();
        host(number, &mut problem)
    };
    std::thread::scope(|scope| {
        let others: Vec<_> = others.into_iter().map(|ranks| scope.spawn(|| run(ranks))).collect();
        let first = run(leader);
        let rest = others.into_iter().map(|thread| thread.join().unwrap());
        std::iter::once(first).chain(rest).collect()
    })
}

/// Chain p of springs; the first is held. Its unknowns have the numbers from 10 p.
fn add_chain(problem: &mut Problem, p: usize) -> usize {
    let body = problem.add_body(N).unwrap();
    set_chains(problem, body, &[2.0 + (p % 3) as f64], p == 0);
    number_chain(problem, body, p);
    body
}

/// Numbers and load of chain p.
fn number_chain(problem: &mut Problem, body: usize, p: usize) {
    let numbers: Vec<i64> = (0..N as i64).map(|i| 10 * p as i64 + i).collect();
    problem.set_numbering(body, &numbers).unwrap();
    let mut f = [0.0; N];
    (f[N - 1], f[1]) = (-1.0 - p as f64 / 8.0, 0.25);
    problem.set_load(body, &f).unwrap();
}

/// The begin of chain p rests on the end of the one before.
fn add_row(problem: &mut Problem, p: usize) {
    let numbers = [10 * p as i64 - 10 + N as i64 - 1, 10 * p as i64];
    let rows = RowsInput { ptr: &[0, 2], body: None, dof: &numbers, val: &[1.0, -1.0], rhs: Some(&[0.1]) };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

/// u, lambda and what rows do to every chain, of a problem of `count` chains.
fn serial(count: usize) -> (Vec<Vec<u64>>, Vec<u64>, Vec<Vec<u64>>) {
    let mut problem = Problem::new();
    for p in 0..count {
        add_chain(&mut problem, p);
    }
    (1..count).for_each(|p| add_row(&mut problem, p));
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let u = (0..count).map(|p| bits(problem.displacement(p).unwrap())).collect();
    let lambda = bits(problem.multipliers(RowKind::Inequality).unwrap());
    let reaction = |p: usize| {
        let mut r = [0.0; N];
        problem.reaction(None, p, &mut r).unwrap();
        bits(&r)
    };
    (u, lambda, (0..count).map(reaction).collect())
}

/// A rank may have rows alone; what rows do to its bodies is nothing.
#[test]
fn the_last_rank_has_a_row_and_no_body() {
    let reactions = on_ranks(3, |rank, problem| {
        if rank < 2 {
            add_chain(problem, rank);
        } else {
            add_row(problem, 1);
        }
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
        problem.reactions(None).unwrap().len()
    });
    assert_eq!(reactions, [N, N, 0]);
}

#[test]
fn chains_on_several_ranks_have_the_bits_of_one() {
    const COUNT: usize = 6;
    let (u, lambda, reactions) = serial(COUNT);
    for size in [2, 3, 4] {
        // bodies and rows on ranks of their own choice, in falling order
        let has_body = |rank: usize, p: usize| (3 * p + 1) % size == rank;
        let has_row = |rank: usize, p: usize| (p * p) % size == rank;
        on_ranks(size, |rank, problem| {
            let bodies: Vec<usize> = (0..COUNT).rev().filter(|p| has_body(rank, *p)).collect();
            for p in &bodies {
                add_chain(problem, *p);
            }
            let rows: Vec<usize> = (1..COUNT).rev().filter(|p| has_row(rank, *p)).collect();
            rows.iter().for_each(|p| add_row(problem, *p));
            for _ in 0..2 {
                assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved, "{size}");
                for (body, p) in bodies.iter().enumerate() {
                    assert_eq!(bits(problem.displacement(body).unwrap()), u[*p], "{size}: u of {p}");
                    let mut r = [0.0; N];
                    problem.reaction(None, body, &mut r).unwrap();
                    assert_eq!(bits(&r), reactions[*p], "{size}: reaction of {p}");
                }
                let own: Vec<u64> = rows.iter().map(|p| lambda[p - 1]).collect();
                assert_eq!(bits(problem.multipliers(RowKind::Inequality).unwrap()), own);
            }
        });
    }
}

fn failed(problem: &mut Problem) -> Error {
    problem.solve().unwrap_err()
}

#[test]
fn an_error_names_its_rank_on_all_ranks() {
    let errors = on_ranks(3, |rank, problem| {
        add_chain(problem, rank);
        add_row(problem, 1);
        if rank == 2 {
            problem.add_body(N).unwrap();
        }
        failed(problem)
    });
    let places: Vec<_> = errors.iter().map(|e| (e.kind, e.place.rank, e.place.body)).collect();
    assert_eq!(places, [(Kind::State, Some(2), Some(1)); 3]);
}

/// Rank 1 and rank 2 hold the end of chain 0 at different places.
#[test]
fn rows_of_two_ranks_that_contradict_each_other_are_named_by_their_own_numbers() {
    let ends = on_ranks(3, |rank, problem| {
        add_chain(problem, rank);
        let row = |problem: &mut Problem, number: i64, at: f64| {
            let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[number], val: &[1.0], rhs: Some(&[at]) };
            problem.add_rows(RowKind::Equality, rows).unwrap();
        };
        if rank > 0 {
            (0..rank as i64).for_each(|k| row(problem, 10 * rank as i64 + k, 0.0));
            row(problem, 4, rank as f64);
        }
        let error = failed(problem);
        let findings = problem.findings().unwrap();
        let rows: Vec<_> = findings.rows(RowKind::Equality).collect();
        (error, rows)
    });
    for (error, _) in &ends {
        assert_eq!((error.kind, error.place.rank, error.place.row), (Kind::GapsContradict, Some(2), Some(2)));
        assert!(error.what.contains("equality row 1 of rank 1"), "{error}");
    }
    let rows: Vec<_> = ends.into_iter().map(|(_, rows)| rows).collect();
    assert!(rows[0].is_empty() && rows[1].len() == 1 && rows[2].len() == 1, "{rows:?}");
    assert!((rows[1][0].0, rows[2][0].0) == (1, 2) && rows[1][0].1 * rows[2][0].1 < 0.0, "{rows:?}");
}

/// Rank 0 hears of a step, and another thread cancels on rank 1 alone.
#[test]
fn a_cancel_on_one_rank_ends_the_call_on_all() {
    let (sender, receiver) = std::sync::mpsc::channel::<Arc<AtomicBool>>();
    let (sender, receiver) = (Mutex::new(sender), Mutex::new(receiver));
    let outcomes = on_ranks(3, |rank, problem| {
        (0..4).filter(|p| p % 3 == rank).for_each(|p| drop(vec![add_chain(problem, p)]));
        (1..4).filter(|p| p % 3 == rank).for_each(|p| add_row(problem, p));
        if rank == 1 {
            sender.lock().unwrap().send(problem.canceller()).unwrap();
        }
        if rank == 0 {
            let flag = receiver.lock().unwrap().recv().unwrap();
            problem.on_progress(Some(Box::new(move |_| {
                flag.store(true, Ordering::Relaxed);
                Reply::Continue
            })));
        }
        let first = problem.solve().map(|report| report.outcome).map_err(|error| error.kind);
        problem.on_progress(None);
        (first, problem.solve().map(|report| report.outcome).map_err(|error| error.kind))
    });
    for (first, second) in outcomes {
        assert!(first == Err(Kind::Cancelled) || first == Ok(Outcome::Cancelled), "{first:?}");
        assert_eq!(second, Ok(Outcome::Solved), "the next call begins anew");
    }
}

#[test]
fn the_log_on_rank_0_names_rows_and_failed_bodies_by_rank_and_number() {
    let lines = Arc::new(Mutex::new(String::new()));
    let file =
        |rank: usize| std::env::temp_dir().join(format!("feti log of rank {rank} {}", std::process::id()));
    on_ranks(3, |rank, problem| {
        problem.set_str("log_file", file(rank).to_str().unwrap()).unwrap();
        add_chain(problem, rank);
        if rank == 1 {
            add_row(problem, 2);
            let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[14], val: &[1.0], rhs: Some(&[-0.5]) };
            problem.add_rows(RowKind::Inequality, rows).unwrap();
        }
        let heard = Arc::clone(&lines);
        if rank == 2 {
            problem.set_text("tolerance=1e-9 threads=1").unwrap();
        }
        problem.on_log(Some((
            LogLevel::Phase,
            Box::new(move |_, line: &str| {
                heard.lock().unwrap().push_str(line);
                heard.lock().unwrap().push('\n');
                0
            }),
        )));
        // nothing holds chain 2, which is pulled down
        problem.solve().unwrap_err();
    });
    let lines = lines.lock().unwrap();
    assert!(lines.contains("most in row 1 of rank 1: c = -5.0e-1"), "{lines}");
    assert!(lines.contains("rank 2, body 0") || lines.contains("rank 1, body 0"), "{lines}");
    assert!(
        lines.contains("the options of rank 0 count (none); rank 2 has others (tolerance=1e-9)"),
        "{lines}"
    );
    assert_eq!(lines.matches("3 bodies, 15 unknowns").count(), 1, "rank 0 alone tells: {lines}");
    let written: Vec<String> = (0..3).map(|rank| std::fs::read_to_string(file(rank)).unwrap()).collect();
    assert_eq!(
        written.iter().map(String::len).sum::<usize>(),
        lines.len(),
        "each file has the lines of its rank"
    );
    assert!(written[0].contains("3 bodies, 15 unknowns"), "{written:?}");
    (0..3).for_each(|rank| std::fs::remove_file(file(rank)).unwrap());
}
