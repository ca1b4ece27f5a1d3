//! Problem 1.

use crate::case::{difference, Case};
use feti_contact::solver::{Outcome, RowKind};

#[test]
fn explore() {
    for method in ["paper-extrapolating", "paper-feasible", "paper-monotone"] {
        for gamma in [1.0, 2.0, 10.0] {
            let case = Case::read("p1_P3");
            let mut problem = case.problem(false);
            problem.set_fixing(1, Some(&[440])).unwrap();
            problem.set_str("method", method).unwrap();
            problem.set_str("paper_units", "printed").unwrap();
            problem.set_f64("tolerance", 1e-5).unwrap();
            problem.set_f64("gamma", gamma).unwrap();
            problem.set_f64("certificate_tolerance", 1e-4).unwrap();
            let report = problem.solve().unwrap();
            println!(
                "{method} {gamma} {:?} outer {} cg {} exp {} rel {} products {} worst {:.1e} dl {:.1e} du {:.1e}",
                report.outcome, report.outer, report.cg_steps, report.expansions, report.releases,
                report.dual_applications, report.certificate.worst(),
                difference(problem.multipliers(RowKind::Inequality).unwrap(), &case.lambda),
                difference(&case.displacement(&problem), &case.u)
            );
        }
    }
}
