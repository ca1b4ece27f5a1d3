//! Functions that are wrong, fail, or do not fit the null space.

use std::sync::atomic::Ordering;

use feti_contact::error::{Error, Kind};
use feti_contact::solver::{Modes, Problem};

use crate::operator::host::{Form, Host};
use crate::operator::{answer, cube, hosts_of, solved};
use crate::support::hand_over;

const BODY: usize = 7;

/// The error of a setup in which the functions of one body are these.
fn refused(change: impl Fn(&mut Host), modes: impl Fn(&mut Problem)) -> Error {
    let deck = cube();
    let mut host = hosts_of(&deck, Form::Held).swap_remove(BODY);
    let mut problem = hand_over::problem(&deck).unwrap();
    host.give(&mut problem, BODY, false);
    problem.setup().unwrap();
    change(&mut host);
    host.give(&mut problem, BODY, false);
    modes(&mut problem);
    let error = problem.setup().unwrap_err();
    assert_eq!(error.place.body, Some(BODY), "{error}");
    hand_over::set_body(&mut problem, BODY, &deck.bodies[BODY]).unwrap();
    let (n, modes) = (host.n, deck.bodies[BODY].modes());
    problem.set_null_space(BODY, n, modes.len(), &modes.concat(), n, Modes::Exact).unwrap();
    solved(&mut problem);
    error
}

fn as_given(_: &mut Problem) {}

fn assert_says(error: &Error, kind: Kind, text: &str) {
    assert!(error.kind == kind && error.what.contains(text), "{:?}: {error}", error.kind);
}

#[test]
fn what_is_not_symmetric_is_named_with_its_figure_and_limit() {
    // a multiple of row 5 added to row 3, which leaves K R = 0
    let skew = |a: &mut Vec<f64>, n: usize| (0..n).for_each(|j| a[3 + j * n] += 1e-3 * a[5 + j * n]);
    let error = refused(|host| skew(&mut host.k, host.n), as_given);
    assert_says(&error, Kind::Callback, "the host's K is not symmetric");
    assert!(error.place.value > error.place.limit);
    let error = refused(|host| skew(&mut host.kplus, host.n), as_given);
    assert_says(&error, Kind::Callback, "the host's K+ is not symmetric");
    assert!(error.place.value > error.place.limit);
}

#[test]
fn an_inverse_of_another_matrix_is_no_inverse_of_k() {
    for factor in [2.0, 1.0 + 1e-6, 0.0] {
        let error = refused(|host| host.kplus.iter_mut().for_each(|v| *v *= factor), as_given);
        assert_says(&error, Kind::Callback, "no inverse of its K");
        assert!(error.place.value > error.place.limit && error.place.dof.is_some(), "{error}");
    }
}

#[test]
fn a_negative_k_is_indefinite() {
    let negative = |host: &mut Host| {
        host.k.iter_mut().for_each(|v| *v = -*v);
        host.kplus.iter_mut().for_each(|v| *v = -*v);
    };
    let deck = cube();
    let mut host = hosts_of(&deck, Form::Held).swap_remove(BODY);
    let diagonal = host.diagonal();
    negative(&mut host);
    let mut problem = hand_over::problem(&deck).unwrap();
    problem.set_operator(BODY, &diagonal, host.functions(false)).unwrap();
    let error = problem.setup().unwrap_err();
    assert_says(&error, Kind::Indefinite, "the host's K is not positive semidefinite");
    let error = problem.set_operator(BODY, &host.diagonal(), host.functions(false)).unwrap_err();
    assert_eq!((error.kind, error.place.entry), (Kind::Argument("diag"), Some(0)));
}

#[test]
fn a_null_space_that_is_none_or_lacks_a_mode_is_refused() {
    let deck = cube();
    let (body, n) = (&deck.bodies[BODY], deck.bodies[BODY].dofs());
    let give = |modes: &[Vec<f64>]| {
        let (r, basis) = (modes.len(), modes.concat());
        move |problem: &mut Problem| problem.set_null_space(BODY, n, r, &basis, n, Modes::Exact).unwrap()
    };
    for missing in 0..body.modes().len() {
        let mut modes = body.modes().to_vec();
        modes.remove(missing);
        let error = refused(|_| {}, give(&modes));
        assert_says(&error, Kind::NullSpace, "a mode is missing");
    }
    assert_says(&refused(|_| {}, give(&[])), Kind::NullSpace, "a mode is missing");
    let mut modes = body.modes().to_vec();
    modes[0][4] += 1e-3;
    assert_says(&refused(|_| {}, give(&modes)), Kind::NullSpace, "not a null space");
}

/// What K makes of soft motions takes the entries of K.
#[test]
fn soft_motions_of_a_body_whose_inverse_is_the_hosts_are_refused() {
    let deck = cube();
    let body = &deck.bodies[BODY];
    let (n, modes) = (body.dofs(), body.modes());
    let soft = |problem: &mut Problem| {
        problem.set_null_space(BODY, n, modes.len(), &modes.concat(), n, Modes::Soft).unwrap();
    };
    assert_says(&refused(|_| {}, soft), Kind::Unsupported, "soft motions were given");
    let mut problem = hand_over::without_null_spaces(&deck).unwrap();
    let host = hosts_of(&deck, Form::Held).swap_remove(BODY);
    problem.set_operator(BODY, &host.diagonal(), host.functions(false)).unwrap();
    problem.set_coordinates(BODY, 3, &body.node, &body.direction, &body.coordinates.concat(), 3).unwrap();
    problem.set_coordinate_modes(BODY, Modes::Soft).unwrap();
    let error = problem.setup().unwrap_err();
    assert_eq!(error.place.body, Some(BODY));
    assert_says(&error, Kind::Unsupported, "soft motions were given");
    problem.set_coordinate_modes(BODY, Modes::Candidates).unwrap();
    problem.setup().unwrap();
}

#[test]
fn what_is_no_number_is_named_with_its_dof() {
    let error = refused(|host| host.kplus[9] = f64::NAN, as_given);
    assert_says(&error, Kind::Callback, "product with K+ is not a finite number");
    assert!(error.place.dof.is_some());
    let error = refused(|host| host.k[9] = f64::INFINITY, as_given);
    assert_says(&error, Kind::Callback, "product with K is not a finite number");
}

/// A free bending beam, K = D'D of second differences: its softest motion is n^-4 as stiff as its stiffest.
fn beam(n: usize) -> Vec<f64> {
    let mut k = vec![0.0; n * n];
    for i in 1..n - 1 {
        for (a, va) in [(i - 1, 1.0), (i, -2.0), (i + 1, 1.0)] {
            [(i - 1, 1.0), (i, -2.0), (i + 1, 1.0)].iter().for_each(|&(b, vb)| k[a + b * n] += va * vb);
        }
    }
    k
}

/// Soft bodies, and supports written as large numbers on the diagonal, pass the trial; a mode that is missing does not.
#[test]
fn an_ill_conditioned_body_is_no_wrong_one() {
    for (n, form) in [(30, Form::Held), (120, Form::Regularised), (400, Form::Held), (400, Form::Regularised)]
    {
        let mut modes = vec![1.0; n];
        modes.extend((0..n).map(|i| i as f64));
        let outcome = |k: &[f64], r: usize, given: usize| {
            let mut problem = Problem::new();
            problem.add_body(n).unwrap();
            Host::new(n, k.to_vec(), &modes[..r * n], form).give(&mut problem, 0, false);
            problem.set_null_space(0, n, given, &modes[..given * n], n, Modes::Exact).unwrap();
            problem.setup()
        };
        outcome(&beam(n), 2, 2).unwrap_or_else(|e| panic!("{n}, {form:?}: {e}"));
        let error = outcome(&beam(n), 2, 1).unwrap_err();
        assert_says(&error, Kind::NullSpace, "a mode is missing");
        let mut supported = beam(n);
        supported[0] += 1e20;
        supported[n + 1] += 1e20;
        if n > 120 {
            continue; // an explicit inverse is no better than 1e-7 there
        }
        outcome(&supported, 0, 0).unwrap_or_else(|e| panic!("supported, {n}, {form:?}: {e}"));
    }
}

/// Call by call a failure ends the solve with its number; the next solve gives the same bits as ever.
#[test]
fn a_function_that_fails_ends_the_call_and_nothing_else() {
    let deck = cube();
    let hosts = hosts_of(&deck, Form::Held);
    for operator in ["explicit", "implicit"] {
        let whole = |fails: &[usize]| {
            let mut problem = hand_over::problem(&deck).unwrap();
            problem.set_str("dual_operator", operator).unwrap();
            let book = &hosts[BODY].book;
            hosts[BODY].give(&mut problem, BODY, false);
            book.calls.store(0, Ordering::Relaxed);
            for &call in fails {
                book.fails.store(book.calls.load(Ordering::Relaxed) + call, Ordering::Relaxed);
                let error = problem.solve().unwrap_err();
                assert_eq!(error.kind, Kind::Callback, "{error}");
                assert_eq!((error.place.body, error.place.value), (Some(BODY), Some(7.0)), "{error}");
            }
            book.fails.store(0, Ordering::Relaxed);
            book.calls.store(0, Ordering::Relaxed);
            solved(&mut problem);
            (answer(&problem), book.calls.load(Ordering::Relaxed))
        };
        let (expected, calls) = whole(&[]);
        for call in 1..=calls {
            assert!(whole(&[call]).0 == expected, "{operator}, call {call} of {calls}");
        }
        assert!(whole(&[1, 2, 3]).0 == expected, "{operator}");
    }
}
