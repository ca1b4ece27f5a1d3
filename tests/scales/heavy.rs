//! A heavy body whose loads cancel, tied to a light one: what cancels is known to its rounding only.

use decks::{Body, Csr, Deck};

use crate::scales::{problem, solved};

/// Stiffness and loads of the heavy body; those of the light one.
const HEAVY: (f64, f64) = (1e8, 1e9 / 3.0);
const LIGHT: (f64, f64) = (1e-3, 1e-3);

/// A bar of two unknowns, free to move.
fn bar(stiffness: f64, load: [f64; 2]) -> Body {
    Body {
        stiffness: Csr::from_dense(2, &[stiffness, -stiffness, -stiffness, stiffness]),
        null_space: Some(vec![vec![1.0, 1.0]]),
        load: load.to_vec(),
        coordinates: vec![[0.0; 3]; 2],
        node: vec![1, 2],
        direction: vec![1; 2],
    }
}

/// The loads of both bodies cancel but for 2e-8, the rounding of the heavy body's loads. This may push the light one either way: no
/// wall carries it, and the tie carries the load of the light body.
#[test]
fn no_row_of_a_light_body_carries_rounding_of_a_heavy_one() {
    let ((stiff, large), (soft, small)) = (HEAVY, LIGHT);
    let mut deck = Deck::new("heavy", vec![bar(stiff, [large, small - large]), bar(soft, [0.0, -small])]);
    assert_ne!(large + (small - large), small);
    deck.equalities.push(&[(1, 1.0), (2, -1.0)], 0.0);
    for sign in [1.0, -1.0] {
        deck.contact.push(&[(3, sign)], 10.0);
    }
    let found = solved(&mut problem(&deck));
    assert_eq!(found.lambda, [0.0, 0.0]);
    assert!((found.mu[0] / small - 1.0).abs() < 1e-12, "{:?}", found.mu);
    assert!((found.u[3] - found.u[2] + small / soft).abs() < 1e-12, "{:?}", found.u);
}
