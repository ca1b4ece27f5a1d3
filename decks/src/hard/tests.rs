//! Claims about hard cases.

use std::collections::BTreeMap;

use crate::hard::{case, proof, Ends, Kind, KINDS};
use crate::small::SpringAndBlock;
use crate::varied::tests::residual;
use crate::Deck;

const SEEDS: std::ops::Range<u64> = 0..520;

#[test]
fn same_seed_gives_the_same_bits() {
    for seed in 0..26 {
        let pair = [seed, seed].map(case);
        assert_eq!(pair[0].deck.load(), pair[1].deck.load());
        assert_eq!(pair[0].deck.contact.rhs, pair[1].deck.contact.rhs);
    }
}

#[test]
fn every_kind_occurs_and_most_ends_are_known() {
    let mut count: BTreeMap<Kind, [usize; 2]> = BTreeMap::new();
    for case in SEEDS.map(case) {
        assert!((1..=130).contains(&case.deck.dofs()), "{}: {}", case.deck.name, case.deck.dofs());
        for &kind in &case.kinds {
            let counts = count.entry(kind).or_default();
            counts[0] += 1;
            counts[1] += usize::from(case.ends != Ends::ANY);
        }
    }
    for kind in KINDS {
        assert!(count[&kind][0] >= 40, "{kind:?} {count:?}");
        assert!(kind == Kind::Drawn || 10 * count[&kind][1] > 6 * count[&kind][0], "{kind:?} {count:?}");
    }
}

/// Sums of ties keep the rounding of their largest term, K of few digits resists rigid motions; resultants of free bodies are what
/// nothing takes.
#[test]
fn every_answer_is_right_to_rounding() {
    for case in SEEDS.map(case).filter(|case| case.kinds[0] != Kind::Balanced) {
        let drawn = case.answer.as_ref().filter(|_| case.kinds[0] != Kind::Drawn);
        let worst = drawn.map_or(0.0, |answer| residual(&case.deck, answer));
        let sums = if case.kinds.contains(&Kind::Ties) { 1e-9 } else { 1e-13 };
        let limit = f64::max(sums, 10f64.powi(2 - case.digits as i32));
        assert!(worst < limit, "{}: {worst:e}", case.deck.name);
    }
}

/// A spring and a block that two rows keep: the block floats on its own and the load 3 pushes it.
fn block(rows: &[(f64, f64)]) -> Deck {
    let mut deck = SpringAndBlock { spring: 2.0, force: 3.0, gap: 0.25, block: Some(6.0) }.build().deck;
    deck.contact = crate::Rows::none(deck.dofs());
    let last = deck.dofs() - 1;
    rows.iter().for_each(|&(value, gap)| deck.contact.push(&[(last, value)], gap));
    deck
}

/// v moves the block along its load, against a row or with it; a block that is bent moves otherwise.
#[test]
fn a_motion_proves_only_what_no_row_resists() {
    let holds = |value: f64| {
        let deck = block(&[(value, 1.0)]);
        let body = &deck.bodies[1];
        let work: f64 = body.load.iter().zip(&body.modes()[0]).map(|(f, r)| f * r).sum();
        let mut v = vec![0.0; deck.dofs()];
        let sense = if work > 0.0 { 1.0 } else { -1.0 };
        v[deck.offset(1)..].iter_mut().zip(&body.modes()[0]).for_each(|(v, r)| *v = sense * r);
        let against: Vec<f64> = v.iter().map(|v| -v).collect();
        assert!(!proof::motion(&deck, &against).holds(16));
        (proof::motion(&deck, &v).holds(16), v[deck.dofs() - 1])
    };
    let sense = holds(1.0).1;
    assert!(!holds(sense).0 && holds(-sense).0);
    let mut bent = vec![0.0; block(&[]).dofs()];
    bent[1] = sense;
    assert!(!proof::motion(&block(&[]), &bent).holds(16));
}

/// u <= c and -u <= -d contradict each other where d > c by more than rounding; rows that differ by 1e-9 do not: u of 1e9 undoes it.
#[test]
fn weights_prove_only_what_no_displacement_undoes() {
    let both = [(0, 1.0), (1, 1.0)];
    assert!(proof::weights(&block(&[(1.0, 1.0), (-1.0, -1.1)]), &both).hold());
    assert!(!proof::weights(&block(&[(1.0, 1.0), (-1.0, -0.9)]), &both).hold());
    assert!(!proof::weights(&block(&[(1.0, 1.0), (-1.0 - 1e-6, -1.1)]), &both).hold());
    assert!(!proof::weights(&block(&[(1.0, 1.0), (-1.0, -1.0 - 1e-12)]), &both).hold());
    assert!(!proof::weights(&block(&[(1.0, 1.0), (-1.0, -1.1)]), &[(0, -1.0), (1, -1.0)]).hold());
    assert!(!proof::weights(&block(&[(1.0, 1.0), (-1.0, f64::INFINITY)]), &both).hold());
}
