//! Bars whose direction is only rounded: along (cos 90, 1), with cos 90 = 6e-17, an element has 4e-33 of its stiffness
//! across.

use std::sync::{Arc, Mutex};

use feti_contact::error::Kind;
use feti_contact::solver::{LogLevel, Modes, Outcome, Problem, RowKind, RowsInput, Storage};

/// Entries of springs k along (c, s) between nodes of two unknowns; `None` is the ground.
type Bar = (Option<usize>, usize, f64, [f64; 2]);

fn stiffness(nodes: usize, bars: &[Bar]) -> Vec<f64> {
    let n = 2 * nodes;
    let mut k = vec![0.0; n * n];
    for &(a, b, stiffness, d) in bars {
        for (p, q) in [(a, a), (a, Some(b)), (Some(b), a), (Some(b), Some(b))] {
            let (Some(of), Some(with)) = (p, q) else { continue };
            let sign = if p == q { stiffness } else { -stiffness };
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                k[2 * of + i + n * (2 * with + j)] += sign * d[i] * d[j];
            }
        }
    }
    k
}

fn upright() -> [f64; 2] {
    let angle = 90f64.to_radians();
    [angle.cos(), angle.sin()]
}

/// Bars one above the other, free.
fn tower(nodes: usize, unit: f64) -> Problem {
    let mut problem = Problem::new();
    problem.add_body(2 * nodes).unwrap();
    let bars: Vec<Bar> = (1..nodes).map(|i| (Some(i - 1), i, unit, upright())).collect();
    let k = stiffness(nodes, &bars);
    problem.set_stiffness_dense(0, 2 * nodes, &k, 2 * nodes, Storage::Full).unwrap();
    problem
}

fn row(problem: &mut Problem, entries: &[(i64, f64)], c: f64) {
    let dof: Vec<i64> = entries.iter().map(|entry| entry.0).collect();
    let val: Vec<f64> = entries.iter().map(|entry| entry.1).collect();
    let rows = RowsInput { ptr: &[0, dof.len()], body: None, dof: &dof, val: &val, rhs: Some(&[c]) };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
}

fn load(problem: &mut Problem, n: usize, loads: &[(usize, f64)]) {
    let mut f = vec![0.0; n];
    loads.iter().for_each(|&(at, force)| f[at] = force);
    problem.set_load(0, &f).unwrap();
}

/// Lines about unknowns without stiffness.
fn lines(problem: &mut Problem) -> Arc<Mutex<Vec<String>>> {
    let lines = Arc::new(Mutex::new(Vec::new()));
    let heard = Arc::clone(&lines);
    let hear = move |_, line: &str| {
        heard.lock().unwrap().extend(line.contains("no stiffness").then(|| line.to_owned()));
        0
    };
    problem.on_log(Some((LogLevel::Result, Box::new(hear))));
    lines
}

#[derive(Debug, Clone, Copy)]
enum Given {
    Nothing,
    Exact,
    Candidates,
    Coordinates,
}

/// All motions across, and the one along.
fn give(problem: &mut Problem, nodes: usize, given: Given) {
    let n = 2 * nodes;
    let modes = match given {
        Given::Nothing => return,
        Given::Coordinates => {
            let [node, dir] = [0, 1].map(|part| {
                (0..n as i32).map(|i| if part == 0 { i / 2 } else { i % 2 + 1 }).collect::<Vec<_>>()
            });
            let [c, s] = upright();
            let xyz: Vec<f64> = (0..n).flat_map(|i| [(i / 2) as f64 * c, (i / 2) as f64 * s]).collect();
            return problem.set_coordinates(0, 2, &node, &dir, &xyz, 2).unwrap();
        }
        Given::Exact => Modes::Exact,
        Given::Candidates => Modes::Candidates,
    };
    let [c, s] = upright();
    let mut basis = vec![0.0; n * (nodes + 1)];
    for i in 0..nodes {
        (basis[n * i + 2 * i], basis[n * i + 2 * i + 1]) = (s, -c);
        (basis[n * nodes + 2 * i], basis[n * nodes + 2 * i + 1]) = (c, s);
    }
    problem.set_null_space(0, n, nodes + 1, &basis, n, modes).unwrap();
}

#[test]
fn what_the_rounding_of_a_direction_resists_is_no_stiffness() {
    for given in [Given::Nothing, Given::Exact, Given::Candidates, Given::Coordinates] {
        for nodes in [2, 3, 12] {
            for unit in [1e-6, 1.0, 1e6, 1e200] {
                let (n, mut problem) = (2 * nodes, tower(nodes, unit));
                give(&mut problem, nodes, given);
                load(&mut problem, n, &[(n - 1, unit)]);
                row(&mut problem, &[(1, 1.0)], 0.25);
                let heard = lines(&mut problem);
                let report = problem.solve().unwrap();
                let case = format!("{given:?}, {nodes} nodes, {unit:e}");
                assert_eq!((report.outcome, report.undetermined), (Outcome::Solved, 0), "{case}");
                let u = problem.displacements().unwrap().to_vec();
                for (i, pair) in u.chunks(2).enumerate() {
                    assert_eq!(pair[0], 0.0, "{case}");
                    assert!((pair[1] - 0.25 - i as f64).abs() < 1e-12 * nodes as f64, "{case}: {u:?}");
                }
                let lambda = problem.multipliers(RowKind::Inequality).unwrap()[0];
                assert!((lambda / unit - 1.0).abs() < 1e-12, "{case}");
                assert!(problem.check(&u, &[lambda], &[]).unwrap().worst() <= 1.0, "{case}");
                assert!(problem.check(&u, &[lambda * (1.0 + 1e-6)], &[]).unwrap().worst() > 1.0, "{case}");
                let across = unit * upright()[0].powi(2) * if nodes > 2 { 2.0 } else { 1.0 };
                let heard = heard.lock().unwrap();
                let told = [format!("{nodes} unknowns"), format!("at most {across:.1e}")];
                assert!(heard.len() == 1 && told.iter().all(|told| heard[0].contains(told)), "{heard:?}");
            }
        }
    }
}

#[test]
fn a_load_across_a_bar_is_not_held_and_a_row_holds_it() {
    let mut problem = tower(3, 1.0);
    load(&mut problem, 6, &[(4, 0.5), (5, 1.0)]);
    row(&mut problem, &[(1, 1.0)], 0.25);
    let error = problem.solve().unwrap_err();
    assert_eq!((error.kind, error.place.dof), (Kind::LoadNotHeld, Some(4)));
    row(&mut problem, &[(4, 1.0)], 0.125);
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let found = problem.displacements().unwrap();
    let known = [0.0, 0.25, 0.0, 1.25, 0.125, 2.25];
    assert!(found.iter().zip(known).all(|(u, known)| (u - known).abs() < 1e-13), "{found:?}");
}

#[test]
fn a_tower_that_is_cut_into_pieces_is_judged_without_what_rounding_resists() {
    for pieces in [1, 2, 4] {
        let (nodes, mut problem) = (12, Problem::new());
        problem.set_i64("pieces", pieces).unwrap();
        problem.add_body(2 * nodes).unwrap();
        let ptr: Vec<usize> = (0..nodes).map(|e| 4 * e).collect();
        let dof: Vec<i64> = (0..nodes as i64 - 1).flat_map(|e| 2 * e..2 * e + 4).collect();
        problem.set_mesh(0, &ptr, &dof).unwrap();
        let bar = stiffness(2, &[(Some(0), 1, 1.0, upright())]);
        (0..nodes - 1).for_each(|e| problem.add_element(0, e, 4, &bar, 4).unwrap());
        load(&mut problem, 2 * nodes, &[(2 * nodes - 1, 1.0)]);
        row(&mut problem, &[(1, 1.0)], 0.25);
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved, "{pieces} pieces");
        let found = problem.displacements().unwrap();
        assert!((found[2 * nodes - 1] - 11.25).abs() < 1e-9, "{pieces} pieces: {found:?}");
    }
}

/// A bar hangs on a node that other bars hold in both directions: its free end has no stiffness across.
#[test]
fn the_free_end_of_a_bar_that_hangs_on_a_truss_rests() {
    let mut problem = Problem::new();
    problem.add_body(4).unwrap();
    let bars = [(None, 0, 1.0, [0.8, 0.6]), (None, 0, 2.0, [-0.8, 0.6]), (Some(0), 1, 0.5, upright())];
    problem.set_stiffness_dense(0, 4, &stiffness(2, &bars), 4, Storage::Full).unwrap();
    load(&mut problem, 4, &[(3, -1.0)]);
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let found = problem.displacements().unwrap();
    // [1.92 -.48; -.48 1.08] u = (0, -1) at the upper node
    let upper = [-0.48 / 1.8432, -1.92 / 1.8432];
    let known = [upper[0], upper[1], 0.0, upper[1] - 2.0];
    assert!(found.iter().zip(known).all(|(u, known)| (u - known).abs() < 1e-13), "{found:?}");
}

/// A spring of 1e-30 is one. So is the stiffness of a body beside a support of 1e33 along a rounded direction.
#[test]
fn weak_springs_and_stiffness_beside_penalties_are_no_rounding() {
    let mut problem = Problem::new();
    problem.add_body(4).unwrap();
    let weak = [(None, 0, 1.0, [1.0, 0.0]), (None, 0, 1.0, [0.0, 1.0]), (Some(0), 1, 1e-30, [0.6, 0.8])];
    let mut k = stiffness(2, &weak);
    (k[10], k[15]) = (k[10] + 1e-30, k[15] + 1e-30);
    problem.set_stiffness_dense(0, 4, &k, 4, Storage::Full).unwrap();
    load(&mut problem, 4, &[(2, 1e-30)]);
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let found = problem.displacements().unwrap();
    // [1.36 .48; .48 1.64] u = (1, 0)
    assert!((found[2] - 0.82).abs() < 1e-12 && (found[3] + 0.24).abs() < 1e-12, "{found:?}");

    let mut problem = Problem::new();
    problem.add_body(4).unwrap();
    let bars = [
        (None, 0, 1e33, upright()),
        (Some(0), 1, 1.0, [1.0, 0.0]),
        (None, 1, 1.0, [1.0, 0.0]),
        (None, 1, 1.0, [0.0, 1.0]),
    ];
    problem.set_stiffness_dense(0, 4, &stiffness(2, &bars), 4, Storage::Full).unwrap();
    load(&mut problem, 4, &[(0, 1.0)]);
    let told = lines(&mut problem);
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    assert!(told.lock().unwrap().is_empty(), "x of the support has stiffness");
    assert!((problem.displacements().unwrap()[0] - 2.0).abs() < 1e-9, "{:?}", problem.displacements());
}

/// Two bodies, the second along the rounding of the normal of a row on the first.
#[test]
fn the_rounding_of_a_normal_joins_no_bodies() {
    for rounded in [upright()[0], 1e-14] {
        let mut problem = Problem::new();
        for load in [-0.3, 0.2] {
            let body = problem.add_body(1).unwrap();
            problem.set_stiffness_dense(body, 1, &[1.0], 1, Storage::Full).unwrap();
            problem.set_load(body, &[load]).unwrap();
        }
        row(&mut problem, &[(0, -1.0), (1, rounded)], 0.25);
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
        assert!((problem.multipliers(RowKind::Inequality).unwrap()[0] - 0.05).abs() < 1e-12);
    }
}

#[test]
fn a_lagrange_multiplier_beside_stiff_unknowns_is_no_rounding() {
    let mut problem = Problem::new();
    problem.add_body(2).unwrap();
    problem.set_stiffness_dense(0, 2, &[1e16, 1.0, 1.0, 0.0], 2, Storage::Full).unwrap();
    let error = problem.solve().unwrap_err();
    assert_eq!((error.kind, error.place.dof), (Kind::Indefinite, Some(1)));
}
