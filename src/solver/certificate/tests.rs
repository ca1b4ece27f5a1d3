use super::*;
use crate::linalg::{Csr, Symmetric};

/// Noise / limit is 64 eps / 1e-8 of the terms of an entry, and adds to its whole.
const NOISY: f64 = 1e-5;

/// Spring 4 at a wall, loaded by 2 towards an obstacle at 0.25: u = .25, lambda = 1.
fn with(u: f64, lambda: f64, unit: f64) -> Certificate {
    on_a_spring(u, lambda, unit, f64::INFINITY)
}

/// The same with a spring in the contact row.
fn on_a_spring(u: f64, lambda: f64, unit: f64, stiffness_of_row: f64) -> Certificate {
    let held = Matrix { rows: 1, ..Matrix::default() };
    let contact = obstacle(0.25, 1.0 / (stiffness_of_row * unit));
    judged((&spring(4.0 * unit), &held, &[2.0 * unit]), &contact, (&[u], &[lambda * unit]), None)
}

fn spring(stiffness: f64) -> Symmetric {
    Symmetric::new(vec![0, 1], vec![0], vec![stiffness])
}

/// One row, u <= gap, of this compliance.
fn obstacle(gap: f64, compliance: f64) -> RowSet {
    let mut matrix = Csr::empty(1);
    matrix.push_row([(0, 1.0)]);
    RowSet { matrix: matrix.into(), rhs: vec![gap], compliance: vec![compliance] }
}

/// The certificate of (u, lambda) on one body, its stiffness, null space and load, by the work of the loads.
fn judged(
    (stiffness, null_space, load): (&Symmetric, &Matrix, &[f64]),
    contact: &RowSet,
    (u, lambda): (&[f64], &[f64]),
    work_of_loads: Option<f64>,
) -> Certificate {
    let body = BodyData { start: 0, stiffness: stiffness.into(), load: Some(load), null_space, unit: 1.0 };
    let equalities = &RowSet::default();
    let data = Data { bodies: vec![body], contact, equalities, without: 1.0, limit: 1e-8, work_of_loads };
    certify(&data, Answer { u, lambda, mu: &[] }).unwrap()
}

/// Two dofs joined by a spring, with nothing to hold them.
fn free_pair(load: [f64; 2], u: [f64; 2]) -> Certificate {
    let stiffness = Symmetric::new(vec![0, 1, 3], vec![0, 0, 1], vec![1.0, -1.0, 1.0]);
    let modes = Matrix { rows: 2, cols: 1, data: vec![0.5_f64.sqrt(); 2] };
    judged((&stiffness, &modes, &load), &RowSet::default(), (&u, &[]), None)
}

#[test]
fn no_distance_excuses_forces_that_do_not_balance() {
    for far in [0.0, 1.0, 1e10, 1e20] {
        let certificate = free_pair([0.5, 0.5], [far; 2]);
        assert!(!certificate.passed() && certificate.balance.ratio > 1.0, "{far:e}");
    }
}

#[test]
fn no_distance_excuses_a_strain_that_is_missing() {
    for far in [0.0, 1.0, 1e10, 1e16, 1e20] {
        assert!(free_pair([1.0, -1.0], [far; 2]).equilibrium.ratio > 1.0, "{far:e}");
    }
    for far in [0.0, 1.0, 1e6] {
        assert!(free_pair([1.0, -1.0], [far + 0.5, far - 0.5]).passed(), "{far:e}");
    }
}

/// The load and the force of the obstacle cancel to `1e-12` of themselves: what is left moves the spring.
#[test]
fn the_energies_of_forces_that_all_but_cancel_are_known_to_their_rounding() {
    let moved = |by: f64, work_of_loads: Option<f64>| {
        let u = 1e-12 + by;
        let (k, held) = (spring(4.0), Matrix { rows: 1, ..Matrix::default() });
        judged((&k, &held, &[2.0]), &obstacle(1e-12, 0.0), (&[u], &[2.0 - 4.0 * u]), work_of_loads)
    };
    assert!(moved(-1e-15, None).passed(), "rounding of the load moves the spring as far");
    assert!(moved(-1e-12, None).only_motions_fail(), "a force across an open gap");
    assert!(moved(-1e-12, None).complementarity.figure > 1e-8);
    assert!(
        moved(-1e-12, Some(1e3)).passed(),
        "in a body so soft that loads do such work rounding moves it as far"
    );
}

#[test]
fn the_exact_answer_passes_in_any_unit_and_each_fault_is_named() {
    for unit in [1.0, 1e-20, 2.1e11] {
        assert!(with(0.25, 1.0, unit).passed());
        let unbalanced = with(0.25, 0.9, unit);
        assert!(unbalanced.equilibrium.ratio > 1.0 && unbalanced.equilibrium.place == Some(0));
        assert!((unbalanced.equilibrium.figure - 0.1 / 3.9).abs() < NOISY);
        let through = with(0.5, 0.0, unit);
        assert!(through.equilibrium.ratio <= 1.0 && through.penetration.ratio > 1.0);
        // s = 2 (K = 4): |S(Bu - c)| = .5 against |S B u| + |S c| + |u|_D = 1 + .5 + 1
        assert!((through.penetration.figure - 0.5 / 2.5).abs() < NOISY);
        assert!(with(0.0, 2.0, unit).complementarity.ratio > 1.0);
        assert!(with(0.75, -1.0, unit).negative_force.ratio > 1.0);
        assert!(!with(f64::NAN, 1.0, unit).passed());
    }
}

/// A spring of stiffness 4 in the row: 4 u = 2 - lambda, u - .25 = lambda / 4, so that lambda = .5, u = .375.
#[test]
fn the_answer_on_a_compliant_row_passes_in_any_unit_and_each_fault_is_named() {
    for unit in [1.0, 1e-20, 2.1e11] {
        let with = |u, lambda| on_a_spring(u, lambda, unit, 4.0);
        let exact = with(0.375, 0.5);
        assert!(exact.passed(), "{exact:?}");
        assert!(exact.entries().iter().all(|entry| entry.figure <= 1e-15), "{exact:?}");
        let rigid = with(0.25, 1.0);
        assert!(rigid.equilibrium.ratio <= 1.0 && rigid.penetration.ratio <= 1.0);
        // lambda |c + C lambda - u| = 1 x .25; |f'u| + |c lambda| + lambda C lambda = .5 + .25 + .25
        assert!((rigid.complementarity.figure - 0.25).abs() < NOISY && rigid.complementarity.ratio > 1.0);
        // u K u - f u + c lambda + lambda C lambda = .25 - .5 + .25 + .25, of .25 more than above
        assert!((rigid.duality_gap.figure - 0.25 / 1.25).abs() < NOISY && rigid.duality_gap.ratio > 1.0);
        // s = (1/4 + 1/4)^-1/2: s (u - c - C lambda) = s (.5 - .25 - 0), of s u + s c + 2 u
        let s = 2f64.sqrt();
        let through = with(0.5, 0.0).penetration;
        assert!((through.figure - 0.25 * s / (0.75 * s + 1.0)).abs() < NOISY && through.ratio > 1.0);
    }
}

/// A spring 1e-300 pushed by 2 against a wall at 1: squares of the displacement that it alone would have overflow.
#[test]
fn an_answer_whose_sizes_overflow_does_not_pass() {
    let held = Matrix { rows: 1, ..Matrix::default() };
    let beyond = judged((&spring(1e-300), &held, &[2.0]), &obstacle(1.0, 0.0), (&[2e300], &[0.0]), None);
    assert!(!beyond.passed(), "{beyond:?}");
}

/// A spring 1 pushed by 2 against a wall at 1, all `size` times as large: what is judged is the same, or not known.
#[test]
fn no_answer_is_so_small_or_large_that_a_wrong_one_passes() {
    let held = Matrix { rows: 1, ..Matrix::default() };
    for size in [1e-310, 1e-200, 1e-160, 1e-100, 1.0, 1e100, 1e160, 1e200] {
        let judged = |u: f64, l: f64| {
            judged(
                (&spring(1.0), &held, &[2.0 * size]),
                &obstacle(size, 0.0),
                (&[u * size], &[l * size]),
                None,
            )
        };
        let right = judged(1.0, 1.0);
        assert!(right.passed() == (1e-150..1e150).contains(&size), "{size:e} {right:?}");
        assert!(right.equilibrium.ratio <= 1.0 && right.penetration.ratio <= 1.0);
        for (u, l) in [(2.0, 0.0), (1.0, 0.9), (0.5, 1.5), (3.0, -1.0)] {
            assert!(!judged(u, l).passed(), "{size:e} {u} {l}");
        }
    }
}

/// A spring 1e200 pushed by 2 beyond a wall that its row sees through 1e-100: the row has no scale in the host's units.
#[test]
fn a_row_whose_scale_is_lost_does_not_pass() {
    let held = Matrix { rows: 1, ..Matrix::default() };
    let mut wall = obstacle(1e-300, 0.0);
    let mut matrix = Csr::empty(1);
    matrix.push_row([(0, 1e-100)]);
    wall.matrix = matrix.into();
    let through = judged((&spring(1e200), &held, &[2.0]), &wall, (&[2e-200], &[0.0]), None);
    assert!(!through.passed(), "{through:?}");
}
