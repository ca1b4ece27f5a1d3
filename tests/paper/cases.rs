//! The eight reference cases of the paper's problems by its methods, to 1e-4.

use crate::reference::case::{difference, Case};
use feti_contact::solver::{Modes, Outcome, Report, RowKind, Storage};

pub const CASES: [&str; 8] =
    ["p1_P1", "p1_P3", "p1_P3_galerkin", "p2_A", "p2_B1", "p2_B2", "p3_2block", "p3_3block"];
pub const METHODS: [&str; 3] = ["paper-feasible", "paper-monotone", "paper-extrapolating"];

/// In relative units, so that one tolerance serves all.
fn solve(case: &Case, method: &str, gamma: f64) -> (Report, f64) {
    let mut problem = case.problem(false);
    problem.set_str("method", method).unwrap();
    problem.set_f64("gamma", gamma).unwrap();
    problem.set_f64("tolerance", 1e-6).unwrap();
    problem.set_f64("certificate_tolerance", 1e-4).unwrap();
    let report = problem.solve().unwrap();
    let error = difference(problem.multipliers(RowKind::Inequality).unwrap(), &case.lambda);
    (report, error)
}

#[test]
fn every_case_is_solved_to_1e_4_by_every_variant() {
    for name in CASES {
        let case = Case::read(name);
        let gammas: &[f64] = if name.starts_with("p3") { &[1.0, 10.0] } else { &[0.1, 1.0, 10.0] };
        for (method, &gamma) in METHODS.into_iter().flat_map(|m| gammas.iter().map(move |g| (m, g))) {
            let (report, error) = solve(&case, method, gamma);
            assert_eq!(report.outcome, Outcome::Solved, "{name} {method} {gamma}");
            assert!(error <= 1e-4, "{name} {method} {gamma}: forces differ by {error:.1e}");
            assert!(
                report.counts.outer >= 1 && report.counts.outer <= 4,
                "{name} {method}: {} outer",
                report.counts.outer
            );
        }
    }
}

/// rho_0 = 100, M = 1, eta_0 = .001, alpha = .1, beta = 100, mu^0 = 0 as absolute numbers in the units of the data.
fn solve_as_printed(case: &Case, method: &str, gamma: f64, steps: i64) -> (Report, f64) {
    let mut problem = case.problem(false);
    problem.set_str("method", method).unwrap();
    problem.set_str("paper_units", "printed").unwrap();
    problem.set_str("paper_step_1", "printed").unwrap();
    problem.set_f64("gamma", gamma).unwrap();
    problem.set_f64("tolerance", 1e-6).unwrap();
    problem.set_f64("certificate_tolerance", 1e-4).unwrap();
    problem.set_i64("max_steps", steps).unwrap();
    let report = problem.solve().unwrap();
    let error = difference(problem.multipliers(RowKind::Inequality).unwrap(), &case.lambda);
    (report, error)
}

#[test]
fn every_case_is_solved_to_1e_4_with_the_printed_defaults_for_gamma_1_and_10() {
    for name in CASES {
        let case = Case::read(name);
        for (method, gamma) in METHODS.into_iter().flat_map(|m| [1.0, 10.0].map(|g| (m, g))) {
            let (report, error) = solve_as_printed(&case, method, gamma, 10_000);
            assert_eq!(report.outcome, Outcome::Solved, "{name} {method} {gamma}");
            assert!(error <= 1e-4, "{name} {method} {gamma}: forces differ by {error:.1e}");
        }
    }
}

/// The worst choice: thousands of steps where several modes float, and no answer called solved.
#[test]
fn with_gamma_a_tenth_the_printed_defaults_end_at_the_limit_of_steps_on_six_modes() {
    for (name, method) in [
        ("p2_B2", "paper-monotone"),
        ("p2_B2", "paper-extrapolating"),
        ("p3_3block", "paper-monotone"),
        ("p3_3block", "paper-extrapolating"),
        ("p3_3block", "paper-feasible"),
    ] {
        let (report, _) = solve_as_printed(&Case::read(name), method, 0.1, 3000);
        assert_eq!(report.outcome, Outcome::Iterations, "{name} {method}");
        assert!(!report.certificate.passed(), "{name} {method}");
    }
}

#[test]
fn the_default_solves_every_case_to_1e_9_in_fewer_products() {
    for name in CASES {
        let case = Case::read(name);
        let mut problem = case.problem(false);
        problem.set_f64("certificate_tolerance", 1e-9).unwrap();
        let report = problem.solve().unwrap();
        let error = difference(problem.multipliers(RowKind::Inequality).unwrap(), &case.lambda);
        assert_eq!(report.outcome, Outcome::Solved, "{name}");
        assert!(error <= 1e-9, "{name}: forces differ by {error:.1e}");
        let (paper, _) = solve(&case, "paper-extrapolating", 1.0);
        assert!(report.counts.products < paper.counts.products, "{name}");
    }
}

/// As a boundary element code hands them over: full matrices, column-major.
#[test]
fn dense_bodies_of_141_to_144_unknowns_have_the_forces_of_the_same_matrices_by_rows() {
    for name in ["p2_A", "p2_B1", "p2_B2"] {
        let case = Case::read(name);
        for method in METHODS.into_iter().chain(["proportioning"]) {
            let mut problem = case.problem(false);
            for (body, (k, r)) in case.bodies.iter().enumerate() {
                let n = k.ptr.len() - 1;
                assert!((141..=144).contains(&n));
                let mut dense = vec![0.0; n * n];
                for i in 0..n {
                    for at in k.ptr[i]..k.ptr[i + 1] {
                        let j = k.col[at] as usize;
                        (dense[i + j * n], dense[j + i * n]) = (k.val[at], k.val[at]);
                    }
                }
                problem.set_stiffness_dense(body, n, &dense, n, Storage::Full).unwrap();
                problem.set_null_space(body, n, r.len() / n, r, n, Modes::Exact).unwrap();
            }
            problem.set_str("method", method).unwrap();
            problem.set_f64("tolerance", 1e-6).unwrap();
            problem.set_f64("certificate_tolerance", 1e-4).unwrap();
            assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved, "{name} {method}");
            let error = difference(problem.multipliers(RowKind::Inequality).unwrap(), &case.lambda);
            assert!(error <= 1e-4, "{name} {method}: forces differ by {error:.1e}");
        }
    }
}

#[test]
fn a_start_from_the_last_forces_needs_few_steps_in_either_units() {
    for units in ["relative", "printed"] {
        let mut problem = Case::read("p1_P3").problem(false);
        problem.set_str("method", "paper-monotone").unwrap();
        problem.set_str("paper_units", units).unwrap();
        problem.set_str("start", "previous").unwrap();
        problem.set_f64("tolerance", 1e-6).unwrap();
        problem.set_f64("certificate_tolerance", 1e-4).unwrap();
        let cold = problem.solve().unwrap();
        let warm = problem.solve().unwrap();
        assert!(cold.outcome == Outcome::Solved && warm.outcome == Outcome::Solved);
        assert!(
            2 * warm.counts.steps() < cold.counts.steps(),
            "{units}: {} steps after {}",
            warm.counts.steps(),
            cold.counts.steps()
        );
    }
}

#[test]
fn the_course_in_relative_units_depends_on_no_unit() {
    let case = Case::read("p2_B1");
    let (plain, _) = solve(&case, "paper-monotone", 1.0);
    for (newton, metre) in [(1048576.0, 1.0), (1.0, 1.0 / 1024.0), (8.0, 64.0)] {
        let mut scaled = Case::read("p2_B1");
        scaled.bodies.iter_mut().for_each(|(k, _)| k.val.iter_mut().for_each(|v| *v *= newton / metre));
        scaled.load.iter_mut().for_each(|f| *f *= newton);
        scaled.contact.1.iter_mut().for_each(|c| *c *= metre);
        scaled.lambda.iter_mut().for_each(|l| *l *= newton);
        let (report, error) = solve(&scaled, "paper-monotone", 1.0);
        let counts = |r: &Report| {
            (
                r.counts.outer,
                r.counts.conjugate_gradient,
                r.counts.expansions,
                r.counts.releases,
                r.counts.products,
            )
        };
        assert_eq!(counts(&report), counts(&plain), "{newton} {metre}");
        assert!(error <= 1e-4);
    }
}
