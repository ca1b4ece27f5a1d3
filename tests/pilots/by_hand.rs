//! Springs and pilots of a few unknowns, with answers by hand for every dummy stiffness.

use feti_contact::solver::{Problem, RowKind};

use crate::pilots::{add_body, add_rows, assert_a_shift_is_refused, assert_near, forces, solved, DUMMY};

const K: f64 = 1e6;

/// A pilot pressed by 1000 onto three springs through gaps: `kp d + sum k (d - g_i) = F`.
fn pressed(kp: f64) -> (Problem, [f64; 3], f64) {
    let (gaps, load) = ([0.0, 1e-4, 5e-4], 1000.0);
    let d = (load + K * 6e-4) / (3.0 * K + kp);
    let mut problem = Problem::new();
    (0..3).for_each(|_| add_body(&mut problem, &[K], &[0.0]));
    add_body(&mut problem, &[kp], &[load]);
    let row = |i: usize| [(i, -1.0), (3, 1.0)];
    let rows = [row(0), row(1), row(2)];
    let rows: Vec<_> = rows.iter().zip(gaps).map(|(row, gap)| (&row[..], gap)).collect();
    add_rows(&mut problem, RowKind::Inequality, &rows);
    (problem, gaps.map(|gap| K * (d - gap)), d)
}

#[test]
fn a_pilot_pressed_onto_springs_has_the_forces_of_equilibrium() {
    for kp in DUMMY {
        let (mut problem, expected, d) = pressed(kp);
        solved(&mut problem, &format!("kp {kp:e}"));
        assert_near(&forces(&problem)[0], &expected, 1e-9, &format!("kp {kp:e}"));
        assert_near(problem.displacement(3).unwrap(), &[d], 1e-9, &format!("kp {kp:e}"));
    }
}

/// Three springs, the pilot and a spring apart in one matrix: as bodies of their own.
#[test]
fn one_matrix_for_springs_and_pilot_gives_the_same_forces_and_verdicts() {
    for kp in DUMMY {
        let what = format!("kp {kp:e}");
        let (_, right, d) = pressed(kp);
        let diagonal = [K, K, K, kp];
        let dense: Vec<f64> = (0..16).map(|at| if at % 5 == 0 { diagonal[at / 5] } else { 0.0 }).collect();
        let mut problem = Problem::new();
        add_body(&mut problem, &dense, &[0.0, 0.0, 0.0, 1000.0]);
        let row = |i: usize| [(i, -1.0), (3, 1.0)];
        let rows = [row(0), row(1), row(2)];
        let rows: Vec<_> = rows.iter().zip([0.0, 1e-4, 5e-4]).map(|(row, gap)| (&row[..], gap)).collect();
        add_rows(&mut problem, RowKind::Inequality, &rows);
        solved(&mut problem, &what);
        assert_near(&forces(&problem)[0], &right, 1e-9, &what);
        let u = [right[0] / K, right[1] / K, right[2] / K, d];
        assert_a_shift_is_refused(&mut problem, &u, &right, K, &what);
    }
}

/// Forces shifted from one row to another keep the balance of the pilot; the springs follow them.
#[test]
fn a_shift_of_forces_by_a_millionth_is_refused() {
    for kp in DUMMY {
        let (mut problem, right, d) = pressed(kp);
        let u = [right[0] / K, right[1] / K, right[2] / K, d];
        assert_a_shift_is_refused(&mut problem, &u, &right, K, &format!("kp {kp:e}"));
    }
}

/// The neighbour of 1e6 times the energy hangs on the first spring by a row of 1e-6 of its motion.
#[test]
fn a_shift_beside_a_neighbour_of_a_million_times_the_energy_is_refused() {
    for kp in DUMMY {
        let (mut problem, right, d) = pressed(kp);
        let (push, first) = (1e6, 4);
        add_body(&mut problem, &[K], &[push]);
        // the spring moves 1e-6 with it
        add_rows(&mut problem, RowKind::Inequality, &[(&[(0, -1e-6), (first, 1.0)], 2.0 * push / K)]);
        let lambda = [right[0], right[1], right[2], 0.0];
        let u = [right[0] / K, right[1] / K, right[2] / K, d, push / K];
        assert_a_shift_is_refused(&mut problem, &u, &lambda, K, &format!("kp {kp:e}"));
    }
}

/// A tool moved by -1 against a spring: the spring takes k, the tie k + kp.
#[test]
fn a_tool_moved_by_a_tie_presses_the_block() {
    for kp in DUMMY {
        let what = format!("kp {kp:e}");
        let mut problem = Problem::new();
        add_body(&mut problem, &[K], &[0.0]);
        add_body(&mut problem, &[kp], &[0.0]);
        add_rows(&mut problem, RowKind::Inequality, &[(&[(0, 1.0), (1, -1.0)], 0.0)]);
        add_rows(&mut problem, RowKind::Equality, &[(&[(1, 1.0)], -1.0)]);
        solved(&mut problem, &what);
        let [lambda, mu] = forces(&problem);
        assert_near(&lambda, &[K], 1e-9, &what);
        assert_near(&mu, &[K + kp], 1e-9, &what);
        assert_near(problem.displacements().unwrap(), &[-1.0; 2], 1e-9, &what);
    }
}

/// A master tied to springs k, 2 k, 3 k takes its load in these shares.
#[test]
fn a_master_gives_its_load_to_the_springs_tied_to_it() {
    for kp in DUMMY {
        let what = format!("kp {kp:e}");
        let mut problem = Problem::new();
        (1..=3).for_each(|k| add_body(&mut problem, &[f64::from(k) * K], &[0.0]));
        add_body(&mut problem, &[kp], &[1000.0]);
        let row = |i: usize| [(i, 1.0), (3, -1.0)];
        let rows = [row(0), row(1), row(2)];
        add_rows(&mut problem, RowKind::Equality, &rows.each_ref().map(|row| (&row[..], 0.0)));
        solved(&mut problem, &what);
        let d = 1000.0 / (6.0 * K + kp);
        assert_near(&forces(&problem)[1], &[1.0, 2.0, 3.0].map(|k| -k * K * d), 1e-9, &what);
    }
}

/// A spring, three pilots tied to each other in a row, the last one loaded; a second spring stops the second pilot.
#[test]
fn a_chain_of_pilots_carries_the_load_to_the_springs() {
    for kp in DUMMY {
        let what = format!("kp {kp:e}");
        let mut problem = Problem::new();
        add_body(&mut problem, &[K], &[0.0]);
        [0.0, 0.0, 1000.0].into_iter().for_each(|load| add_body(&mut problem, &[kp], &[load]));
        add_body(&mut problem, &[2.0 * K], &[0.0]);
        let tie = |i: usize| [(i, 1.0), (i + 1, -1.0)];
        let ties = [tie(0), tie(1), tie(2)];
        add_rows(&mut problem, RowKind::Equality, &ties.each_ref().map(|row| (&row[..], 0.0)));
        add_rows(&mut problem, RowKind::Inequality, &[(&[(2, 1.0), (4, -1.0)], 1e-4)]);
        solved(&mut problem, &what);
        let d = (1000.0 + 2.0 * K * 1e-4) / (3.0 * (K + kp));
        let stop = 2.0 * K * (d - 1e-4);
        let [lambda, mu] = forces(&problem);
        assert_near(&lambda, &[stop], 1e-9, &what);
        assert_near(&mu, &[-K * d, -(K + kp) * d, kp * d - 1000.0], 1e-9, &what);
    }
}

/// A node with two displacements and a rotation, tied to three springs of equal stiffness in both directions: the springs at
/// r_i around their centre take -F / 3 - M e_z x r_i / sum |r|^2.
#[test]
fn a_rigid_node_distributes_force_and_moment() {
    let arms = [[1.0, 0.0], [-0.5, 0.75f64.sqrt()], [-0.5, -(0.75f64.sqrt())]];
    let (force, moment) = ([30.0, -1000.0], 300.0);
    for kp in DUMMY {
        let what = format!("kp {kp:e}");
        let mut problem = Problem::new();
        (0..3).for_each(|_| add_body(&mut problem, &[K, 0.0, 0.0, K], &[0.0; 2]));
        let (k, twist) = (kp, 10.0 * kp);
        add_body(&mut problem, &[k, 0.0, 0.0, 0.0, k, 0.0, 0.0, 0.0, twist], &[force[0], force[1], moment]);
        let mut rows = Vec::new();
        for (i, [x, y]) in arms.into_iter().enumerate() {
            rows.push([(2 * i, 1.0), (6, -1.0), (8, y)]);
            rows.push([(2 * i + 1, 1.0), (7, -1.0), (8, -x)]);
        }
        let rows: Vec<_> = rows.iter().map(|row| (&row[..], 0.0)).collect();
        add_rows(&mut problem, RowKind::Equality, &rows);
        solved(&mut problem, &what);
        let d = force.map(|f| f / (3.0 * K + k));
        let turn = moment / (3.0 * K + twist);
        let expected: Vec<f64> =
            arms.iter().flat_map(|[x, y]| [-K * (d[0] - y * turn), -K * (d[1] + x * turn)]).collect();
        assert_near(&forces(&problem)[1], &expected, 1e-9, &what);
    }
}
