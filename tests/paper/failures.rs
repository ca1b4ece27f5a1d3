//! Where the paper's method fails as printed: it says so, and never calls a wrong answer solved.

use crate::paper::cases::METHODS;
use crate::reference::case::{difference, Case};
use feti_contact::error::Kind;
use feti_contact::solver::{Outcome, Problem, RowKind};

/// Problem 2 with its printed parameters.
fn as_printed(name: &str, method: &str, gamma: f64) -> (Case, Problem) {
    let case = Case::read(name);
    let mut problem = case.problem(false);
    problem.set_str("method", method).unwrap();
    problem.set_str("paper_units", "printed").unwrap();
    problem.set_f64("gamma", gamma).unwrap();
    problem.set_f64("paper_rho_0", 1e6).unwrap();
    problem.set_f64("paper_m", 1e4).unwrap();
    problem.set_f64("tolerance", 1e-4).unwrap();
    problem.set_f64("certificate_tolerance", 1e-4).unwrap();
    (case, problem)
}

/// Gamma = .1 with rho = 10^6 and six rigid modes: thousands of steps.
#[test]
fn gamma_a_tenth_runs_into_the_limit_of_steps_where_all_modes_float() {
    for method in ["paper-feasible", "paper-extrapolating"] {
        let (_, mut problem) = as_printed("p2_B2", method, 0.1);
        problem.set_i64("max_steps", 3000).unwrap();
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Iterations, "{method}");
        assert!(!report.certificate.passed());
    }
    let (_, mut problem) = as_printed("p2_B2", "paper-extrapolating", 1.0);
    assert!(problem.solve().unwrap().counts.steps() < 200, "Gamma = 1 does with tens");
}

#[test]
fn ten_digits_are_out_of_reach_of_the_printed_penalty_and_the_status_says_so() {
    for (name, method) in [("p2_A", METHODS[0]), ("p2_B1", METHODS[1]), ("p2_B1", METHODS[2])] {
        let (_, mut problem) = as_printed(name, method, 1.0);
        problem.set_f64("tolerance", 1e-12).unwrap();
        problem.set_f64("certificate_tolerance", 1e-10).unwrap();
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Inaccurate, "{name} {method}");
        assert!(!report.certificate.passed());
    }
}

/// rho_0 = 100 as an absolute number hides A behind rounding where A is small: seven digits are lost at E = 2.1e11
/// (metres), all of them with a stiffness a million times larger. Relative to |A| / |D|^2 neither is seen, nor is it by
/// the default.
#[test]
fn absolute_parameters_fail_in_other_units_and_relative_ones_do_not() {
    for (stiffer, digits, wrong) in [(1e3, 1e-7, 1e-6), (1e9, 1e-4, 0.1)] {
        let mut case = Case::read("p2_A");
        case.bodies.iter_mut().for_each(|(k, _)| k.val.iter_mut().for_each(|v| *v *= stiffer));
        case.contact.1.iter_mut().for_each(|c| *c /= stiffer);
        let mut default = case.problem(false);
        default.set_f64("certificate_tolerance", 1e-9).unwrap();
        assert_eq!(default.solve().unwrap().outcome, Outcome::Solved);
        assert!(difference(default.multipliers(RowKind::Inequality).unwrap(), &case.lambda) <= 1e-9);
        for method in METHODS {
            let solve = |units: &str| {
                let mut problem = case.problem(false);
                problem.set_str("method", method).unwrap();
                problem.set_str("paper_units", units).unwrap();
                problem.set_f64("tolerance", 1e-3 * digits).unwrap();
                problem.set_f64("certificate_tolerance", digits).unwrap();
                let report = problem.solve().unwrap();
                let error = difference(problem.multipliers(RowKind::Inequality).unwrap(), &case.lambda);
                (report.outcome, report.certificate.passed(), error)
            };
            let (outcome, passed, error) = solve("relative");
            assert!(outcome == Outcome::Solved && passed && error <= 10.0 * digits, "{method} {error:.1e}");
            let (outcome, passed, error) = solve("printed");
            assert!(
                outcome == Outcome::Inaccurate && !passed && error > wrong,
                "{method} {outcome:?} {error:.1e}"
            );
        }
    }
}

/// The load pulls the floating membrane away from the only thing that could hold it: rho grows without end.
#[test]
fn a_load_that_nothing_holds_ends_stalled_and_the_default_names_the_body() {
    let mut case = Case::read("p1_P3");
    case.load.iter_mut().for_each(|f| *f = -*f);
    let refusal = case.problem(false).solve().unwrap_err();
    assert_eq!((refusal.kind, refusal.place.body), (Kind::LoadNotHeld, Some(1)));
    for method in METHODS {
        for units in ["relative", "printed"] {
            let mut problem = case.problem(false);
            problem.set_str("method", method).unwrap();
            problem.set_str("paper_units", units).unwrap();
            problem.set_f64("tolerance", 1e-5).unwrap();
            problem.set_f64("certificate_tolerance", 1e-4).unwrap();
            let report = problem.solve().unwrap();
            assert_eq!(report.outcome, Outcome::Stalled, "{method} {units}");
            assert!(!report.certificate.passed(), "{method} {units}");
        }
    }
}

#[test]
fn a_run_that_is_cancelled_keeps_what_it_has() {
    let (_, mut problem) = as_printed("p1_P3", "paper-monotone", 1.0);
    let mut told = 0;
    problem.on_progress(Some(Box::new(move |progress| {
        told += usize::from(progress.step.is_some());
        if told == 5 {
            feti_contact::solver::Reply::Cancel
        } else {
            feti_contact::solver::Reply::Continue
        }
    })));
    let report = problem.solve().unwrap();
    assert_eq!((report.outcome, report.counts.steps()), (Outcome::Cancelled, 5));
}
