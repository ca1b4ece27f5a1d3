//! Friction by hand: one node with a spring on each of its unknowns.

use super::model::{chain, DenseAnswer, DenseModel, LIMIT};
use super::nodes::DenseNode;
use crate::certificate::{Certificate, Entry, FrictionState};

/// Springs 4 in every direction, loaded by these forces in units of `unit`; one node with a bound 1, its rows times
/// `factor`.
fn springs(unit: f64, loads: &[f64], factor: f64) -> DenseModel {
    let spring = |load: &f64| chain(&[], &[(0, 4.0 * unit)]).loaded(&[(0, load * unit)]);
    let rows = (0..loads.len()).map(|j| vec![(j, factor)]).collect();
    let node = DenseNode { rows, old: vec![0.0; loads.len()], bound: unit / factor, ..DenseNode::default() };
    DenseModel { parts: loads.iter().map(spring).collect(), nodes: vec![node], ..DenseModel::default() }
}

fn point(u: &[f64], tangential: &[f64]) -> DenseAnswer {
    DenseAnswer { u: u.to_vec(), lambda: vec![], mu: vec![], tangential: tangential.to_vec() }
}

pub fn entries(certificate: &Certificate) -> [Entry; 3] {
    [certificate.friction_cone, certificate.friction_work, certificate.friction_stick]
}

fn near(figure: f64, expected: f64) -> bool {
    (figure - expected).abs() <= 1e-5 * expected
}

/// A spring loaded by 3 slips: lambda_t = 1, u = s = .5. `|f| + |r|` = (3 + 1) / 2, Lambda = 2 x 2, L = |r| / 4 + lambda_t / 4 = .5.
#[test]
fn a_slip_in_the_plane_passes_in_any_unit_and_each_fault_is_named() {
    for (unit, factor) in [(1.0, 1.0), (1e-20, 1.0), (2.1e11, 1.0), (1.0, 0.25), (1.0, 1e5)] {
        let model = springs(unit, &[3.0], factor);
        let with = |u: f64, force: f64| model.judged(&point(&[u], &[force * unit / factor]));
        let right = with(0.5, 1.0);
        assert!(right.certificate.worst() <= 0.1, "{:?}", right.certificate);
        assert_eq!(right.nodes, [FrictionState::Slip]);
        // outside by .1 relative to Lambda = 2 (3 + 1.1) / 2
        let outside = with(0.475, 1.1).certificate;
        assert!(near(outside.friction_cone.figure, 0.1 / 4.1), "{outside:?}");
        assert_eq!(outside.friction_cone.place, Some(0));
        // half the force: .5 relative to Lambda = 2 (3 + .5) / 2; s = .625, (b - |lambda_t|) / b = 1/2, L = .25
        let halved = with(0.625, 0.5).certificate;
        assert!(near(halved.friction_work.figure, 0.5 / 3.5), "{halved:?}");
        assert!(near(halved.friction_stick.figure, 0.625 * 0.5 / 0.25), "{halved:?}");
        assert_eq!(halved.friction_cone.ratio, 0.0);
        // force against the slip: error 2 relative to Lambda = 2 (3 + 1) / 2
        let against = with(1.0, -1.0).certificate;
        assert!(near(against.friction_work.figure, 2.0 / 4.0), "{against:?}");
        assert_eq!((against.friction_cone.ratio, against.friction_stick.ratio), (0.0, 0.0));
        // u'K u - f u + b |s| = 4 - 3 + 1 with s = 1, relative to 4 + 3 + 1
        assert!(near(against.duality_gap.figure, 2.0 / 8.0), "{against:?}");
        assert!(!with(f64::NAN, 1.0).certificate.passed() && !with(0.5, f64::NAN).certificate.passed());
    }
}

/// Loaded by (3, 4), a force of 5: lambda_t = (.6, .8), s = (.6, .8). The force is rotated by t, s moves by -t/4.
#[test]
fn a_force_turned_in_space_is_seen_by_the_angle_itself() {
    for angle in [1e-3f64, 1e-4] {
        let model = springs(1.0, &[3.0, 4.0], 1.0);
        let turned = |t: f64| {
            let (cos, sin) = (t.cos(), t.sin());
            let force = [0.6 * cos - 0.8 * sin, 0.8 * cos + 0.6 * sin];
            model.certificate(&point(&[(3.0 - force[0]) / 4.0, (4.0 - force[1]) / 4.0], &force))
        };
        assert!(turned(0.0).worst() <= 0.1, "{:?}", turned(0.0));
        // Lambda = 2 x the smaller of (3 + .6) / 2 and (4 + .8) / 2, the largest of its rows
        let wrong = turned(angle);
        // L = (.8 + .8) / 4, so k s = 4.8 / .4 is added to lambda_t: 12 parts of 13 are along s
        let turned = 1.25 * angle * 12.0 / 13.0;
        assert!((wrong.friction_work.figure / (turned / 4.8) - 1.0).abs() < 2e-3, "{wrong:?}");
        assert!(wrong.friction_cone.ratio <= 1.0 && wrong.friction_stick.ratio <= 1.0, "{wrong:?}");
    }
}

/// Loaded by .75 the node sticks: u = 0, lambda_t = .75. L = |u| + .75 / 4 by its force.
#[test]
fn a_stick_passes_and_a_slip_of_it_is_measured_as_a_length() {
    let model = springs(1.0, &[0.75], 1.0);
    let right = model.judged(&point(&[0.0], &[0.75]));
    assert!(right.certificate.worst() <= 0.1 && right.nodes == [FrictionState::Stick]);
    for slip in [1e-5, 1e-8] {
        let limit = (slip + 0.75 / 4.0) * LIMIT;
        let slips = model.certificate(&point(&[slip], &[0.75]));
        let ratio = (slip / limit).min(0.25 / (1.5 * LIMIT));
        assert!((slips.friction_work.ratio / ratio - 1.0).abs() < 1e-3, "{slips:?} {ratio}");
        assert!((slips.friction_stick.ratio / (slip / limit * 0.25) - 1.0).abs() < 1e-3, "{slips:?}");
    }
    // the load equals the bound: the node sticks with the largest possible force
    let weak = springs(1.0, &[1.0], 1.0).judged(&point(&[0.0], &[1.0]));
    assert!(weak.certificate.worst() <= 0.1 && weak.nodes == [FrictionState::Weak]);
}

/// Loaded by .75 with elastic stick, a spring 1/C_t = 4, and an earlier slip .125: 4 u = .75 - lambda_t, u - .125 =
/// lambda_t / 4, so lambda_t = 1/8, u = 5/32.
#[test]
fn elastic_stick_and_earlier_slips_belong_to_the_slip() {
    for (unit, factor) in [(1.0, 1.0), (1e-20, 1.0), (1.0, 1e5)] {
        let mut model = springs(unit, &[0.75], factor);
        model.nodes[0].old = vec![0.125 * factor];
        model.nodes[0].compliance = 0.25 * factor * factor / unit;
        let right = point(&[5.0 / 32.0], &[0.125 * unit / factor]);
        let judged = model.judged(&right);
        assert!(judged.certificate.worst() <= 0.1, "{:?}", judged.certificate);
        assert_eq!(judged.nodes, [FrictionState::Stick]);
        // 1/2 u'K u - f u + 1/2 lambda_t'C_t lambda_t
        let energy = unit * (2.0 * 25.0 / 1024.0 - 0.75 * 5.0 / 32.0 + 1.0 / 512.0);
        assert!((judged.certificate.energy / energy - 1.0).abs() < 1e-12);
        for (old, compliance) in [(0.0, 1.0), (1.0, 0.0), (1.0 + 1e-6, 1.0), (1.0, 1.0 + 1e-6)] {
            let mut wrong = model.clone();
            wrong.nodes[0].old[0] *= old;
            wrong.nodes[0].compliance *= compliance;
            let seen = wrong.certificate(&right);
            assert!(seen.friction_work.ratio > 1.0 && seen.friction_stick.ratio > 1.0, "{seen:?}");
        }
    }
}

/// A contact row of another body, with a pressure of 2 or a pull; mu = .5 and no bound.
#[test]
fn the_normal_force_bounds_the_tangential_one_and_a_pull_does_not() {
    let mut model = springs(1.0, &[3.0, 2.0], 1.0);
    model.contact = vec![(vec![(1, 1.0)], 0.0, 0.0)];
    model.nodes[0] = DenseNode {
        normal: Some(0),
        rows: vec![vec![(0, 1.0)]],
        old: vec![0.0],
        coefficient: 0.5,
        ..DenseNode::default()
    };
    let with = |u: f64, normal: f64, force: f64| {
        let u = vec![(3.0 - force) / 4.0 + u, (2.0 - normal) / 4.0];
        let point = DenseAnswer { u, lambda: vec![normal], mu: vec![], tangential: vec![force] };
        model.judged(&point)
    };
    let right = with(0.0, 2.0, 1.0);
    assert!(right.certificate.worst() <= 0.1 && right.nodes == [FrictionState::Slip]);
    assert_eq!(with(0.0, 0.0, 0.0).nodes, [FrictionState::Open]);
    for (normal, force) in [(2.0, 1.0 + 1e-5), (1.0, 1.0), (0.0, 1e-5), (-2.0, 1e-5), (-2.0, -1.0)] {
        let seen = with(0.0, normal, force).certificate;
        assert!(seen.friction_cone.ratio > 1.0, "{normal} {force} {seen:?}");
    }
}

/// The bound holds at an open contact; without a bound the force must be 0.
#[test]
fn a_bound_acts_at_an_open_node() {
    let mut model = springs(1.0, &[3.0, -2.0], 1.0);
    model.contact = vec![(vec![(1, 1.0)], 0.0, 0.0)];
    model.nodes[0].rows.truncate(1);
    model.nodes[0].old.truncate(1);
    (model.nodes[0].normal, model.nodes[0].coefficient) = (Some(0), 0.5);
    let with = |u: f64, force: f64| DenseAnswer {
        u: vec![u, -0.5],
        lambda: vec![0.0],
        mu: vec![],
        tangential: vec![force],
    };
    let right = model.judged(&with(0.5, 1.0));
    assert!(right.certificate.worst() <= 0.1 && right.nodes == [FrictionState::Slip]);
    assert!(model.certificate(&with(0.75, 0.0)).friction_work.ratio > 1.0, "the bound is forgotten");
    model.nodes[0].bound = 0.0;
    let open = model.judged(&with(0.75, 0.0));
    assert!(open.certificate.worst() <= 0.1 && open.nodes == [FrictionState::Open]);
    assert!(model.certificate(&with(0.5, 1.0)).friction_cone.ratio > 1.0);
}

/// A bound so large that no force reaches it acts as glue: rounding of the slip does no work.
#[test]
fn a_bound_without_end_is_glue() {
    for bound in [1e6, 1e30, 1e300] {
        let mut model = springs(1.0, &[0.75], 1.0);
        model.nodes[0].bound = bound;
        for slip in [0.0, 1e-17, -1e-16] {
            let right = model.certificate(&point(&[slip], &[0.75]));
            assert!(right.worst() <= 0.1, "{bound:e} {slip:e} {right:?}");
        }
        let slips = model.certificate(&point(&[1e-5], &[0.75]));
        assert!(slips.friction_work.ratio > 1.0 && slips.friction_stick.ratio > 1.0, "{bound:e} {slips:?}");
    }
}

/// The node has slipped without load; or its row is too small to have a scale; or s_old is NaN.
#[test]
fn what_has_no_measure_does_not_pass() {
    let mut model = springs(1.0, &[0.0], 1.0);
    assert!(model.certificate(&point(&[0.0], &[0.0])).passed());
    model.nodes[0].old = vec![1.0];
    let rest = model.certificate(&point(&[0.0], &[0.0]));
    assert!(!(rest.friction_work.ratio <= 1.0) && !(rest.friction_stick.ratio <= 1.0), "{rest:?}");
    let mut model = springs(1.0, &[3.0], 1.0);
    model.nodes[0].rows[0][0].1 = 1e-200;
    assert!(!model.certificate(&point(&[0.75], &[0.0])).passed());
    let mut model = springs(1.0, &[3.0], 1.0);
    model.nodes[0].old[0] = f64::NAN;
    assert!(!(model.certificate(&point(&[0.5], &[1.0])).friction_work.ratio <= 1.0));
}

/// The node slips with a force error of 1e-6; the spring is in equilibrium with this force.
#[test]
fn the_error_of_a_tangential_force_is_estimated() {
    let (model, error) = (springs(1.0, &[3.0], 1.0), 1e-6);
    let estimated = |force: f64| model.judged(&point(&[(3.0 - force) / 4.0], &[force])).bodies[0].force_error;
    for force in [1.0 - error, 1.0 + error] {
        assert!((0.5..2.0).contains(&(estimated(force) / error)), "{:e}", estimated(force));
    }
    assert!(estimated(1.0) <= 1e-15);
}
