//! Unknowns that rows hold far better than K: pilots and reference nodes with a dummy stiffness kp. Their answers follow by
//! hand as kp -> 0, and differ from it by kp / k; `feti_check` refuses forces that are wrong by 1e-6.
//!
//! | module | claims |
//! |---|---|
//! | [`by_hand`] | pressed, moved and tied pilots, chains, a rigid node with rotation, at every kp |
//! | [`bolt`] | the section of a bolt, whose halves a pilot pulls together |
//! | [`changes`] | rows and stiffnesses that change whether an unknown is carried |
//! | [`elastic`] | an elastic punch on an elastic block, led by a pilot, alone or hung on it by weak springs |
//! | [`ground`] | loaded pilots that rows set to a place or press onto a wall |
//! | [`hung`] | pilots hung by weak springs on the body that they press, in one matrix |

mod bolt;
mod by_hand;
mod changes;
mod elastic;
mod ground;
mod hung;

use feti_contact::solver::{Outcome, Problem, Report, RowKind, RowsInput, Storage};

/// Dummy stiffnesses beside springs of about 1e6.
pub const DUMMY: [f64; 9] = [0.0, 1e-300, 1e-20, 1e-9, 1e-6, 1e-3, 1.0, 1e2, 1e4];

/// A body with a dense matrix, given by rows, and its load.
pub fn add_body(problem: &mut Problem, stiffness: &[f64], load: &[f64]) {
    let n = load.len();
    let body = problem.add_body(n).unwrap();
    problem.set_stiffness_dense(body, n, stiffness, n, Storage::Full).unwrap();
    problem.set_load(body, load).unwrap();
}

/// Rows over all unknowns, each with its entries and right-hand side.
pub fn add_rows(problem: &mut Problem, kind: RowKind, rows: &[(&[(usize, f64)], f64)]) {
    let (mut ptr, mut dof, mut val) = (vec![0], Vec::new(), Vec::new());
    for (entries, _) in rows {
        entries.iter().for_each(|&(j, v)| {
            dof.push(j as i64);
            val.push(v);
        });
        ptr.push(dof.len());
    }
    let rhs: Vec<f64> = rows.iter().map(|row| row.1).collect();
    let input = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: Some(&rhs) };
    problem.add_rows(kind, input).unwrap();
}

/// Solves; the certificate must hold.
pub fn solved(problem: &mut Problem, what: &str) -> Report {
    let report = problem.solve().unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(report.outcome, Outcome::Solved, "{what}: {report:?}");
    assert!(report.certificate.passed(), "{what}: {:?}", report.certificate);
    report
}

/// Forces of contact rows and of equality rows.
pub fn forces(problem: &Problem) -> [Vec<f64>; 2] {
    [RowKind::Inequality, RowKind::Equality].map(|kind| problem.multipliers(kind).unwrap().to_vec())
}

/// The right answer passes, whose second row is closed like its first; forces shifted by a millionth of the first from the second to
/// the first, which the springs k below these rows follow (unknowns 0 and 1), are refused.
pub fn assert_a_shift_is_refused(problem: &mut Problem, u: &[f64], lambda: &[f64], k: f64, what: &str) {
    for (shift, passes) in [(0.0, true), (1e-6, false)] {
        let (mut u, mut forces, by) = (u.to_vec(), lambda.to_vec(), shift * lambda[0]);
        (forces[0], forces[1]) = (forces[0] + by, forces[1] - by);
        (u[0], u[1]) = (u[0] + by / k, u[1] - by / k);
        let certificate = problem.check(&u, &forces, &[]).unwrap();
        assert_eq!(certificate.passed(), passes, "{what}, shift {shift:e}: {certificate:?}");
    }
}

/// Equal to `tolerance` of the largest expected value.
pub fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let size = expected.iter().fold(0.0f64, |size, v| size.max(v.abs()));
    let error = found.iter().zip(expected).fold(0.0f64, |error, (a, b)| error.max((a - b).abs()));
    assert!(error <= tolerance * size, "{what}: {error:e} of {size:e}: {found:?}, expected {expected:?}");
}
