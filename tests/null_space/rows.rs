//! Rows of bodies whose null space was found: what no rigid motion moves along holds no load.

use decks::{Block, Csr};
use feti_contact::error::Kind;
use feti_contact::solver::{Modes, Outcome, Problem, RowKind, RowsInput, Storage};

use crate::null_space::registered;

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

/// Two chains with springs 1e7 times softer than their stiffest, tied to each other at four nodes: what the rounding of their
/// entries leaves open in their rigid motions, 3e-9 of them, does not hold the pair.
#[test]
fn ties_hold_no_motion_that_is_known_no_better_than_they_resist_it() {
    let first = [
        26.376636007039863,
        26.376657562591866,
        9.337324774895034e-5,
        0.0006815374733838601,
        0.0006147453288717912,
        0.171596579357899,
        32.98113899572541,
        32.809547441918745,
    ];
    let second = [
        12.938111450856116,
        12.938122024157963,
        4.580089309273129e-5,
        0.00033430372949081957,
        0.00030154124190490486,
        0.084170538946878,
        16.177713184842194,
        16.093545110998974,
    ];
    let between = [
        [
            26.376636007039863,
            2.155555200208019e-5,
            7.181769574687016e-5,
            0.00060971977763699,
            5.0255512348013064e-6,
            0.1715915538066642,
            32.809547441918745,
        ],
        [
            12.938111450856116,
            1.0573301846118799e-5,
            3.5227591246612494e-5,
            0.0002990761382442071,
            2.465103660697781e-6,
            0.0841680738432173,
            16.093545110998974,
        ],
    ];
    let mut problem = Problem::new();
    for (diagonal, springs) in [first, second].iter().zip(&between) {
        let mut k = vec![0.0; 64];
        (0..8).for_each(|i| k[9 * i] = diagonal[i]);
        springs.iter().enumerate().for_each(|(i, spring)| (k[9 * i + 1], k[9 * i + 8]) = (-spring, -spring));
        let p = problem.add_body(8).unwrap();
        problem.set_stiffness_dense(p, 8, &k, 8, Storage::Full).unwrap();
    }
    problem.set_load(0, &[-7.0, -21000.0, 4.0, 50.0, 60.0, 1200.0, 4000.0, -8.0]).unwrap();
    problem.set_load(1, &[-3.0, 21188.0, 0.0, 28.0, -144.0, -1282.0, -3897.0, -189.0]).unwrap();
    add_equalities(&mut problem, &[1, 4, 5, 6].map(|i| vec![(i, 1.0), (8 + i, -1.0)]));
    let report = problem.solve().unwrap();
    let far = (0..16).map(|i| problem.displacement(i / 8).unwrap()[i % 8].abs()).fold(0.0, f64::max);
    assert_eq!((report.outcome, report.undetermined), (Outcome::Solved, 1), "{:?}", report.certificate);
    assert!(far < 1e10, "|u| is {far:.1e}");
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
