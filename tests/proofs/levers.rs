//! A load between two contact normals that are nearly opposite: forces far larger than the load hold it.

use decks::Body;
use feti_contact::error::Kind;
use feti_contact::solver::{Outcome, Problem, RowKind};

use crate::proofs::{body, deck, springs};
use crate::support::hand_over;

/// Two unknowns x, y that move rigidly, each a pair of equal ones joined by a spring.
fn free_point(load: [f64; 2]) -> Body {
    let pair = springs(4, &[(0, 1, 1.0), (2, 3, 1.0)], &[]);
    let modes = vec![vec![1.0, 1.0, 0.0, 0.0], vec![0.0, 0.0, 1.0, 1.0]];
    body(pair, modes, vec![load[0], 0.0, load[1], 0.0])
}

/// Walls with normals (1, -s) and (-1, -s): a load (0, -1) needs forces 1 / 2s, one of (0, 1) is not held.
fn wedge(s: f64, load: [f64; 2]) -> Problem {
    let walls: [(&[(usize, f64)], f64); 2] = [(&[(0, 1.0), (2, -s)], 0.0), (&[(0, -1.0), (2, -s)], 0.0)];
    hand_over::problem(&deck(vec![free_point(load)], &walls, &[])).unwrap()
}

#[test]
fn a_wedge_holds_its_load_however_flat_it_is() {
    for power in 0..=6 {
        for side in [0.0, 0.3, -0.999_999] {
            let s = 0.7 * 10f64.powi(-power);
            let load = [side / s * s, -1.0];
            let mut problem = wedge(s, load);
            let report = problem.solve().unwrap_or_else(|error| panic!("{s:e} {side}: {error}"));
            assert_eq!(report.outcome, Outcome::Solved, "{s:e} {side}");
            let forces = problem.multipliers(RowKind::Inequality).unwrap();
            let wanted = [0.5 / s + 0.5 * load[0], 0.5 / s - 0.5 * load[0]];
            for (found, wanted) in forces.iter().zip(wanted) {
                assert!(
                    (found - wanted).abs() <= 1e-6 * wanted.max(1.0),
                    "{s:e} {side}: {found:e} {wanted:e}"
                );
            }
        }
    }
}

#[test]
fn a_load_out_of_the_wedge_is_named_however_flat_it_is() {
    for power in 0..=6 {
        let s = 0.7 * 10f64.powi(-power);
        let error = wedge(s, [0.0, 1.0]).solve().unwrap_err();
        assert_eq!(error.kind, Kind::LoadNotHeld, "{s:e}: {error}");
    }
}

/// A beam of rigid unknowns (deflection, rotation) on many supports whose normals fan out within `s`: the load lies in
/// the cone of the outer two.
#[test]
fn a_fan_of_many_nearly_equal_normals_holds_a_load_between_them() {
    for (s, count) in [(1e-2, 50), (1e-4, 200), (1e-6, 200)] {
        let normals: Vec<[(usize, f64); 2]> = (0..count)
            .map(|k| {
                let at = 2.0 * k as f64 / (count - 1) as f64 - 1.0;
                [(0, s * (at + 0.1 * (k as f64).sin() / count as f64)), (2, -1.0)]
            })
            .collect();
        let walls: Vec<(&[(usize, f64)], f64)> = normals.iter().map(|row| (&row[..], 0.0)).collect();
        let mut problem = hand_over::problem(&deck(vec![free_point([0.37 * s, -1.0])], &walls, &[])).unwrap();
        let report = problem.solve().unwrap_or_else(|error| panic!("{s:e} {count}: {error}"));
        assert_eq!(report.outcome, Outcome::Solved, "{s:e} {count}");
    }
}
