//! Bodies whose stiffness the host keeps: the same answers as with matrices, for every generalised inverse, thread and
//! option; wrong functions are refused by name.

mod automatic;
mod host;
mod refused;

use std::sync::atomic::Ordering;
use std::thread;

use decks::{Cube, Deck};
use feti_contact::error::Kind;
use feti_contact::solver::{Outcome, Problem, Report, RowKind};
use host::{Form, Host};

use crate::reference::case::{self, difference, Case};
use crate::support::hand_over;

fn dense_case(k: &case::Sparse) -> Vec<f64> {
    let n = k.ptr.len() - 1;
    let mut dense = vec![0.0; n * n];
    for i in 0..n {
        for at in k.ptr[i]..k.ptr[i + 1] {
            let j = k.col[at] as usize;
            dense[i + j * n] = k.val[at];
            dense[j + i * n] = k.val[at];
        }
    }
    dense
}

fn hosts_of_case(case: &Case, form: Form) -> Vec<Host> {
    let host = |(k, r): &(case::Sparse, Vec<f64>)| Host::new(k.ptr.len() - 1, dense_case(k), r, form);
    case.bodies.iter().map(host).collect()
}

/// Null spaces of bodies that are held are given, too: r = 0.
pub fn problem_of(deck: &Deck) -> Problem {
    hand_over::problem(deck).unwrap()
}

pub fn hosts_of(deck: &Deck, form: Form) -> Vec<Host> {
    let host = |body: &decks::Body| {
        let n = body.dofs();
        let k = (0..n * n).map(|at| body.stiffness.get(at % n, at / n)).collect();
        Host::new(n, k, &body.modes().concat(), form)
    };
    deck.bodies.iter().map(host).collect()
}

/// 8 bodies of 375 unknowns: more than the 1000 from which on threads are used.
pub fn cube() -> Deck {
    Cube { elements: 4, ..Cube::default() }.build()
}

pub fn solved(problem: &mut Problem) -> Report {
    let report = problem.solve().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(report.outcome, Outcome::Solved, "{:?}", report.certificate);
    assert!(report.certificate.passed());
    report
}

/// u, lambda, mu.
pub fn answer(problem: &Problem) -> [Vec<f64>; 3] {
    let bodies = 0..problem.sizes().bodies;
    let u = bodies.flat_map(|p| problem.displacement(p).unwrap().to_vec()).collect();
    let [lambda, mu] =
        [RowKind::Inequality, RowKind::Equality].map(|k| problem.multipliers(k).unwrap().to_vec());
    [u, lambda, mu]
}

pub fn assert_same(found: &[Vec<f64>; 3], expected: &[Vec<f64>; 3], tolerance: f64, what: &str) {
    for (found, expected) in found.iter().zip(expected).filter(|(_, expected)| !expected.is_empty()) {
        let error = difference(found, expected);
        assert!(error <= tolerance, "{what}: {error:.1e}");
    }
}

#[test]
fn a_factorisation_of_the_host_gives_the_answer_that_a_matrix_gives() {
    for name in ["p1_P1", "p2_A", "p2_B1", "p2_B2"] {
        let case = Case::read(name);
        let mut problem = case.problem(false);
        problem.set_str("finish", "direct").unwrap();
        solved(&mut problem);
        let expected = answer(&problem);
        for form in [Form::Held, Form::Regularised] {
            for (p, host) in hosts_of_case(&case, form).iter().enumerate() {
                host.give(&mut problem, p, false);
            }
            let open = solved(&mut problem).undetermined;
            let mut found = answer(&problem);
            if open > 0 {
                found[0].clone_from(&expected[0]); // one of many
            }
            assert_same(&found, &expected, 1e-9, &format!("{name}, {form:?}"));
            assert!(difference(&answer(&problem)[1], &case.lambda) <= 1e-7, "{name}");
        }
    }
}

/// Every second body is a matrix. With `concurrent` false no function is called on another thread.
#[test]
fn bodies_of_both_kinds_go_together_on_any_threads_with_any_option() {
    let deck = cube();
    let hosts = hosts_of(&deck, Form::Held);
    let mut problem = problem_of(&deck);
    problem.set_str("finish", "direct").unwrap();
    solved(&mut problem);
    let expected = answer(&problem);
    let options = [
        ("dual_operator", "explicit"),
        ("dual_operator", "implicit"),
        ("preconditioner", "lumped"),
        ("preconditioner", "dirichlet"),
    ];
    for (name, value) in options {
        let mut bits = None;
        for (threads, concurrent) in [(1, false), (2, false), (2, true)] {
            let mut problem = problem_of(&deck);
            problem.set_str("finish", "direct").unwrap();
            problem.set_str(name, value).unwrap();
            problem.set_i64("threads", threads).unwrap();
            for (p, host) in hosts.iter().enumerate().step_by(2) {
                host.book.threads.lock().unwrap().clear();
                host.give(&mut problem, p, concurrent);
            }
            let report = solved(&mut problem);
            if name == "dual_operator" {
                assert_eq!(report.implicit_operators > 0, value == "implicit");
            }
            let what = format!("{name} {value}, {threads} threads, concurrent {concurrent}");
            assert_same(&answer(&problem), &expected, 1e-9, &what);
            let me = [thread::current().id()];
            let seen = |host: &Host| host.book.threads.lock().unwrap().clone();
            let alone = hosts.iter().step_by(2).all(|host| seen(host) == me);
            assert!(alone || concurrent, "{what}");
            let found = answer(&problem);
            assert!(*bits.get_or_insert_with(|| found.clone()) == found, "{what}: other bits");
        }
    }
}

/// Bodies that float as candidates from coordinates, without a null space from the host.
#[test]
fn coordinates_serve_in_place_of_null_spaces() {
    let deck = cube();
    let mut problem = problem_of(&deck);
    solved(&mut problem);
    let expected = answer(&problem);
    let mut problem = hand_over::without_null_spaces(&deck).unwrap();
    for (p, (body, host)) in deck.bodies.iter().zip(hosts_of(&deck, Form::Regularised)).enumerate() {
        host.give(&mut problem, p, false);
        if p == 0 {
            let error = problem.setup().unwrap_err();
            assert_eq!((error.kind, error.place.body), (Kind::State, Some(0)), "{error}");
        }
        let xyz = body.coordinates.concat();
        problem.set_coordinates(p, 3, &body.node, &body.direction, &xyz, 3).unwrap();
    }
    solved(&mut problem);
    assert_same(&answer(&problem), &expected, 1e-7, "coordinates");
}

fn columns(hosts: &[Host]) -> usize {
    hosts.iter().map(|host| host.book.columns_of_kplus.swap(0, Ordering::Relaxed)).sum()
}

/// A load step asks for K+ f, and for u once for every certificate: no column of F.
#[test]
fn load_steps_and_new_rows_ask_for_no_more_than_they_need() {
    let deck = cube();
    let (hosts, bodies) = (hosts_of(&deck, Form::Held), deck.bodies.len());
    let mut problem = problem_of(&deck);
    problem.set_str("dual_operator", "explicit").unwrap();
    hosts.iter().enumerate().for_each(|(p, host)| host.give(&mut problem, p, false));
    let report = solved(&mut problem);
    let first = columns(&hosts);
    assert!(
        first > report.work.columns_computed && report.work.factorisations == 0 && report.work.analyses == 0
    );
    assert_eq!(report.explicit_operators, bodies);
    for (p, body) in deck.bodies.iter().enumerate() {
        let load: Vec<f64> = body.load.iter().map(|f| 1.1 * f).collect();
        problem.set_load(p, &load).unwrap();
    }
    let second = solved(&mut problem);
    assert_eq!(second.work.columns_computed, report.work.columns_computed);
    let spent = columns(&hosts);
    assert!(spent >= 2 * bodies && spent <= 4 * bodies, "{spent} columns");
    problem.set_rhs(RowKind::Inequality, 0, &vec![0.01; deck.contact.len()]).unwrap();
    hand_over::add_rows(&mut problem, RowKind::Inequality, &extra_row(&deck)).unwrap();
    let third = solved(&mut problem);
    assert_eq!(third.work.columns_computed - second.work.columns_computed, 1);
    assert!(columns(&hosts) <= 4 * bodies + 1);
}

/// A row on the last unknown of the deck, whose gap is wide.
pub fn extra_row(deck: &Deck) -> decks::Rows {
    let mut rows = decks::Rows::none(deck.dofs());
    rows.push(&[(deck.dofs() - 1, 1.0)], 1e3);
    rows
}

#[test]
fn a_matrix_takes_the_place_of_functions_and_they_that_of_a_matrix() {
    let deck = cube();
    let hosts = hosts_of(&deck, Form::Regularised);
    let mut problem = problem_of(&deck);
    let report = solved(&mut problem);
    let expected = answer(&problem);
    hosts[3].give(&mut problem, 3, true);
    assert_eq!(solved(&mut problem).work.factorisations, report.work.factorisations);
    assert!(columns(&hosts[3..4]) > 0);
    assert_same(&answer(&problem), &expected, 1e-7, "functions");
    let error = problem.fixing_dofs(3).unwrap_err();
    assert_eq!((error.kind, error.place.body), (Kind::Unsupported, Some(3)), "{error}");
    let n = deck.bodies[3].dofs();
    let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
    x[5] = 2.0;
    problem.kplus(3, &x, &mut y).unwrap();
    let column = &hosts[3].kplus[5 * n..6 * n];
    assert!(y.iter().zip(column).all(|(y, k)| (y - 2.0 * k).abs() <= 1e-12 * k.abs()));
    let [u, lambda, mu] = &expected;
    assert!(problem.check(u, lambda, mu).unwrap().passed());
    let wrong: Vec<f64> = u.iter().map(|u| 1.001 * u).collect();
    assert!(problem.check(&wrong, lambda, mu).unwrap().equilibrium.ratio > 1.0);

    // values of its own: another stiffness, given by functions
    let doubled = Host { k: hosts[3].k.iter().map(|v| 2.0 * v).collect(), ..hosts[3].clone() };
    let halved = Host { kplus: hosts[3].kplus.iter().map(|v| 0.5 * v).collect(), ..doubled };
    halved.give(&mut problem, 3, false);
    solved(&mut problem);
    assert!(difference(&answer(&problem)[0], &expected[0]) > 1e-3);

    columns(&hosts);
    hand_over::set_body(&mut problem, 3, &deck.bodies[3]).unwrap();
    solved(&mut problem);
    assert_eq!(columns(&hosts), 0);
    assert!(answer(&problem) == expected, "other bits than with the matrix before");
}

/// The paper's own method and the amplitudes alpha know functions and matrices alike.
#[test]
fn the_methods_of_the_paper_take_functions_of_the_host() {
    let case = Case::read("p1_P1");
    let mut problem = case.problem(false);
    hosts_of_case(&case, Form::Held)
        .iter()
        .enumerate()
        .for_each(|(p, host)| host.give(&mut problem, p, false));
    solved(&mut problem);
    let expected = answer(&problem);
    problem.set_str("method", "paper-monotone").unwrap();
    solved(&mut problem);
    assert_same(&answer(&problem), &expected, 1e-6, "paper-monotone");
}
