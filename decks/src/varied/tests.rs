//! Claims about varied cases.

use std::collections::BTreeMap;

use crate::dd::{self, Dd};
use crate::varied::{case, Class, Varied, CLASSES};
use crate::vector::norm_max;
use crate::yardstick::Answer;
use crate::{Deck, Rows};

const SEEDS: std::ops::Range<u64> = 0..520;

/// Residuals in double-double over the sum of the absolute terms of each.
fn worst_residual(case: &Varied) -> f64 {
    let (u, lambda, mu) = (&case.displacement, &case.forces, &case.equality_forces);
    residual(&case.deck, &Answer { u: u.clone(), lambda: lambda.clone(), mu: mu.clone() })
}

/// The same of any answer; open rows are open.
pub(crate) fn residual(deck: &Deck, answer: &Answer) -> f64 {
    let u = &answer.u;
    let mut worst = 0.0f64;
    let mut equilibrium: Vec<Vec<(f64, f64)>> = vec![Vec::new(); u.len()];
    for (p, body) in deck.bodies.iter().enumerate() {
        let first = deck.offset(p);
        for i in 0..body.dofs() {
            equilibrium[first + i].push((body.load[i], -1.0));
            equilibrium[first + i].extend(body.stiffness.row(i).map(|(j, k)| (k, u[first + j])));
        }
    }
    let mut add = |rows: &Rows, forces: &[f64], open: bool| {
        for (i, &force) in forces.iter().enumerate() {
            rows.matrix.row(i).for_each(|(j, v)| equilibrium[j].push((v, force)));
            let moved = rows.matrix.row(i).map(|(j, v)| (v, u[j]));
            let terms: Vec<_> = moved.chain([(rows.rhs[i], -1.0), (rows.compliance[i], -force)]).collect();
            if open && force == 0.0 {
                let rounding = 1e-15 * size(&terms);
                assert!(rows.rhs[i] == f64::INFINITY || sum(&terms) <= rounding, "{}: row {i}", deck.name);
            } else {
                worst = worst.max(relative(&terms));
            }
            assert!(!open || force >= 0.0);
        }
    };
    add(&deck.contact, &answer.lambda, true);
    add(&deck.equalities, &answer.mu, false);
    equilibrium.iter().fold(worst, |worst, terms| worst.max(relative(terms)))
}

fn sum(terms: &[(f64, f64)]) -> f64 {
    dd::dot(terms.iter().copied()).value()
}

fn size(terms: &[(f64, f64)]) -> f64 {
    terms.iter().fold(Dd::ZERO, |size, &(a, b)| size + Dd::product(a, b).abs()).value()
}

fn relative(terms: &[(f64, f64)]) -> f64 {
    let size = size(terms);
    if size == 0.0 {
        0.0
    } else {
        sum(terms).abs() / size
    }
}

#[test]
fn every_answer_is_right_to_rounding() {
    for case in SEEDS.map(case) {
        let worst = worst_residual(&case);
        assert!(worst < 1e-14, "{}: {worst:e}", case.deck.name);
    }
}

#[test]
fn every_class_occurs_and_most_cases_are_determined_and_well_conditioned() {
    let (mut count, mut good) = (BTreeMap::new(), BTreeMap::new());
    for case in SEEDS.map(case) {
        assert!((1..=130).contains(&case.deck.dofs()), "{}: {}", case.deck.name, case.deck.dofs());
        assert!((1..=6).contains(&case.deck.bodies.len()), "{}", case.deck.name);
        for class in &case.classes {
            *count.entry(*class).or_insert(0) += 1;
            *good.entry(*class).or_insert(0) += usize::from(case.condition <= 1e8);
        }
    }
    for class in CLASSES {
        assert!(count[&class] >= 40, "{class:?}: {count:?}");
        let share = if class == Class::Moduli { 4 } else { 2 };
        assert!(share * good[&class] >= count[&class], "{class:?}: {count:?} {good:?}");
    }
}

#[test]
fn what_makes_a_class_is_there() {
    for case in SEEDS.map(case) {
        let (deck, is) = (&case.deck, |class| case.classes[0] == class);
        let name = &deck.name;
        assert!(
            !is(Class::Far) || deck.contact.rhs.iter().any(|c| *c > 1e3 * norm_max(&case.displacement)),
            "{name}"
        );
        assert!(!is(Class::Thermal) || case.equality_forces.iter().all(|mu| *mu == 0.0), "{name}");
        assert!(
            !is(Class::Penalty) || deck.bodies.iter().all(|body| body.dofs() <= 3 || body.modes().is_empty())
        );
        let large = deck.bodies.iter().any(|body| body.dofs() > 3);
        assert_eq!(is(Class::Penalty) && large, !case.penalties.is_empty(), "{name}");
    }
}

/// Rows with finite gaps never join the groups of a case: stiffness and forces of one are none of the other's business.
#[test]
fn groups_have_nothing_in_common() {
    for case in SEEDS.map(case).filter(|case| case.classes[0] == Class::Groups) {
        let deck = &case.deck;
        let body = |dof: usize| (0..deck.bodies.len()).find(|&p| dof < deck.offset(p + 1)).unwrap();
        let mut label: Vec<usize> = (0..deck.bodies.len()).collect();
        for rows in [&deck.contact, &deck.equalities] {
            for i in 0..rows.len() {
                let touched: Vec<usize> = rows.matrix.row(i).map(|(j, _)| label[body(j)]).collect();
                label.iter_mut().for_each(|l| *l = if touched.contains(l) { touched[0] } else { *l });
            }
        }
        assert!(label.iter().any(|l| *l != label[0]), "{}", deck.name);
    }
}

#[test]
fn same_seed_gives_the_same_bits() {
    let pair = [11, 11].map(case);
    assert_eq!(pair[0].deck.load(), pair[1].deck.load());
    assert_eq!(pair[0].displacement, pair[1].displacement);
}
