//! Pilots hung by weak springs on the body that they press: one connected matrix. Answers by hand for every stiffness of the springs.

use feti_contact::solver::{Problem, RowKind};

use crate::pilots::{add_body, add_rows, assert_a_shift_is_refused, assert_near, forces, solved, DUMMY};

const K: f64 = 1e6;
const GAPS: [f64; 3] = [0.0, 1e-4, 5e-4];
const LOAD: f64 = 1000.0;

/// The matrix of springs, each between two unknowns or an unknown and the ground.
fn springs(n: usize, all: &[(usize, Option<usize>, f64)]) -> Vec<f64> {
    let mut k = vec![0.0; n * n];
    for &(i, j, stiffness) in all {
        k[i * n + i] += stiffness;
        if let Some(j) = j {
            k[j * n + j] += stiffness;
            k[i * n + j] -= stiffness;
            k[j * n + i] -= stiffness;
        }
    }
    k
}

/// Three springs to the ground and a pilot in front of them, hung by kp on the last one and, if `held`, on the ground:
/// `k u_3 = lambda_3 + kp (d - u_3)`, `sum k (d - g_i) = F - kp d`.
fn pressed(kp: f64, held: bool) -> (Problem, [f64; 3], [f64; 4]) {
    let ground = if held { kp } else { 0.0 };
    let mut all = vec![(0, None, K), (1, None, K), (2, None, K), (3, Some(2), kp)];
    all.extend(held.then_some((3, None, kp)));
    let mut problem = Problem::new();
    add_body(&mut problem, &springs(4, &all), &[0.0, 0.0, 0.0, LOAD]);
    let row = |i: usize| [(i, -1.0), (3, 1.0)];
    let rows = [row(0), row(1), row(2)];
    let rows: Vec<_> = rows.iter().zip(GAPS).map(|(row, gap)| (&row[..], gap)).collect();
    add_rows(&mut problem, RowKind::Inequality, &rows);
    let d = (LOAD + K * 6e-4) / (3.0 * K + ground);
    let lambda = [K * d, K * (d - GAPS[1]), K * (d - GAPS[2]) - kp * GAPS[2]];
    (problem, lambda, [d, d - GAPS[1], d - GAPS[2], d])
}

#[test]
fn a_pilot_hung_on_a_spring_has_the_forces_of_equilibrium() {
    for kp in DUMMY {
        for held in [false, true] {
            let what = format!("kp {kp:e}, held {held}");
            let (mut problem, expected, u) = pressed(kp, held);
            solved(&mut problem, &what);
            assert_near(&forces(&problem)[0], &expected, 1e-9, &what);
            assert_near(problem.displacement(0).unwrap(), &u, 1e-9, &what);
        }
    }
}

#[test]
fn a_shift_of_forces_below_a_hung_pilot_is_refused() {
    for kp in DUMMY {
        let (mut problem, right, u) = pressed(kp, false);
        assert_a_shift_is_refused(&mut problem, &u, &right, K, &format!("kp {kp:e}"));
    }
}

/// A floating chain of stiff springs on three supports given by rows; the pilot hangs on both ends and is tied to the middle.
#[test]
fn a_pilot_hung_on_a_floating_chain_and_tied_to_it_leads_it() {
    for kp in DUMMY {
        let what = format!("kp {kp:e}");
        let (pilot, n) = (3, 4);
        let k = springs(n, &[(0, Some(1), K), (1, Some(2), K), (pilot, Some(0), kp), (pilot, Some(2), kp)]);
        let mut problem = Problem::new();
        add_body(&mut problem, &k, &[0.0, 0.0, 0.0, LOAD]);
        add_body(&mut problem, &[2.0 * K], &[0.0]);
        add_rows(&mut problem, RowKind::Equality, &[(&[(1, 1.0), (pilot, -1.0)], 0.0)]);
        add_rows(&mut problem, RowKind::Inequality, &[(&[(2, 1.0), (4, -1.0)], 1e-4)]);
        solved(&mut problem, &what);
        // the stop takes the load; the last spring and the pilot's spring beside it carry it there
        let stop = LOAD / (2.0 * K);
        let between = LOAD / (K + kp);
        let u = [stop + 1e-4 + between, stop + 1e-4 + between, stop + 1e-4, stop + 1e-4 + between];
        assert_near(&forces(&problem)[0], &[LOAD], 1e-9, &what);
        // on the pilot: load, its springs, the tie
        assert_near(&forces(&problem)[1], &[kp * (u[3] - u[2]) - LOAD], 1e-9, &what);
        assert_near(problem.displacement(0).unwrap(), &u, 1e-9, &what);
    }
}

/// A tool moved by a tie, hung on the spring before it.
#[test]
fn a_tool_hung_on_the_block_that_it_presses_is_moved_by_a_tie() {
    for kp in DUMMY {
        let what = format!("kp {kp:e}");
        let mut problem = Problem::new();
        add_body(&mut problem, &springs(2, &[(0, None, K), (1, Some(0), kp)]), &[0.0; 2]);
        add_rows(&mut problem, RowKind::Inequality, &[(&[(0, 1.0), (1, -1.0)], 1e-3)]);
        add_rows(&mut problem, RowKind::Equality, &[(&[(1, 1.0)], -1.0)]);
        solved(&mut problem, &what);
        let u = [-1.0 + 1e-3, -1.0];
        let weak = kp * (u[1] - u[0]);
        let [lambda, mu] = forces(&problem);
        assert_near(&lambda, &[K * (1.0 - 1e-3) + weak], 1e-9, &what);
        assert_near(&mu, &[lambda[0] - weak], 1e-9, &what);
        assert_near(problem.displacements().unwrap(), &u, 1e-9, &what);
    }
}

/// Two pilots hung one on the other and tied in a row, the first on a stiff spring.
#[test]
fn a_chain_of_hung_pilots_carries_the_load_to_the_spring() {
    for kp in DUMMY {
        let what = format!("kp {kp:e}");
        let k = springs(4, &[(0, None, K), (1, Some(0), kp), (2, Some(1), kp), (3, None, 2.0 * K)]);
        let mut problem = Problem::new();
        add_body(&mut problem, &k, &[0.0, 0.0, LOAD, 0.0]);
        add_rows(
            &mut problem,
            RowKind::Equality,
            &[(&[(0, 1.0), (1, -1.0)], 0.0), (&[(1, 1.0), (2, -1.0)], 0.0)],
        );
        add_rows(&mut problem, RowKind::Inequality, &[(&[(2, 1.0), (3, -1.0)], 1e-4)]);
        solved(&mut problem, &what);
        let d = (LOAD + 2.0 * K * 1e-4) / (3.0 * K);
        let stop = 2.0 * K * (d - 1e-4);
        let [lambda, mu] = forces(&problem);
        assert_near(&lambda, &[stop], 1e-9, &what);
        assert_near(&mu, &[-K * d, stop - LOAD], 1e-9, &what);
    }
}
