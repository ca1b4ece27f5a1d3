//! One to three unknowns, springs in the rows: the answers by hand, to 1e-10.

use decks::Deck;
use feti_contact::error::Kind;
use feti_contact::solver::{Problem, RowKind, RowState};

use crate::compliance::{answer, answer_of, assert_near, body, solved};
use crate::support::hand_over;

/// Springs k1, k2 at their walls, loads f1, f2, gap c, a spring k between their ends: u1 - u2 - c <= lambda/k.
fn facing(k: f64, gap: f64) -> Deck {
    let mut deck = Deck::new("facing", vec![body(&[2.0], &[3.0], false), body(&[5.0], &[-1.0], false)]);
    deck.contact.push_compliant(&[(0, 1.0), (1, -1.0)], gap, 1.0 / k);
    deck
}

/// lambda (1/k1 + 1/k2 + 1/k) = f1/k1 - f2/k2 - c = 1.7 - c where that is positive.
#[test]
fn two_springs_meet_through_a_third() {
    for k in [1e-6, 0.3, 4.0, 1e8] {
        for gap in [0.1, 1.6, 10.0] {
            let mut problem = hand_over::problem(&facing(k, gap)).unwrap();
            let report = solved(&mut problem, "facing");
            let lambda = ((1.7 - gap) / (0.5 + 0.2 + 1.0 / k)).max(0.0);
            let expected = [(3.0 - lambda) / 2.0, (-1.0 + lambda) / 5.0];
            let [u, forces, _] = answer(&problem);
            assert_near(&u, &expected, 1e-10, "u");
            assert_near(&forces, &[lambda], 1e-10, "lambda");
            let open = gap + lambda / k - (expected[0] - expected[1]);
            assert_near(&[1.0 + problem.gaps().unwrap()[0]], &[1.0 + open], 1e-10, "gap");
            let state = if lambda > 0.0 { RowState::Closed } else { RowState::Open };
            assert_eq!(problem.active().unwrap(), [state], "k = {k}, gap {gap}");
            let [u1, u2] = expected;
            let energy = u1 * u1 + 2.5 * u2 * u2 - 3.0 * u1 + u2 + 0.5 * lambda * lambda / k;
            assert!((report.energy - energy).abs() < 1e-10 * energy.abs());
        }
    }
}

/// A rigid block on a spring k1, pushed by 3 towards it: lambda = 3, u1 = -3/k1, u1 - u2 - c = 3/k.
#[test]
fn a_floating_block_sinks_into_its_compliant_contact() {
    for k in [1e-6, 4.0, 1e8] {
        let mut deck = Deck::new("block", vec![body(&[2.0], &[0.0], false), body(&[0.0], &[-3.0], true)]);
        deck.contact.push_compliant(&[(0, 1.0), (1, -1.0)], 0.25, 1.0 / k);
        let [u, lambda, _] = answer_of(&deck);
        assert_near(&u, &[-1.5, -1.5 - 0.25 - 3.0 / k], 1e-10, "u");
        assert_near(&lambda, &[3.0], 1e-10, "lambda");
    }
}

/// Stiffness 2 under a load 3, the row 2 u on a spring 4: 2 u = 3 - 2 mu and 2 u - h = mu/4, mu of either sign.
#[test]
fn an_elastic_support_pulls_and_pushes() {
    for h in [-1.0, 0.0, 3.0, 7.0] {
        let mut deck = Deck::new("support", vec![body(&[2.0], &[3.0], false)]);
        deck.equalities.push_compliant(&[(0, 2.0)], h, 0.25);
        let [u, _, mu] = answer_of(&deck);
        let expected = (3.0 - h) / 2.25;
        assert_near(&[1.0 + mu[0]], &[1.0 + expected], 1e-10, "mu");
        assert_near(&[1.0 + u[0]], &[1.0 + (3.0 - 2.0 * expected) / 2.0], 1e-10, "u");
    }
}

/// A rigid punch on a bed of springs that begin at different heights: p_i = k_i (u - c_i)_+, piecewise linear.
#[test]
fn a_rigid_punch_follows_the_law_of_pressure_and_overclosure() {
    let bed = [(0.0, 2.0), (0.5, 3.0), (1.25, 10.0), (4.0, 1.0)];
    let mut problem = hand_over::problem(&punch(&bed, 1.0)).unwrap();
    for depth in [0.1, 0.5, 0.75, 2.0, 7.0] {
        let pressure: Vec<f64> = bed.iter().map(|(gap, k)| k * f64::max(0.0, depth - gap)).collect();
        problem.set_load(0, &[pressure.iter().sum()]).unwrap();
        solved(&mut problem, "punch");
        let [u, lambda, _] = answer(&problem);
        assert_near(&u, &[depth], 1e-10, "depth");
        assert_near(&lambda, &pressure, 1e-10, "pressure");
    }
    assert_eq!(problem.report().unwrap().work.factorisations, 1);
}

/// One rigid dof over rows u - c_i <= lambda_i / k_i.
fn punch(bed: &[(f64, f64)], load: f64) -> Deck {
    let mut deck = Deck::new("punch", vec![body(&[0.0], &[load], true)]);
    bed.iter().for_each(|(gap, k)| deck.contact.push_compliant(&[(0, 1.0)], *gap, 1.0 / k));
    deck
}

/// The rigid row at 0.5 stops the punch; the springs before it carry what they can, the rest is its own.
#[test]
fn rigid_and_compliant_rows_in_one_direction_keep_their_own_forces() {
    let mut deck = punch(&[(0.0, 2.0), (0.25, 4.0), (0.25, 8.0), (0.75, 8.0)], 10.0);
    deck.contact.push(&[(0, 2.0)], 1.0);
    deck.contact.push(&[(0, 1.0)], 0.6);
    let mut problem = hand_over::problem(&deck).unwrap();
    solved(&mut problem, "stop");
    let [u, lambda, _] = answer(&problem);
    assert_near(&u, &[0.5], 1e-10, "u");
    assert_near(&lambda, &[1.0, 1.0, 2.0, 0.0, 3.0, 0.0], 1e-10, "lambda");
    let findings = problem.findings().unwrap();
    assert_eq!(
        findings.rows(RowKind::Inequality).collect::<Vec<_>>(),
        [(5, 0.5)],
        "only the rigid rows repeat"
    );
}

/// -c <= lambda/k and -h = mu/k: lambda = max(0, -k c), mu = -k h.
#[test]
fn compliant_rows_without_entries_are_springs_by_themselves() {
    let mut deck = facing(4.0, 0.1);
    deck.contact.push_compliant(&[], -3.0, 0.5);
    deck.contact.push_compliant(&[], 3.0, 0.5);
    deck.equalities.push_compliant(&[], -3.0, 0.25);
    deck.equalities.push_compliant(&[], 2.0, 0.25);
    let mut problem = hand_over::problem(&deck).unwrap();
    let report = solved(&mut problem, "without entries");
    let [u, lambda, mu] = answer(&problem);
    let alone = answer_of(&facing(4.0, 0.1));
    assert_eq!(u, alone[0]);
    assert_eq!(lambda, [alone[1][0], 6.0, 0.0]);
    assert_eq!(mu, [12.0, -8.0]);
    assert_eq!(problem.gaps().unwrap()[1..], [0.0, 3.0]);
    assert_eq!(problem.active().unwrap()[1..], [RowState::Closed, RowState::Open]);
    let springs = 0.5 * (0.5 * 36.0 + 0.25 * 144.0 + 0.25 * 64.0);
    let facing = hand_over::problem(&facing(4.0, 0.1)).unwrap().solve().unwrap();
    assert!((report.energy - facing.energy - springs).abs() < 1e-12 * springs);
    let mut applied = [0.0; 5];
    problem.dual_apply(&[1.0; 5], &mut applied).unwrap();
    assert_near(&applied, &[0.5 + 0.2 + 0.25, 0.5, 0.5, 0.25, 0.25], 1e-14, "F");
}

/// u <= -1 against -u <= -1: rigid, they contradict each other; with a spring in one of them the other wins, and in
/// both u is where the forces are in balance.
#[test]
fn springs_contradict_nothing_and_are_not_blamed() {
    let mut deck = Deck::new("against", vec![body(&[1.0], &[0.0], false)]);
    deck.contact.push(&[(0, 1.0)], -1.0);
    deck.contact.push(&[(0, -1.0)], -1.0);
    deck.contact.push_compliant(&[(0, 1.0)], -1.0, 1e-9);
    deck.equalities.push_compliant(&[(0, 1.0)], -1.0, 1e-9);
    let mut problem = hand_over::problem(&deck).unwrap();
    assert_eq!(problem.solve().unwrap_err().kind, Kind::GapsContradict);
    let blamed = |problem: &Problem, kind| -> Vec<usize> {
        problem.findings().unwrap().rows(kind).map(|(row, _)| row).collect()
    };
    assert_eq!(blamed(&problem, RowKind::Inequality), [0, 1]);
    assert_eq!(blamed(&problem, RowKind::Equality), []);
    problem.clear_rows(RowKind::Equality);
    problem.set_compliance(RowKind::Inequality, 0, &[1.0 / 3.0, 0.0, 0.5]).unwrap();
    solved(&mut problem, "one spring");
    // u = 1; 3 (u + 1) = 6 and 2 (u + 1) = 4 push it down, u = lambda_2 - 10
    let [u, lambda, _] = answer(&problem);
    assert_near(&u, &[1.0], 1e-10, "u");
    assert_near(&lambda, &[6.0, 11.0, 4.0], 1e-10, "lambda");
    problem.set_compliance(RowKind::Inequality, 1, &[0.25]).unwrap();
    solved(&mut problem, "springs");
    // u + 5 (u + 1) = 4 (1 - u): u = -1/10
    let [u, lambda, _] = answer(&problem);
    assert_near(&u, &[-0.1], 1e-10, "u");
    assert_near(&lambda, &[2.7, 4.4, 1.8], 1e-10, "lambda");
}

/// F + C in the units of the host: rows of 2 u1 and -u1 on a spring of stiffness 5.
#[test]
fn the_dual_operator_for_validation_contains_the_compliance() {
    let mut deck = Deck::new("dual", vec![body(&[5.0], &[1.0], false)]);
    deck.contact.push_compliant(&[(0, 2.0)], 0.0, 7.0);
    deck.contact.push(&[(0, -1.0)], 0.0);
    deck.equalities.push_compliant(&[(0, 1.0)], 0.5, 0.3);
    let mut problem = hand_over::problem(&deck).unwrap();
    let (mut applied, mut rhs) = ([0.0; 3], [0.0; 3]);
    problem.dual_apply(&[1.0, 10.0, 100.0], &mut applied).unwrap();
    // 92 / 5 is the displacement
    assert_near(&applied, &[2.0 * 92.0 / 5.0 + 7.0, -92.0 / 5.0, 92.0 / 5.0 + 30.0], 1e-14, "F");
    problem.dual_rhs(&mut rhs).unwrap();
    assert_near(&rhs, &[0.4, -0.2, 0.2 - 0.5], 1e-14, "d");
}

#[test]
fn a_compliance_that_is_none_is_refused_with_its_row() {
    let mut problem = hand_over::problem(&facing(4.0, 0.1)).unwrap();
    for value in [-1e-300, f64::NAN, f64::INFINITY] {
        let error = problem.set_compliance(RowKind::Inequality, 0, &[value]).unwrap_err();
        assert_eq!((error.kind, error.place.row), (Kind::Argument("inv_k"), Some(0)));
    }
    let error = problem.set_compliance(RowKind::Inequality, 1, &[1.0]).unwrap_err();
    assert_eq!(error.kind, Kind::Argument("first"));
    problem.set_compliance(RowKind::Inequality, 0, &[1.7e308]).unwrap();
    let error = problem.solve().unwrap_err();
    assert_eq!((error.kind, error.place.row), (Kind::Overflow, Some(0)));
    problem.set_compliance(RowKind::Inequality, 0, &[0.25]).unwrap();
    solved(&mut problem, "corrected");
}
