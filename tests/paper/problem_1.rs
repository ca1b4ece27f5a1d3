//! Problem 1 in the configuration that gives the printed figures: 3 outer, 23 inner, 34 products.

use crate::reference::case::Case;
use feti_contact::solver::{Outcome, Problem, Report, RowKind};

/// The node (x, y) = (2, 1) of the floating membrane.
const HELD: usize = 440;

fn solved(method: &str, gamma: f64, held: usize) -> (Problem, Report) {
    let mut problem = Case::read("p1_P3").problem(false);
    problem.set_fixing(1, Some(&[held])).unwrap();
    problem.set_str("method", method).unwrap();
    problem.set_str("paper_units", "printed").unwrap();
    problem.set_f64("tolerance", 1e-5).unwrap();
    problem.set_f64("gamma", gamma).unwrap();
    problem.set_f64("certificate_tolerance", 1e-4).unwrap();
    let report = problem.solve().unwrap();
    assert_eq!(report.outcome, Outcome::Solved);
    (problem, report)
}

/// 34 = 3 start gradients + 23 conjugate gradient steps (6 end on a bound) + 1 proportioning + 7 trials.
#[test]
fn problem_1_takes_3_outer_23_inner_steps_and_34_products_whatever_gamma() {
    for (gamma, step_1) in [(1.0, "corrected"), (2.0, "corrected"), (10.0, "corrected"), (1.0, "printed")] {
        let mut problem = Case::read("p1_P3").problem(false);
        problem.set_fixing(1, Some(&[HELD])).unwrap();
        problem.set_str("method", "paper-extrapolating").unwrap();
        problem.set_str("paper_units", "printed").unwrap();
        problem.set_str("paper_step_1", step_1).unwrap();
        problem.set_f64("tolerance", 1e-5).unwrap();
        problem.set_f64("gamma", gamma).unwrap();
        problem.set_f64("certificate_tolerance", 1e-4).unwrap();
        let report = problem.solve().unwrap();
        let steps = (report.counts.conjugate_gradient, report.counts.expansions, report.counts.releases);
        assert_eq!(
            (report.counts.outer, steps, report.counts.products),
            (3, (17, 6, 1), 34),
            "Gamma {gamma} {step_1}"
        );
    }
}

/// The multipliers printed in the errata, and what they add up to: the load on the floating membrane.
#[test]
fn problem_1_has_14_closed_nodes_and_the_known_forces() {
    const KNOWN: [f64; 14] = [
        0.01804740, 0.01846649, 0.01841815, 0.01799808, 0.01718358, 0.01582578, 0.01472723, 0.01371429,
        0.01269957, 0.01162257, 0.01042542, 0.00903506, 0.00733601, 0.00450036,
    ];
    let (problem, report) = solved("paper-extrapolating", 1.0, HELD);
    let forces = problem.multipliers(RowKind::Inequality).unwrap();
    assert!(forces[..14].iter().zip(&KNOWN).all(|(f, known)| (f - known).abs() < 1e-6), "{forces:?}");
    assert_eq!(forces[14..], [0.0; 7]);
    assert!((forces.iter().sum::<f64>() - 0.19).abs() < 1e-6);
    assert!((report.energy - -0.1954551937).abs() < 1e-7);
}

/// The course depends on K+, the answer does not.
#[test]
fn other_fixing_dofs_change_the_counts_and_not_the_forces() {
    let (held, _) = solved("paper-extrapolating", 1.0, HELD);
    for (other, inner, products) in [(0, 25, 35), (220, 19, 29)] {
        let (problem, report) = solved("paper-extrapolating", 1.0, other);
        let counts = (
            report.counts.outer,
            report.counts.conjugate_gradient + report.counts.expansions,
            report.counts.products,
        );
        assert_eq!(counts, (2, inner, products));
        let forces = problem.multipliers(RowKind::Inequality).unwrap();
        let known = held.multipliers(RowKind::Inequality).unwrap();
        assert!(forces.iter().zip(known).all(|(f, known)| (f - known).abs() < 2e-4), "dof {other}");
    }
}

#[test]
fn feasible_and_monotone_proportioning_need_28_products() {
    for method in ["paper-feasible", "paper-monotone"] {
        let (_, report) = solved(method, 1.0, HELD);
        assert_eq!((report.counts.outer, report.counts.products), (3, 28), "{method}");
    }
}

#[test]
fn fixing_dofs_that_do_not_hold_the_body_are_refused() {
    let mut problem = Case::read("p2_B2").problem(false);
    // three dofs of one line: the rotation about it is left
    problem.set_fixing(0, Some(&[0, 0, 1])).unwrap();
    assert!(problem.setup().unwrap_err().what.contains("do not hold"));
    problem.set_fixing(0, Some(&[0, 1])).unwrap();
    assert!(problem.setup().unwrap_err().what.contains("2 fixing dofs"));
    assert!(problem.set_fixing(0, Some(&[0, 1, 144])).is_err());
    problem.set_fixing(0, Some(&[1, 73, 114])).unwrap();
    assert_eq!(problem.fixing_dofs(0).unwrap(), [1, 73, 114]);
    problem.set_fixing(0, None).unwrap();
    assert_eq!(problem.fixing_dofs(0).unwrap().len(), 3);
}
