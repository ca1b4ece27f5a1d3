//! The lines of the log of a call.

use std::sync::{Arc, Mutex};

use crate::constraints::FrictionInput;
use crate::error::Kind;
use crate::solver::{LogLevel, Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

/// A spring 2 pushed by 6 against a wall at 1, and, if `floats`, a mass that nothing holds or pushes.
pub fn spring(floats: bool) -> Problem {
    let mut problem = Problem::new();
    let body = problem.add_body(1).unwrap();
    let k = SparseInput { ptr: &[0, 1], col: &[0], val: &[2.0], storage: Storage::Lower };
    problem.set_stiffness(body, k).unwrap();
    problem.set_null_space(body, 1, 0, &[], 1, Modes::Exact).unwrap();
    problem.set_load(body, &[6.0]).unwrap();
    if floats {
        let body = problem.add_body(1).unwrap();
        let k = SparseInput { ptr: &[0, 0], col: &[], val: &[], storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
    }
    let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[1.0], rhs: Some(&[1.0]) };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
    problem
}

pub type Book = Arc<Mutex<Vec<(LogLevel, String)>>>;

/// Keeps the lines and returns `reply` at line `when`.
pub fn listen(problem: &mut Problem, most: LogLevel, when: usize, reply: i32) -> Book {
    let lines = Book::default();
    let book = Arc::clone(&lines);
    let tell = move |level: LogLevel, text: &str| {
        let mut book = book.lock().unwrap();
        book.push((level, text.to_owned()));
        if book.len() == when + 1 {
            reply
        } else {
            0
        }
    };
    problem.on_log(Some((most, Box::new(tell))));
    lines
}

pub fn told(lines: &Book) -> Vec<(LogLevel, String)> {
    std::mem::take(&mut *lines.lock().unwrap())
}

#[test]
fn a_solve_tells_its_result_in_one_line() {
    let mut problem = spring(false);
    let lines = listen(&mut problem, LogLevel::Result, 0, 0);
    problem.solve().unwrap();
    let told = told(&lines);
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].1.starts_with("solved: "), "{told:?}");
    for part in ["1 of 1 contact rows closed", "penetration 0.0e0,", "limit 1.0e-8", "seconds"] {
        assert!(told[0].1.contains(part), "{told:?} lacks {part}");
    }
}

#[test]
fn warnings_and_failures_are_results() {
    let mut problem = spring(true);
    let lines = listen(&mut problem, LogLevel::Result, 0, 0);
    assert_eq!(problem.solve().unwrap().undetermined, 1);
    assert!(told(&lines)[1].1.starts_with("warning: 1 motions are left open"));
    problem.set_load(1, &[1.0]).unwrap();
    problem.set_i64("index_base", 1).unwrap();
    let error = problem.solve().unwrap_err().counted_from(1);
    assert_eq!(told(&lines), [(LogLevel::Result, format!("solve failed: {error}"))]);
    assert!(error.to_string().starts_with("body 2"), "{error}");
}

#[test]
fn phases_come_in_their_order_between_what_is_solved_and_the_result() {
    let mut problem = spring(false);
    problem.set_text("tolerance=1e-11 start=previous").unwrap();
    let lines = listen(&mut problem, LogLevel::Phase, 0, 0);
    problem.solve().unwrap();
    let told: Vec<String> = told(&lines).into_iter().map(|line| line.1).collect();
    let version = env!("CARGO_PKG_VERSION");
    let sizes = "solve: 1 bodies, 1 unknowns, 1 contact rows, 0 equality rows";
    assert_eq!(told[0], format!("feti-contact {version}: {sizes}"));
    assert_eq!(told[1], "options: tolerance=1e-11 start=previous");
    let at = |name: &str| told.iter().position(|line| line.starts_with(name)).unwrap_or(usize::MAX);
    let order = [
        "rows: ",
        "factorisation: ",
        "dual operators: ",
        "method: ",
        "dual solve: ",
        "recovery: ",
        "solved: ",
    ];
    assert!(order.windows(2).all(|pair| at(pair[0]) < at(pair[1])), "{told:?}");
    assert!(told[at("factorisation: ")].ends_with(" bytes"), "{told:?}");
    let method = "method: proportioning, preconditioner none, start cold; 1 multipliers, 0 floating modes, \
                  1 explicit and 0 implicit dual operators";
    assert_eq!(told[at("method: ")], method);
    problem.solve().unwrap();
    let again: Vec<String> = self::told(&lines).into_iter().map(|line| line.1).collect();
    assert!(!again.iter().any(|line| line.starts_with("factorisation: ")), "{again:?}");
    assert!(again.iter().any(|line| line.contains("start previous")), "{again:?}");
}

#[test]
fn the_line_of_the_method_tells_where_there_is_friction() {
    let mut problem = spring(false);
    let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[1.0], rhs: None };
    let node = FrictionInput { dim: 1, normal: &[-1], rows, coefficient: None, bound: Some(&[0.5]) };
    problem.add_friction(node).unwrap();
    let lines = listen(&mut problem, LogLevel::Phase, 0, 0);
    problem.solve().unwrap();
    assert!(told(&lines).iter().any(|line| line.1.starts_with("method: Newton's method with friction,")));
}

#[test]
fn every_step_is_a_line_of_its_own_level() {
    let mut problem = spring(false);
    let lines = listen(&mut problem, LogLevel::Step, 0, 0);
    let report = problem.solve().unwrap();
    let steps: Vec<_> = told(&lines).into_iter().filter(|line| line.0 == LogLevel::Step).collect();
    assert_eq!(steps.len(), report.counts.steps());
    assert!(steps.iter().enumerate().all(|(k, line)| line.1.starts_with(&format!("step {}: ", k + 1))));
}

#[test]
fn a_function_that_fails_ends_the_call_at_any_line_and_the_next_solve_is_as_ever() {
    let mut problem = spring(false);
    let lines = listen(&mut problem, LogLevel::Step, usize::MAX, 0);
    problem.solve().unwrap();
    let all = told(&lines).len();
    for when in 0..all - 3 {
        let mut problem = spring(false);
        let lines = listen(&mut problem, LogLevel::Step, when, -7);
        let error = problem.solve().unwrap_err();
        assert_eq!((error.kind, error.place.value), (Kind::Callback, Some(-7.0)));
        assert_eq!(told(&lines).len(), when + 1);
        assert!(problem.report().is_none());
        problem.on_log(None);
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    }
}

/// The lines of a solve with this beginning.
fn lines_of(problem: &mut Problem, most: LogLevel, start: &str) -> Vec<String> {
    let lines = listen(problem, most, 0, 0);
    problem.solve().unwrap();
    told(&lines).into_iter().map(|line| line.1).filter(|line| line.starts_with(start)).collect()
}

#[test]
fn no_load_is_a_warning_where_nothing_else_moves_the_bodies() {
    let mut problem = spring(false);
    assert_eq!(lines_of(&mut problem, LogLevel::Result, "warning: "), Vec::<String>::new());
    problem.set_load(0, &[0.0]).unwrap();
    let warned = lines_of(&mut problem, LogLevel::Result, "warning: ");
    assert!(warned.len() == 1 && warned[0].starts_with("warning: no body has a load"), "{warned:?}");
    problem.set_rhs(RowKind::Inequality, 0, &[-1.0]).unwrap();
    assert_eq!(lines_of(&mut problem, LogLevel::Phase, "warning: "), Vec::<String>::new());
    assert_eq!(lines_of(&mut problem, LogLevel::Phase, "note: no"), ["note: no body has a load"]);
}

#[test]
fn rows_that_overlap_repeat_or_never_close_are_told_with_the_first_or_the_worst_of_them() {
    let mut problem = spring(false);
    problem.set_i64("index_base", 1).unwrap();
    assert_eq!(lines_of(&mut problem, LogLevel::Phase, "note: "), Vec::<String>::new());
    let rows = RowsInput {
        ptr: &[0, 1, 2, 2, 3, 4],
        body: None,
        dof: &[0, 0, 0, 0],
        val: &[-1.0, 2.0, 1.0, 1.0],
        rhs: Some(&[-0.25, 6.0, 0.5, f64::INFINITY, f64::INFINITY]),
    };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
    let expected = [
        "note: 1 contact row with overlap (c < 0) before anything moves, most in row 2: c = -2.5e-1",
        "note: 2 contact rows that can never close, because the gap is +infinity; the first is row 5",
        "note: 1 contact row that can never close, because the row has no entry; the first is row 4",
        "note: rows that are multiples of other rows, with which they share one force: 1; the first is contact row 3",
    ];
    assert_eq!(lines_of(&mut problem, LogLevel::Phase, "note: "), expected);
    assert_eq!(lines_of(&mut problem, LogLevel::Result, "note: "), Vec::<String>::new());
}
