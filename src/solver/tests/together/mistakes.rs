//! What one rank does wrong is told on all, with its rank and its numbers; and the same problem without the mistake is solved.

use super::{add_chain, add_row, on_ranks, N};
use crate::error::{Error, Kind};
use crate::solver::{Call, FrictionInput, Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

/// Ranks of every problem; each has a chain, and the contact row of its lower end.
const RANKS: usize = 3;

fn give(problem: &mut Problem, rank: usize) {
    add_chain(problem, rank);
    if rank > 0 {
        add_row(problem, rank);
    }
}

/// Rank `by` makes the mistake, in each of its ways in turn; what all ranks hear.
fn told(mistake: impl Fn(&mut Problem, bool) -> Result<Outcome, Error> + Sync) -> Vec<Vec<Error>> {
    (0..RANKS)
        .map(|by| {
            on_ranks(RANKS, |rank, problem| {
                give(problem, rank);
                mistake(problem, rank == by).unwrap_err()
            })
        })
        .collect()
}

fn solved(problem: &mut Problem) -> Result<Outcome, Error> {
    problem.solve().map(|report| report.outcome)
}

/// All ranks hear the same, with the rank that has made the mistake.
fn are_equal(all: &[Vec<Error>], kind: Kind) {
    for (by, errors) in all.iter().enumerate() {
        for error in errors {
            assert_eq!((error.kind, error.place.rank), (kind, Some(by)), "{error}");
            assert_eq!((&error.what, &error.place), (&errors[0].what, &errors[0].place));
        }
    }
}

fn row(problem: &mut Problem, kind: RowKind, numbers: &[i64], val: &[f64], rhs: f64) {
    let rows = RowsInput { ptr: &[0, numbers.len()], body: None, dof: numbers, val, rhs: Some(&[rhs]) };
    problem.add_rows(kind, rows).unwrap();
}

#[test]
fn a_body_without_matrix() {
    let errors = told(|problem, wrong| {
        if wrong {
            problem.add_body(2).unwrap();
            problem.set_numbering(1, &[900, 901]).unwrap();
        }
        solved(problem)
    });
    are_equal(&errors, Kind::State);
    assert!(errors.iter().flatten().all(|error| error.place.body == Some(1)));
}

#[test]
fn a_body_without_numbers() {
    let errors = told(|problem, wrong| {
        if wrong {
            add_unnumbered(problem, &[1.0, -0.5, 1.0]);
        }
        solved(problem)
    });
    are_equal(&errors, Kind::State);
}

/// Two unknowns with these entries of K.
fn add_unnumbered(problem: &mut Problem, k: &[f64; 3]) -> usize {
    let body = problem.add_body(2).unwrap();
    let input = SparseInput { ptr: &[0, 1, 3], col: &[0, 0, 1], val: k, storage: Storage::Lower };
    problem.set_stiffness(body, input).unwrap();
    body
}

#[test]
fn a_number_of_nobody() {
    let errors = told(|problem, wrong| {
        if wrong {
            row(problem, RowKind::Inequality, &[0, 999], &[1.0, -1.0], 0.0);
        }
        solved(problem)
    });
    are_equal(&errors, Kind::Argument("dof"));
    assert!(errors
        .iter()
        .flatten()
        .all(|error| error.place.index == Some(999) && error.place.entry == Some(1)));
}

#[test]
fn a_number_of_two_ranks_without_glue() {
    let errors = told(|problem, wrong| {
        if wrong {
            let body = add_unnumbered(problem, &[1.0, -0.5, 1.0]);
            problem.set_numbering(body, &[3, 900]).unwrap_or_else(|_| {
                problem.set_numbering(body, &[13, 900]).unwrap();
            });
        }
        solved(problem)
    });
    // rank 0 has number 3 itself, and takes one of rank 1
    for error in errors.iter().flatten() {
        assert_eq!(error.kind, Kind::Argument("number"), "{error}");
        assert!(error.what.contains("glue = 1"), "{error}");
    }
}

#[test]
fn a_matrix_that_is_indefinite_and_a_null_space_that_is_none() {
    let indefinite = told(|problem, wrong| {
        if wrong {
            let body = add_unnumbered(problem, &[1.0, 2.0, 1.0]);
            problem.set_numbering(body, &[900, 901]).unwrap();
        }
        solved(problem)
    });
    are_equal(&indefinite, Kind::Indefinite);
    let wrong_basis = told(|problem, wrong| {
        if wrong {
            problem.set_null_space(0, N, 1, &[1.0, 2.0, 0.0, 4.0, 1.0], N, Modes::Exact).unwrap();
        }
        solved(problem)
    });
    are_equal(&wrong_basis, Kind::NullSpace);
    let bodies: Vec<_> = [indefinite, wrong_basis].concat().concat().iter().map(|e| e.place.body).collect();
    assert!(bodies.iter().all(|body| *body == Some(1) || *body == Some(0)));
}

#[test]
fn a_load_that_nothing_holds() {
    let errors = told(|problem, wrong| {
        if wrong {
            let body = add_unnumbered(problem, &[1.0, -1.0, 1.0]);
            problem.set_numbering(body, &[900, 901]).unwrap();
            problem.set_load(body, &[1.0, 1.0]).unwrap();
        }
        solved(problem)
    });
    are_equal(&errors, Kind::LoadNotHeld);
    assert!(errors.iter().flatten().all(|error| error.place.body == Some(1)));
}

/// Unknown 0 has no stiffness, and is in no part that is solved; of the two springs behind it the second has a load.
#[test]
fn the_connected_part_that_escapes_is_named_whichever_rank_has_its_body() {
    let errors = told(|problem, wrong| {
        if wrong {
            let body = problem.add_body(5).unwrap();
            let (ptr, col) = ([0, 0, 1, 3, 4, 6], [1, 1, 2, 3, 3, 4]);
            let val = [1.0, -1.0, 1.0, 2.0, -2.0, 2.0];
            let input = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
            problem.set_stiffness(body, input).unwrap();
            problem.set_numbering(body, &[900, 901, 902, 903, 904]).unwrap();
            problem.set_load(body, &[0.0, 0.0, 0.0, 1.0, 0.0]).unwrap();
        }
        let error = problem.solve().unwrap_err();
        let found = problem.findings().unwrap().place.component;
        assert_eq!(found, error.place.component);
        Err(error)
    });
    are_equal(&errors, Kind::LoadNotHeld);
    for error in errors.iter().flatten() {
        assert_eq!((error.place.body, error.place.component), (Some(1), Some(2)), "{error}");
    }
}

#[test]
fn the_sizes_of_all_ranks_are_known_after_a_failure_too() {
    let sizes = on_ranks(RANKS, |rank, problem| {
        give(problem, rank);
        let alone = problem.sizes_of_all();
        [0.0, 1.0].iter().for_each(|at| row(problem, RowKind::Equality, &[2], &[1.0], *at));
        (alone.bodies, solved(problem).is_err(), problem.sizes_of_all())
    });
    for (alone, fails, all) in sizes {
        assert_eq!((alone, fails, all.bodies, all.equalities), (1, true, RANKS, 2 * RANKS));
    }
}

#[test]
fn an_equality_row_that_contradicts_another_of_its_rank() {
    let errors = told(|problem, wrong| {
        if wrong {
            row(problem, RowKind::Equality, &[2], &[1.0], 0.0);
            row(problem, RowKind::Equality, &[2], &[1.0], 1.0);
        }
        solved(problem)
    });
    are_equal(&errors, Kind::GapsContradict);
}

#[test]
fn another_call_than_the_others_and_then_the_same() {
    for by in 0..RANKS {
        let ends = on_ranks(RANKS, |rank, problem| {
            give(problem, rank);
            let first = if rank == by { problem.setup().unwrap_err() } else { solved(problem).unwrap_err() };
            let saved = if rank == by { problem.save_state().map(drop) } else { problem.setup() };
            (first.kind, saved.unwrap_err().kind, solved(problem))
        });
        for end in ends {
            assert_eq!(end, (Kind::State, Kind::State, Ok(Outcome::Solved)));
        }
    }
}

#[test]
fn slips_that_one_rank_alone_has_committed() {
    for by in 0..RANKS {
        let ends = on_ranks(RANKS, |rank, problem| {
            give(problem, rank);
            let (number, val) = ([10 * rank as i64 + 2], [1.0]);
            let rows = RowsInput { ptr: &[0, 1], body: None, dof: &number, val: &val, rhs: None };
            let bound = Some(&[0.1][..]);
            let node = FrictionInput { dim: 1, normal: &[-1], rows, coefficient: None, bound };
            problem.add_friction(node).unwrap();
            let first = solved(problem);
            if rank == by {
                problem.commit_friction().unwrap();
            }
            let second = solved(problem).unwrap_err().kind;
            if rank != by {
                problem.commit_friction().unwrap();
            }
            (first, second, solved(problem))
        });
        for end in ends {
            assert_eq!(end, (Ok(Outcome::Solved), Kind::State, Ok(Outcome::Solved)));
        }
    }
}

#[test]
fn what_one_rank_refuses_in_a_call_of_all() {
    for by in 0..RANKS {
        let ends = on_ranks(RANKS, |rank, problem| {
            give(problem, rank);
            let (n, rows) = (if rank == by { N + 1 } else { N }, usize::from(rank > 0));
            let checked = problem.check(&vec![0.0; n], &vec![0.0; rows], &[]).unwrap_err();
            let saved = problem.save_state().unwrap();
            let refuse = |_: &mut Problem| match rank == by {
                true => Err(Error::argument("id", "no such state").index(-1)),
                false => Ok(saved),
            };
            let restored = problem.checked_together(Call::RestoreState, refuse);
            let restored = restored.and_then(|number| problem.restore_state(number)).unwrap_err();
            let file = std::path::Path::new("no/such/folder/of/feti.feti");
            let written = problem.write_file(file).unwrap_err();
            ([checked, restored], written, solved(problem))
        });
        for (refused, written, solved) in ends {
            for (error, name) in refused.into_iter().zip(["n", "id"]) {
                assert_eq!((error.kind, error.place.rank), (Kind::Argument(name), Some(by)), "{error}");
            }
            assert_eq!((written.kind, solved), (Kind::Io, Ok(Outcome::Solved)), "{written}");
        }
    }
}

#[test]
fn of_two_ranks_that_refuse_something_all_hear_of_one() {
    for [first, second] in [[0, 1], [0, 2], [1, 2]] {
        let errors = on_ranks(RANKS, |rank, problem| {
            give(problem, rank);
            problem
                .checked_together(Call::Check, |_| match rank {
                    rank if rank == first => Err(Error::argument("n", "too long")),
                    rank if rank == second => Err(Error::argument("u", "no number")),
                    _ => Ok(()),
                })
                .and_then(|()| problem.check(&[0.0; N], &[0.0][..usize::from(rank > 0)], &[]).map(drop))
                .unwrap_err()
        });
        for error in errors {
            assert_eq!((error.kind, error.place.rank), (Kind::Argument("n"), Some(first)), "{error}");
        }
    }
}

#[test]
fn a_row_whose_square_overflows_and_friction_that_holds_too_little() {
    let overflow = told(|problem, wrong| {
        if wrong {
            row(problem, RowKind::Equality, &[2], &[1e200], 0.0);
        }
        solved(problem)
    });
    are_equal(&overflow, Kind::Overflow);
    let slides = told(|problem, wrong| {
        if wrong {
            let body = add_unnumbered(problem, &[1.0, -1.0, 1.0]);
            problem.set_numbering(body, &[900, 901]).unwrap();
            problem.set_load(body, &[1.0, 1.0]).unwrap();
            let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[900], val: &[1.0], rhs: None };
            let bound = Some(&[0.1][..]);
            let node = FrictionInput { dim: 1, normal: &[-1], rows, coefficient: None, bound };
            problem.add_friction(node).unwrap();
        }
        solved(problem)
    });
    for (by, errors) in slides.iter().enumerate() {
        for error in errors {
            assert!(matches!(error.kind, Kind::Slides | Kind::LoadNotHeld), "{error}");
            assert_eq!((error.place.rank, error.place.body), (Some(by), Some(1)), "{error}");
        }
    }
}

#[test]
fn a_limit_of_memory_that_rank_0_has_counts_bodies_of_all_ranks() {
    let ends = on_ranks(RANKS, |rank, problem| {
        give(problem, rank);
        // that of others does not count
        problem.set_i64("memory_limit", if rank == 0 { 200 } else { 1 }).unwrap();
        let first = solved(problem);
        problem.set_i64("memory_limit", if rank == 0 { 1 << 20 } else { 1 }).unwrap();
        (first, solved(problem))
    });
    for (first, second) in ends {
        let error = first.unwrap_err();
        assert_eq!(
            (error.kind, error.place.body, second),
            (Kind::Memory, Some(0), Ok(Outcome::Solved)),
            "{error}"
        );
    }
}

#[test]
fn a_limit_of_time_ends_the_call_on_all_ranks() {
    let ends = on_ranks(RANKS, |rank, problem| {
        give(problem, rank);
        // the time of rank 0 counts
        problem.set_f64("time_limit", if rank == 0 { 1e-9 } else { 1e9 }).unwrap();
        let first = solved(problem);
        problem.set_f64("time_limit", 1e9).unwrap();
        (first, solved(problem))
    });
    for (first, second) in ends {
        assert!(
            first == Ok(Outcome::Time) || first.as_ref().is_err_and(|error| error.kind == Kind::TimeOver),
            "{first:?}"
        );
        assert_eq!(second, Ok(Outcome::Solved));
    }
}
