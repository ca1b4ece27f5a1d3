//! Weak supports: they carry nothing where friction holds the load, and what it does not hold where it does not.

use feti_contact::qp::friction::{friction, FrictionStart, Supported};
use feti_contact::qp::Verdict;

use crate::friction::deck::Deck;
use crate::friction::problem::Content;

#[test]
fn weak_supports_carry_what_friction_does_not_hold() {
    for deck in [Deck::new(2, 12, 1, 0.6, 0.5), Deck::new(3, 3, 1, 0.3, 0.5)] {
        let size = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let carried = |load: f64, kappa: f64| {
            let given = Deck { load, ..deck }.given();
            let supported = Supported::new(given.problem(), kappa).unwrap();
            let limits = given.limits(1e-9, 0);
            let found =
                friction(supported.problem(), limits, FrictionStart::default(), &mut Content, &mut Content)
                    .unwrap();
            assert_eq!(found.verdict, Verdict::Solved, "{load} {kappa} {} {:?}", found.merit, found.counts);
            size(supported.unheld(&found.x)) / size(&given.e)
        };
        let (held, weaker) = (carried(0.5, 1e-3), carried(0.5, 1e-5));
        assert!(weaker < 0.1 * held && held < 5e-2, "{held:e} {weaker:e}");
        // 1.5 of what slides: a third of the push is carried, whatever the supports are
        let (beyond, weaker) = (carried(1.5, 1e-3), carried(1.5, 1e-5));
        println!("{beyond:e} {weaker:e}");
        assert!(beyond > 0.02 && (beyond - weaker).abs() < 0.1 * beyond, "{beyond:e} {weaker:e}");
    }
}
