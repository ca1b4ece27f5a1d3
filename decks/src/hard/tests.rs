//! Claims about hard cases.

use std::collections::BTreeMap;

use crate::hard::{case, Ends, Kind, KINDS};
use crate::varied::tests::residual;

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
