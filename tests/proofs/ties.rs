//! u0 = a, u0 - u1 = b, u1 = a - b, u1 - x u2 = h: the third row says what the first two say, but for the rounding of a - b.

use feti_contact::error::Kind;
use feti_contact::solver::{Outcome, RowKind};

use crate::proofs::{body, deck, springs};
use crate::support::hand_over;

const A: f64 = 0.229;
const B: f64 = 0.0264;
const H: f64 = 11.4;
const LOAD: f64 = 1.35;

/// Springs of `stiffness` to the ground, the first unknown loaded; values of x that are refused or not solved. The reaction of
/// the stiffest unknown goes through rows on the softest: u is that of the certificate, 1e-8 of it.
fn refused(stiffness: [f64; 3], count: usize) -> Vec<String> {
    let mut refused = Vec::new();
    for k in 0..count {
        let x = 0.5 + (k as f64) * 1e-3 * 1.000_123_7;
        let grounded = body(
            springs(3, &[], &[(0, stiffness[0]), (1, stiffness[1]), (2, stiffness[2])]),
            vec![],
            vec![LOAD, 0.0, 0.0],
        );
        let ties: [(&[(usize, f64)], f64); 4] =
            [(&[(0, 1.0)], A), (&[(0, 1.0), (1, -1.0)], B), (&[(1, 1.0)], A - B), (&[(1, 1.0), (2, -x)], H)];
        let deck = deck(vec![grounded], &[], &ties);
        let mut problem = hand_over::problem(&deck).unwrap();
        match problem.solve() {
            Ok(report) if report.outcome == Outcome::Solved => {
                let u = problem.displacements().unwrap();
                for (found, wanted) in u.iter().zip([A, A - B, (A - B - H) / x]) {
                    assert!((found - wanted).abs() <= 1e-5 * wanted.abs(), "{found:e} {wanted:e}");
                }
                assert_eq!(problem.multipliers(RowKind::Equality).unwrap().len(), 4);
            }
            Ok(report) => refused.push(format!("{x}: {:?}", report.outcome)),
            Err(error) => refused.push(format!("{x}: {error}")),
        }
    }
    refused
}

#[test]
fn a_tie_that_follows_from_two_others_contradicts_nothing() {
    let refused = refused([1.0; 3], 2000);
    assert!(refused.is_empty(), "{} of 2000: {}", refused.len(), refused[0]);
}

#[test]
fn nor_does_it_where_stiffnesses_are_1e6_apart() {
    for stiffness in [[1.0, 1e6, 1.0], [1e6, 1.0, 1e-6], [1e-6, 1.0, 1e6]] {
        let refused = refused(stiffness, 500);
        assert!(refused.is_empty(), "{stiffness:?} {} of 500: {}", refused.len(), refused[0]);
    }
}

/// u0 = 1, u0 + x u1 = 0: only u1 = -1/x satisfies both.
#[test]
fn ties_that_only_a_displacement_a_million_times_as_large_satisfies_contradict_each_other() {
    for (x, solved) in [(1.0, true), (1e-4, true), (1e-5, true), (1e-7, false), (1e-10, false), (0.0, false)]
    {
        let grounded = body(springs(2, &[(0, 1, 1.0)], &[(0, 1.0), (1, 1.0)]), vec![], vec![0.0, 0.0]);
        let deck = deck(vec![grounded], &[], &[(&[(0, 1.0)], 1.0), (&[(0, 1.0), (1, x)], 0.0)]);
        let mut problem = hand_over::problem(&deck).unwrap();
        match problem.solve() {
            Ok(report) => {
                assert!(solved && report.outcome == Outcome::Solved, "{x:e}: {:?}", report.outcome);
                let u = problem.displacements().unwrap();
                // the first tie is known to 1e-8 of what its body is deformed by
                assert!((u[1] * x + 1.0).abs() <= 1e-8 / x, "{u:?}");
            }
            Err(error) => {
                assert!(!solved && error.kind == Kind::GapsContradict, "{x:e}, solvable: {solved}: {error}");
            }
        }
    }
}

/// A soft strip of more unknowns than a node, whose end is moved by 1, moves a spring 1e14 times as stiff: what counts as motion
/// that rows demand is that of the spring.
#[test]
fn a_motion_that_soft_unknowns_pass_on_to_stiff_ones_contradicts_nothing() {
    for soft in [1e-2, 1e-6, 1e-8] {
        let n = 7;
        let between: Vec<_> = (1..n).map(|i| (i - 1, i, soft)).collect();
        let strip = body(springs(n, &between, &[(0, soft), (n - 1, soft)]), vec![], vec![0.0; n]);
        let spring = body(springs(1, &[], &[(0, 1e6)]), vec![], vec![0.0]);
        let deck = deck(vec![spring, strip], &[], &[(&[(1, 1.0)], 1.0), (&[(1, 1.0), (0, -1.0)], 0.0)]);
        let mut problem = hand_over::problem(&deck).unwrap();
        problem.solve().unwrap_or_else(|error| panic!("{soft:e}: {error}"));
    }
}

/// p = 1 and x = p with p in a strip whose K the rounding of the forces moves by more than 1, f = k_x: at p = x = 0 they balance the
/// load and cancel at p, but both ties hold p, so that its gap is none of rounding.
#[test]
fn forces_that_cancel_on_a_soft_unknown_are_no_excuse_for_its_gap() {
    for soft in [1e-10, 1e-12] {
        let (n, load) = (7, 1e14 * soft);
        let between: Vec<_> = (1..n).map(|i| (i - 1, i, soft)).collect();
        let strip = body(springs(n, &between, &[(0, soft), (n - 1, soft)]), vec![], vec![0.0; n]);
        let spring = body(springs(1, &[], &[(0, load)]), vec![], vec![load]);
        let deck = deck(vec![spring, strip], &[], &[(&[(1, 1.0)], 1.0), (&[(1, 1.0), (0, -1.0)], 0.0)]);
        let mut problem = hand_over::problem(&deck).unwrap();
        let verdict = problem.check(&[0.0; 8], &[], &[load, -load]).unwrap();
        assert!(!verdict.passed(), "{soft:e}: {verdict:?}");
    }
}

/// Without any length rounding and a true contradiction look alike.
#[test]
fn a_row_without_entries_in_a_problem_without_length_is_refused_with_what_would_decide() {
    for (load, rhs, refused) in
        [(0.0, -1e-17, Some(true)), (0.0, -0.5, Some(true)), (1.0, -0.5, Some(false)), (1.0, -1e-17, None)]
    {
        let chain = body(springs(2, &[(0, 1, 1.0)], &[(0, 1.0)]), vec![], vec![load, 0.0]);
        let all = deck(vec![chain], &[(&[], rhs), (&[(1, 1.0)], 0.0)], &[]);
        let mut problem = hand_over::problem(&all).unwrap();
        let undecided = problem.solve().err().map(|error| {
            assert_eq!((error.kind, error.place.row), (Kind::GapsContradict, Some(0)));
            error.to_string().contains("give coordinates")
        });
        assert_eq!(undecided, refused, "{load} {rhs:e}");
        if refused == Some(true) {
            problem.set_coordinates(0, 1, &[0, 1], &[1, 1], &[0.0, 2.0], 1).unwrap();
            assert_eq!(problem.solve().is_ok(), rhs == -1e-17, "{rhs:e}");
        }
    }
}
