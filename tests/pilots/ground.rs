//! Loaded pilots that rows hold to the ground, at places given by hand: no deformation F / kp says how exact these places are.

use feti_contact::error::Kind;
use feti_contact::solver::{Problem, RowKind};

use crate::pilots::{add_body, add_rows, assert_near, forces, solved, DUMMY};

/// A bar k between two nodes, the first on a support k, and pilots kp with the load F.
fn bar_and_pilots(k: f64, pilots: usize, kp: f64, force: f64) -> Problem {
    let mut problem = Problem::new();
    add_body(&mut problem, &[2.0 * k, -k, -k, k], &[0.0, 0.0]);
    (0..pilots).for_each(|_| add_body(&mut problem, &[kp], &[force]));
    problem
}

/// A pilot with the load F is set to a place by a row and leads the end of the bar: u = (place / 2, place), k place / 2 at the end.
/// Without a tie it is a problem of its own, in which nothing says that 1e-300 is little: only from 1e-20 on.
#[test]
fn a_loaded_pilot_set_to_a_place_is_there() {
    let (k, force, place) = (1e6, 4e4, -0.00125);
    for (kp, tied) in DUMMY.into_iter().flat_map(|kp| [(kp, true), (kp, false)]) {
        if !tied && kp > 0.0 && kp < 1e-20 {
            continue;
        }
        let mut problem = bar_and_pilots(k, 1, kp, force);
        add_rows(&mut problem, RowKind::Equality, &[(&[(2, 1.0)], place)]);
        let end = if tied { place } else { 0.0 };
        if tied {
            add_rows(&mut problem, RowKind::Equality, &[(&[(1, 1.0), (2, -1.0)], 0.0)]);
        }
        let what = format!("kp {kp:e}, tied {tied}");
        solved(&mut problem, &what);
        assert_near(problem.displacements().unwrap(), &[end / 2.0, end, place], 1e-12, &what);
        let held = force - kp * place - k * end / 2.0;
        assert_near(&forces(&problem)[1][..1], &[held], 1e-9, &what);
    }
}

/// The pilot is pressed onto a wall at a gap, which its load would pass by F / kp, and leads the end of the bar.
#[test]
fn a_pilot_pressed_onto_a_wall_stops_there() {
    let (k, force, gap) = (1e6, 4e4, 0.003);
    for kp in DUMMY {
        let mut problem = bar_and_pilots(k, 1, kp, force);
        add_rows(&mut problem, RowKind::Equality, &[(&[(1, 1.0), (2, -1.0)], 0.0)]);
        add_rows(&mut problem, RowKind::Inequality, &[(&[(2, 1.0)], gap)]);
        let what = format!("kp {kp:e}");
        solved(&mut problem, &what);
        assert_near(problem.displacements().unwrap(), &[gap / 2.0, gap, gap], 1e-12, &what);
        assert_near(&forces(&problem)[0], &[force - kp * gap - k * gap / 2.0], 1e-9, &what);
    }
}

/// Of three loaded pilots in one row one is set to a place, one is tied to the bar, and the row finds the third: u_4 = u_1 + 2 u_2.
#[test]
fn pilots_that_rows_hold_one_by_one_hold_the_others_of_their_rows() {
    let (k, force, place) = (1e6, 4e4, 0.25);
    for kp in DUMMY {
        let mut problem = bar_and_pilots(k, 3, kp, force);
        let rows: [(&[_], f64); 3] =
            [(&[(2, 1.0)], place), (&[(1, 1.0), (3, -1.0)], 0.0), (&[(3, 1.0), (2, 2.0), (4, -1.0)], 0.0)];
        add_rows(&mut problem, RowKind::Equality, &rows);
        let what = format!("kp {kp:e}");
        solved(&mut problem, &what);
        // on the bar: 2 F, less the pilots' own springs kp
        let end = (2.0 * force - 2.0 * kp * place) / (0.5 * k + 2.0 * kp);
        let expected = [end / 2.0, end, place, end, end + 2.0 * place];
        assert_near(problem.displacements().unwrap(), &expected, 1e-9, &what);
    }
}

/// A row that asks for another place than the one to which the pilot is set is a contradiction, however soft the pilot is.
#[test]
fn two_places_for_one_loaded_pilot_contradict_each_other() {
    for kp in DUMMY {
        let mut problem = bar_and_pilots(1e6, 1, kp, 4e4);
        add_rows(&mut problem, RowKind::Equality, &[(&[(2, 1.0)], 0.25), (&[(1, 1.0), (2, -1.0)], 0.0)]);
        add_rows(&mut problem, RowKind::Inequality, &[(&[(2, 1.0)], 0.25 - 1e-6)]);
        let error = problem.solve().expect_err(&format!("kp {kp:e}"));
        assert_eq!(error.kind, Kind::GapsContradict, "kp {kp:e}: {error}");
    }
}
