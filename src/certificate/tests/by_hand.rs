//! Solved by hand: single springs, units, overflow and underflow, unknown values.

use super::model::{chain, DenseAnswer, DenseModel, LIMIT};

/// Spring 4 at a wall, loaded by 2 towards an obstacle at 0.25: u = .25, lambda = 1. `c`: compliance of the row.
fn spring(unit: f64, c: f64) -> DenseModel {
    let parts = vec![chain(&[], &[(0, 4.0 * unit)]).loaded(&[(0, 2.0 * unit)])];
    DenseModel {
        parts,
        contact: vec![(vec![(0, 1.0)], 0.25, c / unit)],
        active: vec![0],
        ..DenseModel::default()
    }
}

fn point(u: f64, lambda: f64) -> DenseAnswer {
    DenseAnswer { u: vec![u], lambda: vec![lambda], mu: vec![], tangential: vec![] }
}

#[test]
fn the_exact_answer_passes_in_any_unit_and_each_fault_is_named() {
    for unit in [1.0, 1e-20, 2.1e11] {
        let with = |u, lambda: f64| spring(unit, 0.0).certificate(&point(u, lambda * unit));
        assert!(with(0.25, 1.0).passed());
        let unbalanced = with(0.25, 0.9);
        assert!(unbalanced.equilibrium.ratio > 1.0 && unbalanced.equilibrium.place == Some(0));
        // |res| = .1 relative to |r| + |K u| = .9 + 1; the spring has no neighbours
        assert!((unbalanced.equilibrium.figure - 0.1 / 1.9).abs() < 1e-12, "{unbalanced:?}");
        let through = with(0.5, 0.0);
        assert!(through.equilibrium.ratio <= 1.0 && through.penetration.ratio > 1.0);
        assert_eq!(through.penetration.place, Some(0));
        assert!(with(0.0, 2.0).complementarity.ratio > 1.0);
        assert!(with(0.75, -1.0).negative_force.ratio > 1.0);
        // s = 2, |f| + |r| = (2 + 1) / 2: -lambda = 1 relative to s (|f| + |r|) = 3
        assert!((with(0.75, -1.0).negative_force.figure - 1.0 / 3.0).abs() < 1e-12);
        assert!(!with(f64::NAN, 1.0).passed() && !with(0.25, f64::NAN).passed());
    }
}

/// Spring 4 loaded by 2 and tied to .25: mu = 1. Without this force u = .5, and all conditions except the tie hold.
#[test]
fn a_tie_that_is_left_open_is_seen_by_its_own_entry_alone() {
    for unit in [1.0, 1e-20, 2.1e11] {
        let parts = vec![chain(&[], &[(0, 4.0 * unit)]).loaded(&[(0, 2.0 * unit)])];
        let model =
            DenseModel { parts, equalities: vec![(vec![(0, 1.0)], 0.25, 0.0)], ..DenseModel::default() };
        let with = |u, mu: f64| {
            model.certificate(&DenseAnswer {
                u: vec![u],
                lambda: Vec::new(),
                mu: vec![mu * unit],
                tangential: vec![],
            })
        };
        assert!(with(0.25, 1.0).passed());
        let open = with(0.5, 0.0);
        assert!(!open.passed() && open.equality.ratio > 1.0 && open.equality.place == Some(0), "{open:?}");
        let others = open.entries().into_iter().filter(|entry| entry.ratio > 1.0);
        assert_eq!(others.count(), 1, "{open:?}");
    }
}

/// Springs 4 and 4 in a line, D = (8, 4), the end pushed by 2 and held back by 1: `|f| + |r| = (2 + 1) / 2`, `|delta|_D^2 = 8/16 + 4/4`.
#[test]
fn leverage_is_how_many_times_forces_exceed_what_they_deform() {
    for unit in [1.0, 1e-20, 2.1e11] {
        let parts = vec![chain(&[4.0 * unit], &[(0, 4.0 * unit)]).loaded(&[(1, 2.0 * unit)])];
        let model = DenseModel { parts, contact: vec![(vec![(1, 1.0)], 0.5, 0.0)], ..DenseModel::default() };
        let leverage = |u: [f64; 2]| {
            let point = DenseAnswer { u: u.to_vec(), lambda: vec![unit], mu: vec![], tangential: vec![] };
            model.judged(&point).leverage
        };
        assert!((leverage([0.25, 0.5]) - 1.5f64.sqrt()).abs() < 1e-12);
        assert_eq!(leverage([0.0, 0.0]), f64::INFINITY);
    }
}

/// Two such bodies, ends tied by the force lambda = .001, the second deformed 1000 times as much: s = 2^1/2,
/// `|b| delta + lambda / s^2` = .0005 + .5 + .0005, `|delta|_D` = .001 1.5^1/2 of the first.
#[test]
fn unevenness_is_how_many_times_a_row_is_deformed_more_than_a_body_that_it_touches() {
    for unit in [1.0, 1e-20, 2.1e11] {
        let body = || chain(&[4.0 * unit], &[(0, 4.0 * unit)]);
        let equalities = vec![(vec![(1, 1.0), (3, -1.0)], -0.4995, 0.0)];
        let model = DenseModel { parts: vec![body(), body()], equalities, ..DenseModel::default() };
        let unevenness = |mu: f64| {
            let u = vec![0.00025, 0.0005, 0.25, 0.5];
            model
                .judged(&DenseAnswer { u, lambda: vec![], mu: vec![mu * unit], tangential: vec![] })
                .unevenness
        };
        let expected = 2f64.sqrt() * 0.501 / (0.001 * 1.5f64.sqrt());
        assert!((unevenness(0.001) / expected - 1.0).abs() < 1e-12, "{} {expected}", unevenness(0.001));
        assert_eq!(unevenness(0.0), 0.0);
    }
}

/// The single unknown of the spring is grounded and has no deformation.
#[test]
fn a_spring_of_one_unknown_makes_no_row_uneven() {
    let parts = vec![chain(&[], &[(0, 4.0)]), chain(&[4.0], &[(0, 4.0)])];
    let model =
        DenseModel { parts, contact: vec![(vec![(0, 1.0), (2, -1.0)], 0.0, 0.0)], ..DenseModel::default() };
    let unevenness = |u: [f64; 3]| {
        model
            .judged(&DenseAnswer { u: u.to_vec(), lambda: vec![1.0], mu: vec![], tangential: vec![] })
            .unevenness
    };
    let found = unevenness([-0.25, 0.25, 0.5]);
    assert!(found > 0.0 && found < 2.0, "{found}");
}

/// A spring of stiffness 4 in the row: 4 u = 2 - lambda, u - .25 = lambda / 4, so that lambda = .5, u = .375.
#[test]
fn the_answer_on_a_compliant_row_passes_in_any_unit_and_each_fault_is_named() {
    for unit in [1.0, 1e-20, 2.1e11] {
        let with = |u, lambda: f64| spring(unit, 0.25).certificate(&point(u, lambda * unit));
        let exact = with(0.375, 0.5);
        assert!(exact.entries().iter().all(|entry| entry.figure <= 1e-15), "{exact:?}");
        let rigid = with(0.25, 1.0);
        assert!(rigid.equilibrium.ratio <= 1.0 && rigid.penetration.ratio <= 1.0);
        // lambda = 1 relative to Lambda = sqrt 2 (2 + 1) / 2; g = .25 relative to L = |r| / K + lambda (1/4 + 1/4) +
        // Lambda / 4 = .25 + .5 + ..
        let force = 1.5 * 2f64.sqrt();
        let share = (0.25 / (0.75 + force / 4.0)).min(1.0 / force);
        assert!((rigid.complementarity.figure - share).abs() < 1e-5 && rigid.complementarity.ratio > 1.0);
        // u K u - f u + c lambda + lambda C lambda = .25 - .5 + .25 + .25, relative to .25 + .5 + .25 + .25
        assert!((rigid.duality_gap.figure - 0.25 / 1.25).abs() < 1e-5 && rigid.duality_gap.ratio > 1.0);
        assert!(with(0.5, 0.0).penetration.ratio > 1.0);
    }
}

#[test]
fn no_distance_excuses_forces_that_do_not_balance() {
    for far in [0.0, 1.0, 1e10, 1e20] {
        let model = DenseModel {
            parts: vec![chain(&[1.0], &[]).loaded(&[(0, 0.5), (1, 0.5)])],
            ..DenseModel::default()
        };
        let certificate = model.certificate(&DenseAnswer {
            u: vec![far; 2],
            lambda: vec![],
            mu: vec![],
            tangential: vec![],
        });
        assert!(!certificate.passed() && certificate.balance.ratio > 1.0, "{far:e}");
    }
}

#[test]
fn no_distance_excuses_a_strain_that_is_missing() {
    let model = DenseModel {
        parts: vec![chain(&[1.0], &[]).loaded(&[(0, 1.0), (1, -1.0)])],
        ..DenseModel::default()
    };
    let with = |u: [f64; 2]| {
        model.certificate(&DenseAnswer { u: u.to_vec(), lambda: vec![], mu: vec![], tangential: vec![] })
    };
    for far in [0.0, 1.0, 1e10, 1e13, 1e16, 1e20] {
        assert!(with([far; 2]).equilibrium.ratio > 1.0, "{far:e}");
    }
    for far in [0.0, 1.0, 1e6, 1e10] {
        assert!(with([far + 0.5, far - 0.5]).passed(), "{far:e}");
    }
}

/// The load and the force of the obstacle cancel to `1e-12` of their size: the difference moves the spring.
#[test]
fn the_energies_of_forces_that_all_but_cancel_are_known_to_their_rounding() {
    let mut model = spring(1.0, 0.0);
    model.contact[0].1 = 1e-12;
    let moved = |by: f64| {
        let u = 1e-12 + by;
        model.certificate(&point(u, 2.0 - 4.0 * u))
    };
    assert!(moved(-1e-15).passed(), "rounding of the load moves the spring as far");
    assert!(moved(-1e-12).duality_gap.ratio > 1.0, "a force across an open gap");
}

/// A spring 1e-300 pushed by 2 against a wall at 1: squares of its free displacement overflow.
#[test]
fn an_answer_whose_sizes_overflow_does_not_pass() {
    let parts = vec![chain(&[], &[(0, 1e-300)]).loaded(&[(0, 2.0)])];
    let model = DenseModel { parts, contact: vec![(vec![(0, 1.0)], 1.0, 0.0)], ..DenseModel::default() };
    let beyond = model.certificate(&point(2e300, 0.0));
    assert!(!beyond.passed(), "{beyond:?}");
}

/// A spring 1 pushed by 2 against a wall at 1, all values times `size`: the judgement does not change, or is not known.
#[test]
fn no_answer_is_so_small_or_large_that_a_wrong_one_passes() {
    for size in [1e-310, 1e-200, 1e-160, 1e-100, 1.0, 1e100, 1e160, 1e200] {
        let parts = vec![chain(&[], &[(0, 1.0)]).loaded(&[(0, 2.0 * size)])];
        let model = DenseModel { parts, contact: vec![(vec![(0, 1.0)], size, 0.0)], ..DenseModel::default() };
        let judged = |u: f64, l: f64| model.certificate(&point(u * size, l * size));
        let right = judged(1.0, 1.0);
        assert!(right.passed() == (1e-150..1e150).contains(&size), "{size:e} {right:?}");
        assert!(right.equilibrium.ratio <= 1.0 && right.penetration.ratio <= 1.0);
        for (u, l) in [(2.0, 0.0), (1.0, 0.9), (0.5, 1.5), (3.0, -1.0)] {
            assert!(!judged(u, l).passed(), "{size:e} {u} {l}");
        }
    }
}

/// The square of the row's entry underflows: its scale is not known.
#[test]
fn a_row_whose_scale_is_lost_does_not_pass() {
    let parts = vec![chain(&[], &[(0, 1.0)]).loaded(&[(0, 2.0)])];
    let model =
        DenseModel { parts, contact: vec![(vec![(0, 1e-200)], 1e-200, 0.0)], ..DenseModel::default() };
    assert!(!model.certificate(&point(2.0, 0.0)).passed());
}

/// Two chains, the first pushed against the second: K in 2^a, forces in 2^b, lengths in 2^(b - a).
#[test]
fn units_that_differ_by_powers_of_two_change_no_bit() {
    let model = |k: f64, f: f64| {
        let springs = |s: &[f64]| s.iter().map(|s| s * k).collect::<Vec<_>>();
        let parts = vec![
            chain(&springs(&[2.0, 3.1, 1.7]), &[]).loaded(&[(0, 0.7 * f), (2, 0.3 * f)]),
            chain(&springs(&[1.9, 2.3]), &[(2, 3.7 * k)]),
            chain(&springs(&[0.3]), &[(0, 0.9 * k)]),
        ];
        let contact = vec![(vec![(3, 1.0), (4, -1.0)], 0.1 * f / k, 0.1 / k)];
        let equalities = vec![(vec![(6, 1.0), (7, -1.0)], 0.02 * f / k, 0.0)];
        DenseModel { parts, contact, equalities, active: vec![0], ..DenseModel::default() }
    };
    let answer = model(1.0, 1.0).answer();
    for error in [1.0, 1.0 + 1e-9, 1.001] {
        let judged = |a: i32, b: i32| {
            let (k, f) = (2f64.powi(a), 2f64.powi(b));
            let scaled = |v: &[f64], by: f64| v.iter().map(|v| v * by).collect::<Vec<_>>();
            let point = DenseAnswer {
                u: scaled(&answer.u, f / k),
                lambda: scaled(&answer.lambda, f * error),
                mu: scaled(&answer.mu, f),
                tangential: vec![],
            };
            let judgement = model(k, f).judged(&point);
            (judgement.certificate.entries(), judgement.bodies)
        };
        for (a, b) in [(1, 0), (0, 1), (-31, 17), (100, -100)] {
            assert_eq!(judged(0, 0), judged(a, b), "{a} {b}");
        }
    }
}

#[test]
fn the_error_of_the_forces_on_a_body_is_estimated() {
    let (model, error) = (spring(1.0, 0.0), 1e-6);
    // the force has an error of 1e-6; the spring is in equilibrium with this force
    let lambda = 1.0 + error;
    let judged = model.judged(&point((2.0 - lambda) / 4.0, lambda));
    let estimated = judged.bodies[0].force_error;
    assert!((0.5..2.0).contains(&(estimated / error)), "{estimated:e}");
    assert_eq!(model.judged(&point(0.25, 1.0)).bodies[0].force_error, 0.0);
    // s = 2, (|f| + |r|) = (2 + 1) / 2; L = |r| / K + lambda / s^2 = .5
    let zero = model.judged(&point(0.25, 1.0)).contact[0];
    assert!(
        (zero.force / (3.0 * LIMIT) - 1.0).abs() < 1e-12 && (zero.gap / (0.5 * LIMIT) - 1.0).abs() < 1e-5
    );
}

/// Two springs in a row, from the ground on, loaded at an unknown that a row holds: nothing deforms, and u is rounding.
#[test]
fn what_rounding_leaves_of_a_displacement_that_no_force_causes_is_nothing() {
    let model = DenseModel {
        parts: vec![chain(&[1.0], &[(0, 1.0)]).loaded(&[(0, 2.0)])],
        equalities: vec![(vec![(0, 1.0)], 0.0, 0.0), (vec![(1, 1.0)], 0.0, 0.0)],
        ..DenseModel::default()
    };
    let passes = |u: [f64; 2]| {
        let answer = DenseAnswer { u: u.to_vec(), lambda: vec![], mu: vec![2.0, 0.0], tangential: vec![] };
        model.certificate(&answer).passed()
    };
    assert!(passes([0.0; 2]) && passes([1e-17, -3e-17]));
    assert!(!passes([0.0, 1e-12]) && !passes([1e-12, 0.0]));
}

/// A loaded spring at its obstacle, and a roller of two unknowns between it and a wall that just touches both: forces there that
/// other solvers leave, and loads that Newton's method leaves, are none; larger ones have to balance.
#[test]
fn what_rounding_leaves_on_a_part_without_load_is_nothing() {
    let judged = |load: f64, forces: [f64; 2]| {
        let spring = chain(&[], &[(0, 4.0)]).loaded(&[(0, 2.0)]);
        let roller = chain(&[1.0], &[]).loaded(&[(0, load)]);
        let rows = [vec![(0, 1.0)], vec![(0, 1.0), (1, -1.0)], vec![(2, 1.0)]];
        let contact = rows.into_iter().zip([0.25, 0.25, 0.0]).map(|(row, gap)| (row, gap, 0.0)).collect();
        let model = DenseModel {
            parts: vec![spring, roller],
            contact,
            active: vec![0, 1, 2],
            ..DenseModel::default()
        };
        let lambda = vec![1.0, forces[0], forces[1]];
        model.certificate(&DenseAnswer { u: vec![0.25, 0.0, 0.0], lambda, mu: vec![], tangential: vec![] })
    };
    for (load, forces) in [(0.0, [0.0; 2]), (0.0, [1e-13, 3e-13]), (1e-17, [0.0; 2]), (1e-17, [2e-13, 1e-13])]
    {
        let passed = judged(load, forces);
        assert!(passed.passed(), "{load:e} {forces:?}: {passed:?}");
    }
    for (load, forces) in [(0.0, [1e-9, 3e-9]), (1e-9, [0.0; 2])] {
        assert!(!judged(load, forces).passed(), "{load:e} {forces:?}");
    }
}

/// Two masses without any stiffness, pushed against walls at 1 and 3: no force gives a length, whatever its unit.
#[test]
fn gaps_of_what_has_no_stiffness_are_judged_by_its_way() {
    for (force, length) in [(1e25, 1e6), (1.0, 1.0), (1e-20, 1e-3), (1e20, 1e-20)] {
        let parts = vec![chain(&[], &[]).loaded(&[(0, force)]), chain(&[], &[]).loaded(&[(0, 2.0 * force)])];
        let contact = vec![(vec![(0, 1.0)], length, 0.0), (vec![(1, 0.5)], 1.5 * length, 0.0)];
        let model = DenseModel { parts, contact, ..DenseModel::default() };
        let judged = |u: [f64; 2]| {
            let u = u.map(|u| u * length).to_vec();
            model.certificate(&DenseAnswer {
                u,
                lambda: vec![force, 4.0 * force],
                mu: vec![],
                tangential: vec![],
            })
        };
        assert!(judged([1.0, 3.0]).passed() && judged([1.0 + 1e-10, 3.0 - 1e-10]).passed(), "{force:e}");
        for u in [[1.0, 3.0 + 1e-6], [1.0 + 1e-6, 3.0], [1.0, 3.0 - 1e-6], [0.0, 0.0], [1.0, 0.0]] {
            assert!(!judged(u).passed(), "{force:e} {u:?}");
        }
    }
}
