//! After the time limit or a cancellation a solve must end. Measures the work it still does after the interrupt falls at
//! a chosen check.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use decks::{masonry, Deck};

use crate::error::{Error, Kind};
use crate::platform::tally;
use crate::solver::{LogLevel, Modes, Outcome, Problem, Report, RowKind, RowsInput, SparseInput, Storage};

#[allow(dead_code, unused_imports)]
#[path = "../../../paper/src/lib.rs"]
mod paper;

/// The reason why the solve ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stop {
    Time,
    Host,
}

/// A solve that was ended.
struct Ended {
    outcome: Result<Report, Error>,
    /// Products, coarse solves and factorisations after the interrupt.
    more: usize,
    /// Number of checks of the clock.
    looks: usize,
}

fn problem(deck: &Deck, options: &str) -> Problem {
    let mut problem = Problem::new();
    problem.offer_method(&paper::Paper);
    let columns = |matrix: &decks::Csr| matrix.col.iter().map(|&j| j as i64).collect::<Vec<_>>();
    for body in &deck.bodies {
        let (p, n, k, modes) =
            (problem.add_body(body.dofs()).unwrap(), body.dofs(), &body.stiffness, body.modes());
        let col = columns(k);
        let k = SparseInput { ptr: &k.ptr, col: &col, val: &k.val, storage: Storage::Full };
        problem.set_stiffness(p, k).unwrap();
        problem.set_null_space(p, n, modes.len(), &modes.concat(), n, Modes::Exact).unwrap();
        problem.set_load(p, &body.load).unwrap();
    }
    for (kind, rows) in [(RowKind::Inequality, &deck.contact), (RowKind::Equality, &deck.equalities)] {
        let (matrix, dof) = (&rows.matrix, columns(&rows.matrix));
        let rows =
            RowsInput { ptr: &matrix.ptr, body: None, dof: &dof, val: &matrix.val, rhs: Some(&rows.rhs) };
        problem.add_rows(kind, rows).unwrap();
    }
    problem.set_text(&format!("threads=1 time_limit=1 {options}")).unwrap();
    problem
}

/// Solves on this thread; `stop` occurs directly after check `when`.
fn ended(problem: &mut Problem, stop: Stop, when: usize) -> Ended {
    let (looks, before) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(usize::MAX)));
    let (counted, noted, canceller) = (Arc::clone(&looks), Arc::clone(&before), problem.canceller());
    problem.set_clock(Some(Arc::new(move || {
        let look = counted.fetch_add(1, Ordering::Relaxed) + 1;
        if look == when {
            noted.store(tally::done(), Ordering::Relaxed);
            canceller.store(stop == Stop::Host, Ordering::Relaxed);
        }
        if stop == Stop::Time && look > when {
            2.0
        } else {
            0.0
        }
    })));
    let outcome = problem.solve();
    let more = tally::done().saturating_sub(before.load(Ordering::Relaxed));
    Ended { outcome, more, looks: looks.load(Ordering::Relaxed) }
}

/// Ends solves of the deck after 1, 2, 4, ... checks, or after every check if `every`, until a solve is complete. No
/// solve does more than one further expensive operation, and each leaves an answer or the status that there is none.
fn all_ended(deck: &Deck, options: &str, stop: Stop, every: bool) {
    let whole = ended(&mut problem(deck, options), stop, usize::MAX);
    let completed = |outcome: &Result<Report, Error>| match (outcome, &whole.outcome) {
        (Ok(one), Ok(other)) => one.outcome == other.outcome,
        (Err(one), Err(other)) => one.kind == other.kind,
        _ => false,
    };
    let (name, mut when, mut cut) = (&deck.name, 1, 0);
    while when < whole.looks {
        let mut problem = problem(deck, options);
        let Ended { outcome, more, .. } = ended(&mut problem, stop, when);
        assert!(more <= 1, "{name} {options} {stop:?} after look {when}: {more} more");
        let is_cut = match &outcome {
            Ok(report) => {
                report.outcome == if stop == Stop::Time { Outcome::Time } else { Outcome::Cancelled }
            }
            Err(error) => error.kind == if stop == Stop::Time { Kind::TimeOver } else { Kind::Cancelled },
        };
        assert!(is_cut || completed(&outcome), "{name} {options} {stop:?} after look {when}: {outcome:?}");
        let has_answer = problem.displacements().is_ok_and(|u| u.iter().all(|u| u.is_finite()));
        assert_eq!(has_answer, outcome.is_ok(), "{name} {options} {stop:?} after look {when}");
        cut += usize::from(is_cut);
        when = if every { when + 1 } else { 2 * when };
    }
    assert!(cut > 0, "{name}: no solve has been ended");
}

/// A load on all bodies that nothing holds: the blocks may slide.
fn pushed_aside(mut deck: Deck) -> Deck {
    deck.bodies.iter_mut().for_each(|body| body.load.iter_mut().step_by(2).for_each(|f| *f = 1e-5));
    deck
}

/// Three more rows, no two of which contradict each other, that no displacement satisfies.
fn contradicting(mut deck: Deck) -> Deck {
    deck.contact.push(&[(0, 1.0), (2, 1.0)], -1e-3);
    deck.contact.push(&[(0, -1.0)], -1e-3);
    deck.contact.push(&[(2, -1.0)], -1e-3);
    deck
}

#[test]
fn at_most_one_product_coarse_solve_or_factorisation_follows_after_any_look() {
    for stop in [Stop::Time, Stop::Host] {
        all_ended(&masonry::tower(3), "", stop, true);
        all_ended(&masonry::tower(2), "preconditioner=dirichlet", stop, true);
        all_ended(&masonry::wall(2, 1e-4), "method=paper-monotone", stop, true);
        all_ended(&pushed_aside(masonry::chain(3)), "", stop, true);
        all_ended(&contradicting(masonry::tower(3)), "", stop, true);
    }
}

#[test]
fn at_most_one_of_them_follows_on_many_loose_bodies() {
    for stop in [Stop::Time, Stop::Host] {
        all_ended(&masonry::tower(60), "", stop, false);
        all_ended(&masonry::wall(6, 1e-4), "", stop, false);
        all_ended(&masonry::heap(40, 3), "", stop, false);
        all_ended(&pushed_aside(masonry::wall(5, 0.0)), "", stop, false);
        all_ended(&contradicting(masonry::tower(40)), "", stop, false);
        all_ended(&masonry::wall(3, 0.0), "method=paper-feasible", stop, false);
    }
}

/// Above 1500 modes the forces nearest to the load are found row by row with coarse factors.
#[test]
fn at_most_one_of_them_follows_where_the_modes_are_many() {
    for stop in [Stop::Time, Stop::Host] {
        all_ended(&pushed_aside(masonry::chain(510)), "", stop, false);
    }
}

/// The clock advances by half a second at every check.
#[test]
fn parts_that_take_long_say_how_far_they_are_and_the_longer_they_take_the_more_seldom() {
    for (deck, part, of) in [
        (masonry::wall(4, 1e-4), "first feasible point", "Newton steps of a projection"),
        (masonry::wall(4, 1e-4), "dual solve", "Newton steps of a projection"),
        (masonry::heap(60, 3), "dual solve", "steps into the interior"),
        (masonry::heap(200, 3), "first feasible point", "steps into the interior"),
        (pushed_aside(masonry::wall(6, 0.0)), "first feasible point", "rows admitted to a nearest point"),
        (
            pushed_aside(masonry::wall(3, 0.0)),
            "forces nearest to the load",
            "rows admitted to a nearest point",
        ),
        (contradicting(masonry::wall(3, 0.0)), "presolve", "rows admitted to a nearest point"),
    ] {
        let mut problem = problem(&deck, "time_limit=1e300");
        let (looks, lines) = (Arc::new(AtomicUsize::new(0)), Arc::new(Mutex::new(Vec::new())));
        let (counted, book) = (Arc::clone(&looks), Arc::clone(&lines));
        problem.set_clock(Some(Arc::new(move || 0.5 * counted.fetch_add(1, Ordering::Relaxed) as f64)));
        let tell = move |_: LogLevel, text: &str| {
            book.lock().unwrap().push(text.to_owned());
            0
        };
        problem.on_log(Some((LogLevel::Phase, Box::new(tell))));
        let _ = problem.solve();
        let lines = lines.lock().unwrap();
        let (begins, ends) = (format!("{part}: "), " seconds");
        let told = |line: &&String| line.starts_with(&begins) && line.contains(of) && line.ends_with(ends);
        assert!(lines.iter().any(|line| told(&line)), "{}: no {part}, {of} in {lines:?}", deck.name);
        let most = 30.0 + 10.0 * (looks.load(Ordering::Relaxed) as f64).ln();
        assert!((lines.len() as f64) < most, "{}: {} lines", deck.name, lines.len());
    }
}
