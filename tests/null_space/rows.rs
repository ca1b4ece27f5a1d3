//! Rows of bodies whose null space was found: what no rigid motion moves along holds no load.

use decks::{Block, Csr};
use feti_contact::error::Kind;
use feti_contact::solver::{Modes, Outcome, Problem, RowKind, RowsInput};

use crate::registered;

/// Contact rows of these entries, with one gap.
pub fn add_rows(problem: &mut Problem, rows: &[Vec<(usize, f64)>], gap: f64) {
    add(problem, RowKind::Inequality, rows, gap);
}

fn add(problem: &mut Problem, kind: RowKind, rows: &[Vec<(usize, f64)>], gap: f64) {
    let ptr: Vec<usize> = (0..=rows.len()).map(|i| rows[..i].iter().map(Vec::len).sum::<usize>()).collect();
    let dof: Vec<i64> = rows.iter().flatten().map(|entry| entry.0 as i64).collect();
    let val: Vec<f64> = rows.iter().flatten().map(|entry| entry.1).collect();
    let rhs = vec![gap; rows.len()];
    let rows = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: Some(&rhs) };
    problem.add_rows(kind, rows).unwrap();
}

/// K (-1, 0, 0, 1)' = 0; rounding of the motion found was more than 64 eps.
#[test]
fn a_row_on_a_dof_that_rests_in_every_motion_holds_nothing() {
    let k = [21.0, -8.0, 8.0, 21.0, -8.0, 30.0, 14.0, -8.0, 8.0, 14.0, 14.0, 8.0, 21.0, -8.0, 8.0, 21.0];
    let mut problem = registered(&Csr::from_dense(4, &k));
    problem.set_load(0, &[6.0, 3.0, -5.0, -2.0]).unwrap();
    add_rows(&mut problem, &[vec![(1, 3.0)], vec![(1, -3.0)]], 1.5);
    assert_eq!(problem.solve().unwrap_err().kind, Kind::LoadNotHeld);
}

/// A plate on rollers, free along x, with rows between its own nodes, as of a crack: they do not feel its motion.
#[test]
fn rows_inside_a_body_leave_its_balance_to_its_load() {
    let block =
        Block { dimension: 2, elements: [24, 24, 1], size: [10.0, 1.0, 1.0], young: 2e5, ..Block::default() };
    let on_roller = |dof: &usize| block.grid(dof / 2)[1] == 0 && dof % 2 == 1;
    let free: Vec<usize> = (0..2 * block.nodes()).filter(|dof| !on_roller(dof)).collect();
    let at = |x: usize, y: usize| free.binary_search(&(2 * block.node([x, y, 0]))).unwrap();
    let k = block.stiffness().restricted(&free);
    let along: Vec<f64> = free.iter().map(|dof| if dof % 2 == 0 { 1.0 } else { 0.0 }).collect();
    let rows: Vec<_> = (0..25).map(|x| vec![(at(x, 24), 1.0), (at((x + 2) % 25, 23), -1.0)]).collect();
    let solved = |given: bool, pull: f64| {
        let mut problem = registered(&k);
        if given {
            problem.set_null_space(0, k.rows, 1, &along, k.rows, Modes::Exact).unwrap();
        }
        let mut load = vec![0.0; k.rows];
        (load[at(24, 24)], load[at(0, 24)]) = (100.0, -100.0 + pull);
        problem.set_load(0, &load).unwrap();
        add_rows(&mut problem, &rows, 1e-5);
        let report = problem.solve()?;
        assert!(matches!(report.outcome, Outcome::Solved), "{:?}", report.certificate);
        Ok(problem.multipliers(RowKind::Inequality)?.to_vec())
    };
    let forces = |given: bool| -> Vec<f64> { solved(given, 0.0).unwrap() };
    let largest = forces(true).iter().fold(0.0, |largest: f64, force| largest.max(*force));
    assert!(largest > 1.0);
    assert!(forces(false).iter().zip(forces(true)).all(|(a, b)| (a - b).abs() < 1e-6 * largest));
    for given in [true, false] {
        let error: feti_contact::error::Error = solved(given, 30.0).unwrap_err();
        assert_eq!(error.kind, Kind::LoadNotHeld, "{error}");
    }
}

/// Equality rows of these entries, with value 0.
pub fn add_equalities(problem: &mut Problem, rows: &[Vec<(usize, f64)>]) {
    add(problem, RowKind::Equality, rows, 0.0);
}
