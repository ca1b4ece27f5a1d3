//! Claims about the yardstick.

use crate::random::Random;
use crate::varied::{self, Class, Varied};
use crate::yardstick::{Answer, Yardstick};

fn truth(case: &Varied) -> Answer {
    Answer { u: case.displacement.clone(), lambda: case.forces.clone(), mu: case.equality_forces.clone() }
}

fn times(v: &[f64], factor: f64) -> Vec<f64> {
    v.iter().map(|v| v * factor).collect()
}

#[test]
fn an_answer_rounded_to_15_digits_has_no_error_that_counts() {
    for case in (0..130).map(varied::case) {
        let truth = truth(&case);
        let yardstick = Yardstick::new(&case.deck, &truth, case.undetermined > 0);
        let round = |v: &[f64]| v.iter().map(|v| varied::rounded(*v)).collect();
        let rounded = Answer { u: round(&truth.u), lambda: round(&truth.lambda), mu: round(&truth.mu) };
        assert!(yardstick.worst(&rounded).0 <= 0.1, "{}", case.deck.name);
    }
}

/// A thousandth of all forces: seen in every body with forces, but where they are a small part of its load.
#[test]
fn an_error_of_a_thousandth_counts() {
    let (mut seen, mut all) = (0, 0);
    for case in (0..260).map(varied::case).filter(|case| case.classes[0] != Class::Newton) {
        let truth = truth(&case);
        let yardstick = Yardstick::new(&case.deck, &truth, case.undetermined > 0);
        let other =
            Answer { u: truth.u.clone(), lambda: times(&truth.lambda, 1.001), mu: times(&truth.mu, 1.001) };
        let forces = yardstick.ratios(&other).into_iter().zip(&yardstick.sizes);
        let felt = forces.filter(|(_, size)| size.forces > 0.0).map(|(ratio, _)| ratio.forces > 1.0);
        felt.for_each(|found| (seen, all) = (seen + usize::from(found), all + 1));
    }
    assert!(seen * 100 > all * 95, "{seen} of {all}");
}

/// Ratios stay when lengths are in other units by a factor of 2^10, forces by 2^-7.
#[test]
fn units_do_not_matter() {
    for (seed, mut case) in (0..26).map(|seed| (seed, varied::case(seed))) {
        let mut random = Random::new(seed);
        let ratios = |case: &Varied, noise: &[f64]| {
            let truth = truth(case);
            let u = truth.u.iter().zip(noise).map(|(u, e)| u * (1.0 + e)).collect();
            let other = Answer { u, ..truth.clone() };
            Yardstick::new(&case.deck, &truth, false).worst(&other)
        };
        let noise = random.normals(case.displacement.len(), 1e-5);
        let before = ratios(&case, &noise);
        let (length, force) = (1024.0, 1.0 / 128.0);
        for body in &mut case.deck.bodies {
            body.stiffness.val.iter_mut().for_each(|k| *k *= force / length);
            body.load.iter_mut().for_each(|f| *f *= force);
        }
        for rows in [&mut case.deck.contact, &mut case.deck.equalities] {
            rows.rhs.iter_mut().for_each(|c| *c *= length);
            rows.compliance.iter_mut().for_each(|c| *c *= length / force);
        }
        case.displacement = times(&case.displacement, length);
        case.forces = times(&case.forces, force);
        case.equality_forces = times(&case.equality_forces, force);
        let after = ratios(&case, &noise);
        assert!((after.0 / before.0 - 1.0).abs() < 1e-6, "{seed}: {before:?} {after:?}");
    }
}
