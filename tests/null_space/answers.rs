//! Answers with stiffnesses of few digits.

use feti_contact::solver::{Modes, Outcome, RowKind};

use crate::null_space::digits::{in_single_precision, printed, quads};
use crate::null_space::registered;
use crate::null_space::rows::add_rows;

/// A block pressed on the ground, held sideways at one dof: the forces on the ground are those of the stiffness of all
/// digits but for what its rounding changes.
#[test]
fn forces_on_a_floating_block_of_few_digits_are_those_of_all_digits() {
    let n = 40;
    let block = quads(n);
    let k = block.stiffness();
    let mut f = vec![0.0; k.rows];
    for i in 0..=n {
        f[2 * block.node([i, n, 0]) + 1] = -1.0 - i as f64 / n as f64;
    }
    let solve = |k: &decks::Csr, given: bool| {
        let mut problem = registered(k);
        problem.set_load(0, &f).unwrap();
        if given {
            let modes = block.rigid_modes();
            problem.set_null_space(0, k.rows, 3, &modes.concat(), k.rows, Modes::Exact).unwrap();
        }
        add_rows(
            &mut problem,
            &(0..=n).map(|i| vec![(2 * block.node([i, 0, 0]) + 1, -1.0)]).collect::<Vec<_>>(),
            0.0,
        );
        let side = [vec![(2 * block.node([0, 0, 0]), 1.0)]];
        crate::null_space::rows::add_equalities(&mut problem, &side);
        let report = problem.solve().unwrap();
        let doubtful = problem.findings().unwrap().doubtful.clone();
        (
            report.outcome,
            report.certificate,
            problem.multipliers(RowKind::Inequality).unwrap().to_vec(),
            doubtful,
        )
    };
    let (outcome, _, right, _) = solve(&k, true);
    assert_eq!(outcome, Outcome::Solved);
    let largest = right.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    for (near, digits) in (7..=15).map(|d| (printed(&k, d), d)).chain([(in_single_precision(&k), 0)]) {
        let (outcome, certificate, forces, told) = solve(&near, false);
        let error = forces.iter().zip(&right).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
        assert_eq!(outcome, Outcome::Solved, "{digits} digits: {certificate:?}");
        assert!(!told.is_empty() || digits >= 10, "{digits} digits: in silence");
        assert!(error < if digits >= 10 { 1e-5 } else { 1e-2 }, "{digits} digits: {error:.1e}");
    }
}
