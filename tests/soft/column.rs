//! A rigid column that stands on two edges, with a load on top: one unknown, its tilt, with the stiffness -5. Springs of 100
//! at the lever 1 hold it through rows, 195 in all.

use feti_contact::error::{Kind, Result};
use feti_contact::solver::{Modes, Outcome, Problem, RowKind, RowsInput, Storage};

/// Units of force, of length.
const UNITS: [(f64, f64); 4] = [(1.0, 1.0), (1e-6, 1e6), (1e6, 1e-6), (1e6, 1e6)];

fn rows(problem: &mut Problem, kind: RowKind, rows: &[&[(i64, f64)]], rhs: &[f64]) {
    let (mut ptr, mut dof, mut val) = (vec![0], Vec::new(), Vec::new());
    for row in rows {
        dof.extend(row.iter().map(|entry| entry.0));
        val.extend(row.iter().map(|entry| entry.1));
        ptr.push(dof.len());
    }
    let rows = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: Some(rhs) };
    problem.add_rows(kind, rows).unwrap();
}

fn body(problem: &mut Problem, k: &[f64], load: &[f64]) -> usize {
    let n = load.len();
    let body = problem.add_body(n).unwrap();
    problem.set_stiffness_dense(body, n, k, n, Storage::Full).unwrap();
    problem.set_load(body, load).unwrap();
    body
}

fn soft(problem: &mut Problem, body: usize, motions: &[&[f64]]) -> Result<()> {
    let n = motions[0].len();
    problem.set_null_space(body, n, motions.len(), &motions.concat(), n, Modes::Soft)
}

/// Columns with the stiffness `tilt`, each on two springs that follow its edges.
fn columns(count: usize, tilt: f64, (force, length): (f64, f64)) -> Problem {
    let mut problem = Problem::new();
    for p in 0..count {
        let first = 3 * p as i64;
        body(&mut problem, &[tilt * force], &[0.1 * force * length]);
        (0..2).for_each(|_| _ = body(&mut problem, &[100.0 * force], &[0.0]));
        let edges: [&[(i64, f64)]; 2] =
            [&[(first, 1.0), (first + 1, -1.0)], &[(first, -1.0), (first + 2, -1.0)]];
        rows(&mut problem, RowKind::Equality, &edges, &[0.0; 2]);
    }
    problem
}

/// The certificate passes the answer, and refuses it if an unknown is shifted by 1e-6.
#[track_caller]
fn assert_answer(problem: &mut Problem, wanted: &[f64]) {
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let u = problem.displacements().unwrap().to_vec();
    let largest = wanted.iter().fold(0.0f64, |largest, u| u.abs().max(largest));
    assert!(u.iter().zip(wanted).all(|(u, w)| (u - w).abs() <= 1e-12 * largest), "{u:?} {wanted:?}");
    let forces =
        [RowKind::Inequality, RowKind::Equality].map(|kind| problem.multipliers(kind).unwrap().to_vec());
    assert!(problem.check(&u, &forces[0], &forces[1]).unwrap().worst() <= 1.0);
    for j in (0..u.len()).filter(|&j| u[j] != 0.0) {
        let mut moved = u.clone();
        moved[j] *= 1.0 + 1e-6;
        assert!(problem.check(&moved, &forces[0], &forces[1]).unwrap().worst() > 1.0, "unknown {j}");
    }
}

#[test]
fn a_rigid_column_stands_on_the_springs_that_its_rows_join_it_to() {
    for units in UNITS {
        for (count, tilt) in [(1, -5.0), (3, -5.0), (1, -199.0), (1, -5e-3)] {
            let mut problem = columns(count, tilt, units);
            (0..count).for_each(|p| soft(&mut problem, 3 * p, &[&[1.0]]).unwrap());
            let theta = 0.1 / (200.0 + tilt) * units.1;
            assert_answer(&mut problem, &[theta, theta, -theta].repeat(count));
        }
    }
}

/// The declaration may come before or after the matrix, as vectors or by coordinates; without it the unknown is named.
#[test]
fn a_negative_diagonal_entry_is_refused_unless_its_motions_are_declared_soft() {
    for tilt in [-5.0, -5e-9] {
        for modes in [None, Some(Modes::Exact), Some(Modes::Candidates)] {
            let mut problem = columns(2, tilt, UNITS[0]);
            soft(&mut problem, 0, &[&[1.0]]).unwrap();
            if let Some(modes) = modes {
                problem.set_null_space(3, 1, 1, &[1.0], 1, modes).unwrap();
            }
            let error = problem.solve().unwrap_err();
            assert_eq!((error.kind, error.place.body, error.place.dof), (Kind::Indefinite, Some(3), Some(0)));
            assert_eq!(error.place.value, Some(tilt));
            problem.set_coordinates(3, 1, &[0], &[1], &[0.0], 1).unwrap();
            problem.set_coordinate_modes(3, Modes::Soft).unwrap();
            if modes.is_none() {
                assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
            }
        }
    }
}

/// On edges that may open: both closed under the weight 10, and one open under .01, where the column tips over.
#[test]
fn a_column_on_edges_that_may_open_stands_if_its_weight_closes_both() {
    for (force, length) in UNITS {
        for weight in [10.0, 0.01] {
            let mut problem = Problem::new();
            let k = [0.0, 0.0, 0.0, -5.0 * force];
            body(&mut problem, &k, &[weight * force * length, 0.1 * force * length]);
            soft(&mut problem, 0, &[&[1.0, 0.0], &[0.0, 1.0]]).unwrap();
            rows(
                &mut problem,
                RowKind::Inequality,
                &[&[(0, 1.0), (1, 1.0)], &[(0, 1.0), (1, -1.0)]],
                &[0.0; 2],
            );
            problem.set_compliance(RowKind::Inequality, 0, &[0.01 / force; 2]).unwrap();
            if weight > 1.0 {
                assert_answer(&mut problem, &[weight / 200.0 * length, 0.1 / 195.0 * length]);
            } else {
                let error = problem.solve().unwrap_err();
                assert!(matches!(error.kind, Kind::Indefinite | Kind::LoadNotHeld), "{error}");
            }
        }
    }
}

#[test]
fn a_column_that_the_springs_do_not_hold_has_no_answer() {
    let mut problem = columns(1, -205.0, UNITS[0]);
    soft(&mut problem, 0, &[&[1.0]]).unwrap();
    assert_eq!(problem.solve().unwrap_err().kind, Kind::Indefinite);
    let motion = problem.escaping_motion(0).unwrap();
    assert!(motion.len() == 1 && (motion[0].abs() - 1.0).abs() < 1e-12, "{motion:?}");
}

/// The stiffnesses 1 and -1 in unknowns that are turned: the diagonal is 0 at 45 degrees, exactly or to rounding.
#[test]
fn a_diagonal_of_zero_beside_other_entries_is_that_of_a_soft_motion() {
    let (c, s) = 45f64.to_radians().sin_cos();
    for ([c, s], rest) in
        [([0.5f64.sqrt(); 2], 0.0), ([c, s], c * c - s * s), ([c, s], 1e-17), ([0.9, 0.19f64.sqrt()], 0.62)]
    {
        for force in [1e-6, 1.0, 1e6] {
            let (r, off) = (rest * force, 2.0 * c * s * force);
            let mut problem = Problem::new();
            body(&mut problem, &[r, off, off, -r], &[0.3 * force, 0.2 * force]);
            soft(&mut problem, 0, &[&[-s, c]]).unwrap();
            (0..2).for_each(|_| _ = body(&mut problem, &[3.0 * force], &[0.0]));
            let joints: [&[(i64, f64)]; 2] = [&[(0, 1.0), (2, -1.0)], &[(1, 1.0), (3, -1.0)]];
            rows(&mut problem, RowKind::Equality, &joints, &[0.0; 2]);
            let (a, b) = (3.0 + rest, 3.0 - rest);
            let (off, det) = (2.0 * c * s, a * b - 4.0 * c * c * s * s);
            let u = [(0.3 * b - 0.2 * off) / det, (0.2 * a - 0.3 * off) / det];
            assert_answer(&mut problem, &[u, u].concat());
        }
    }
}

/// Springs of 100 on both edges and -200: nothing resists the tilt, and no tilt balances a moment. Or two unknowns of stiffness
/// -1 and 1 that a row makes equal.
#[test]
fn a_stiffness_that_rows_cancel_exactly_leaves_no_minimum() {
    for units in UNITS {
        let mut problem = columns(1, -200.0, units);
        soft(&mut problem, 0, &[&[1.0]]).unwrap();
        assert_eq!(problem.solve().unwrap_err().kind, Kind::Indefinite, "{units:?}");
        let mut problem = Problem::new();
        body(&mut problem, &[-units.0, 0.0, 0.0, units.0], &[units.0 * units.1, 0.0]);
        soft(&mut problem, 0, &[&[1.0, 0.0]]).unwrap();
        rows(&mut problem, RowKind::Equality, &[&[(0, 1.0), (1, -1.0)]], &[0.0]);
        assert_eq!(problem.solve().unwrap_err().kind, Kind::Indefinite, "{units:?}");
    }
}
