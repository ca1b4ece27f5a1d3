//! How the dual operators are kept: the same answer, the same bits on any number of threads and after any change of the
//! option, and less memory where the host allows no more.

use decks::{Blocks, Cube, Deck};
use feti_contact::error::Kind;
use feti_contact::solver::{Problem, Report};

use crate::invariance::answer::{decks, Answer};
use crate::support::hand_over;

fn with(deck: &Deck, kind: &str) -> Problem {
    let mut problem = hand_over::problem(deck).unwrap();
    problem.set_str("dual_operator", kind).unwrap();
    problem
}

/// Two bodies and many: large enough for several threads, also in the products with F.
fn large() -> [Deck; 2] {
    [
        Blocks { elements: 8, young: 1.0 }.build(),
        Cube { subdomains: [2; 3], elements: 4, ..Cube::default() }.build(),
    ]
}

#[test]
fn implicit_operators_give_the_answer_of_explicit_ones() {
    for deck in decks().into_iter().chain(large()) {
        let expected = Answer::from(&mut with(&deck, "explicit"), &deck.name);
        let mut problem = with(&deck, "implicit");
        Answer::from(&mut problem, &deck.name).assert_near(&expected, 1e-9, &deck.name);
        let report = problem.report().unwrap();
        assert_eq!((report.explicit_operators, report.implicit_operators), (0, deck.bodies.len()));
        assert_eq!(report.operator_bytes, 0);
    }
}

#[test]
fn implicit_products_have_the_same_bits_on_any_number_of_threads() {
    for deck in large() {
        for kind in ["implicit", "explicit"] {
            let on = |threads| {
                let mut problem = with(&deck, kind);
                problem.set_i64("threads", threads).unwrap();
                Answer::from(&mut problem, &deck.name)
            };
            let expected = on(1);
            for threads in [2, 4] {
                on(threads).assert_same(&expected, &format!("{}, {kind}, {threads} threads", deck.name));
            }
        }
    }
}

#[test]
fn another_kind_of_operator_takes_no_factorisation_and_leaves_no_trace() {
    for deck in large() {
        let mut problem = with(&deck, "explicit");
        let first = Answer::from(&mut problem, &deck.name);
        let explicit = problem.report().unwrap().clone();
        problem.set_str("dual_operator", "implicit").unwrap();
        let implicit = Answer::from(&mut problem, &deck.name);
        implicit.assert_same(&Answer::from(&mut with(&deck, "implicit"), &deck.name), &deck.name);
        assert_eq!(problem.report().unwrap().work.factorisations, explicit.work.factorisations);
        problem.set_str("dual_operator", "explicit").unwrap();
        Answer::from(&mut problem, &deck.name).assert_same(&first, &deck.name);
        assert_eq!(problem.report().unwrap().operator_bytes, explicit.operator_bytes);
    }
}

/// One byte less than the explicit operators take: the largest become implicit, which holds the limit. Without that way
/// out, or below the factors, the problem is refused.
#[test]
fn operators_that_do_not_fit_become_implicit() {
    let deck = Blocks { elements: 12, young: 1.0 }.build();
    let mut problem = with(&deck, "explicit");
    let expected = Answer::from(&mut problem, &deck.name);
    let full = problem.report().unwrap().clone();
    let within = |limit: usize, kind: &str| {
        let mut problem = with(&deck, kind);
        problem.set_i64("memory_limit", limit as i64).unwrap();
        problem
    };
    let tight = full.factor_bytes + full.operator_bytes - 1;
    assert_eq!(within(tight, "explicit").solve().unwrap_err().kind, Kind::Memory);
    let mut problem = within(tight, "automatic");
    Answer::from(&mut problem, &deck.name).assert_near(&expected, 1e-9, &deck.name);
    let report = problem.report().unwrap();
    assert_eq!((report.explicit_operators, report.implicit_operators), (1, 1));
    assert!(report.factor_bytes + report.operator_bytes <= tight);
    assert_eq!(within(full.factor_bytes, "automatic").solve().unwrap_err().kind, Kind::Memory);
    problem.set_i64("memory_limit", 0).unwrap();
    Answer::from(&mut problem, &deck.name).assert_same(&expected, "without a limit again");
}

/// The direct method needs entries of F on the active set: they are assembled for its rows.
#[test]
fn the_direct_method_needs_no_explicit_operator() {
    for deck in decks().into_iter().chain([Blocks { elements: 8, young: 1.0 }.build()]) {
        let finished = |kind: &str| {
            let mut problem = with(&deck, kind);
            problem.set_str("finish", "direct").unwrap();
            let answer = Answer::from(&mut problem, &deck.name);
            let report = problem.report().unwrap();
            assert!(report.finished || deck.name != "blocks_8", "{kind}");
            (answer, report.counts.direct)
        };
        let (implicit, explicit) = (finished("implicit"), finished("explicit"));
        assert!(implicit.1 > 0 && implicit.1 == explicit.1, "{}", deck.name);
        implicit.0.assert_near(&explicit.0, 1e-9, &deck.name);
    }
}

#[test]
fn every_phase_has_its_time_and_what_is_kept_its_bytes() {
    let deck = &large()[0];
    let mut problem = with(deck, "explicit");
    problem.set_str("preconditioner", "lumped").unwrap();
    let report = problem.solve().unwrap();
    let names: Vec<&str> = report.phases.iter().map(|phase| phase.name.to_str().unwrap()).collect();
    let expected = [
        "rows",
        "null spaces",
        "analysis",
        "factorisation",
        "dual operators",
        "preconditioner",
        "dual solve",
        "recovery",
    ];
    assert_eq!(names, expected);
    assert!(report.phases.iter().all(|phase| phase.seconds > 0.0), "{:?}", report.phases);
    // the part of the time that phases have; less if the machine does something else between two of them
    let part_of = |report: &Report| {
        let sum: f64 = report.phases.iter().map(|phase| phase.seconds).sum();
        sum / (report.seconds_setup + report.seconds_solve)
    };
    let parts: Vec<f64> = (0..5).map(|_| part_of(&with(deck, "explicit").solve().unwrap())).collect();
    assert!(parts.iter().all(|part| *part <= 1.001) && parts.iter().any(|part| *part > 0.8), "{parts:?}");
    let bytes: Vec<usize> = report.phases.iter().map(|phase| phase.bytes).collect();
    assert_eq!((bytes[3], bytes[4]), (report.factor_bytes, report.operator_bytes));
    assert!(bytes[5] > 0);
    let again = problem.solve().unwrap();
    assert!(again.phases[..6].iter().all(|phase| phase.seconds == 0.0), "{:?}", again.phases);
    assert_eq!(again.phases[3].bytes, report.factor_bytes);
}
