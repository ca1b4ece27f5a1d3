//! Progress functions and cancellation of a setup or a solve.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, ThreadId};

use crate::error::Kind;
use crate::platform::interrupt;
use crate::solver::{Modes, Outcome, Problem, Progress, Reply, RowKind, RowsInput, SparseInput, Storage};

const BODIES: usize = 4;
const DOFS: usize = 600;

/// Chains of springs, held at one end and pushed against a wall at the other: enough for several threads.
fn chains(threads: i64) -> Problem {
    let ptr: Vec<usize> = (0..=DOFS).map(|i| (2 * i).saturating_sub(1)).collect();
    let col: Vec<i64> = (0..DOFS as i64).flat_map(|i| [i - 1, i]).skip(1).collect();
    let val: Vec<f64> = (0..DOFS).flat_map(|_| [-1.0, 2.0]).skip(1).collect();
    let mut problem = Problem::new();
    for body in 0..BODIES {
        problem.add_body(DOFS).unwrap();
        let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
        problem.set_null_space(body, DOFS, 0, &[], 1, Modes::Exact).unwrap();
        problem.set_load(body, &[1.0; DOFS]).unwrap();
    }
    let last: Vec<i64> = (1..=BODIES).map(|p| (p * DOFS - 1) as i64).collect();
    let ptr: Vec<usize> = (0..=BODIES).collect();
    let rows =
        RowsInput { ptr: &ptr, body: None, dof: &last, val: &[1.0; BODIES], rhs: Some(&[1.0; BODIES]) };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
    problem.set_i64("threads", threads).unwrap();
    // all keys differ: no body shares factors with another
    problem.prepared.set_keys(&problem.model, |p| [p as u64; 2]);
    problem
}

type Diary = Arc<Mutex<Vec<(ThreadId, Progress)>>>;

/// Keeps the progress messages, and cancels at call `when`.
fn listen(problem: &mut Problem, when: usize) -> Diary {
    let heard = Diary::default();
    let book = Arc::clone(&heard);
    problem.on_progress(Some(Box::new(move |now| {
        let mut book = book.lock().unwrap();
        book.push((thread::current().id(), *now));
        if book.len() == when + 1 {
            Reply::Cancel
        } else {
            Reply::Continue
        }
    })));
    heard
}

#[test]
fn the_calling_thread_hears_of_every_body_with_a_fraction_that_never_falls() {
    for threads in [1, 2, 4] {
        let mut problem = chains(threads);
        problem.set_str("preconditioner", "lumped").unwrap();
        let heard = listen(&mut problem, usize::MAX);
        problem.solve().unwrap();
        let heard = heard.lock().unwrap();
        assert!(heard.iter().all(|(thread, _)| *thread == thread::current().id()));
        let setup = heard.iter().take_while(|(_, now)| now.step.is_none());
        let mut fractions: Vec<f64> = setup.map(|(_, now)| now.fraction).collect();
        assert!(fractions.windows(2).all(|pair| pair[0] <= pair[1]), "{fractions:?}");
        fractions.dedup();
        assert_eq!(fractions.len(), 4 * BODIES + 1, "{fractions:?}");
        assert!(fractions[0] > 0.0 && fractions.last() == Some(&1.0));
        assert!(heard.iter().skip_while(|(_, now)| now.step.is_none()).all(|(_, now)| now.fraction.is_nan()));
    }
}

#[test]
fn what_a_cancelled_setup_has_factorised_is_kept() {
    for threads in [1, 2, 4] {
        let mut problem = chains(threads);
        for when in 0..4 * BODIES {
            let heard = listen(&mut problem, when);
            problem.model.revisions.laws += 1; // no dual problem remains
            let ended = problem.setup();
            let calls = heard.lock().unwrap().len();
            if calls <= when {
                break; // fewer parts remain
            }
            assert_eq!((ended.unwrap_err().kind, calls), (Kind::Cancelled, when + 1));
        }
        problem.on_progress(None);
        problem.solve().unwrap();
        assert_eq!(problem.work().factorisations, BODIES);
    }
}

/// The host's function for the first step takes longer than the time limit: the group of bodies of that step has an
/// answer, and no other group has begun.
#[test]
fn a_solve_ends_with_the_step_in_which_the_time_is_over() {
    let mut problem = chains(1);
    problem.set_f64("time_limit", 0.02).unwrap();
    let steps = Arc::new(AtomicUsize::new(0));
    let (book, shown) = (Arc::clone(&steps), Arc::clone(&steps));
    problem.set_clock(Some(Arc::new(move || 0.025 * shown.load(Ordering::Relaxed) as f64)));
    problem.on_progress(Some(Box::new(move |now| {
        book.fetch_add(usize::from(now.step.is_some()), Ordering::Relaxed);
        assert!(interrupt::check().is_ok(), "other problems that the host uses here have their own time");
        Reply::Continue
    })));
    assert_eq!(problem.solve().unwrap_err().kind, Kind::TimeOver);
    assert_eq!(steps.load(Ordering::Relaxed), 1);
    assert_eq!(problem.report().unwrap().outcome, Outcome::Time);
    let has_answer = |p| problem.displacement(p).is_ok();
    assert_eq!([0, 1, 2, 3].map(has_answer), [true, false, false, false]);
}
