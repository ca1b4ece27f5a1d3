//! Equality rows on some of the directions of a node with friction in space.

use decks::random::Random;
use decks::Deck;
use feti_contact::solver::{FrictionState, Outcome, RowKind};

use crate::coulomb::struck_out::springs;
use crate::support::hand_over;

/// `r` with `(f_x / (k_x r + b))^2 + (f_y / (k_y r + b))^2 = 1`: the slip of a point on springs k pushed by f beyond the bound b, because
/// `(k + b / r) u = f`, `r = |u|`.
pub fn slip(k: [f64; 2], f: [f64; 2], b: f64) -> f64 {
    let exceeds = |r: f64| (f[0] / (k[0] * r + b)).hypot(f[1] / (k[1] * r + b)) > 1.0;
    let (mut low, mut high) = (0.0, f[0].hypot(f[1]) / k[0].min(k[1]));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        *(if exceeds(middle) { &mut low } else { &mut high }) = middle;
    }
    high
}

/// A point on springs along x, y, z, pressed onto a wall across z, whose x, y, both or neither are tied to springs of another body.
#[test]
fn a_node_in_space_slips_along_the_whole_force_whichever_direction_is_tied() {
    let mut random = Random::new(12);
    for case in 0..60 {
        let tied: &[usize] = [&[][..], &[0], &[1], &[0, 1]][case % 4];
        let decades = if case < 20 { 0.0 } else { 3.0 };
        let k: Vec<f64> = (0..3).map(|_| random.decades(-decades, decades)).collect();
        let other: Vec<f64> = (0..2).map(|_| random.decades(-decades, decades)).collect();
        let (mu, press) = (random.between(0.1, 0.9), random.between(0.5, 2.0));
        let angle = random.between(0.0, 6.3);
        let push = mu * press * random.between(1.2, 4.0);
        let load = [push * angle.cos(), push * angle.sin(), press];
        let mut deck = Deck::new("tied", vec![springs(&k, &load), springs(&other, &[0.0; 2])]);
        let row = random.decades(-1.0, 1.0);
        deck.contact.push(&[(2, row)], 0.0);
        tied.iter().for_each(|&j| deck.equalities.push(&[(j, 1.0), (3 + j, -1.0)], 0.0));
        deck.friction = decks::Friction::none(2, 5);
        deck.friction.push(Some(0), &[&[(0, row)], &[(1, row)]], mu, 0.0);
        let mut problem = hand_over::problem(&deck).unwrap();
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Solved, "{case}: {:?}", report.certificate);
        assert_eq!(problem.friction_states().unwrap(), [FrictionState::Slip]);
        let of = |j: usize| k[j] + if tied.contains(&j) { other[j] } else { 0.0 };
        let (stiffness, b) = ([of(0), of(1)], mu * press);
        let r = slip(stiffness, [load[0], load[1]], b);
        let found = problem.multipliers(RowKind::Tangential).unwrap();
        for j in 0..2 {
            let expected = load[j] * b / (stiffness[j] * r + b);
            assert!((row * found[j] - expected).abs() < 1e-7 * b, "{case} {j}: {found:?} for {expected}");
        }
        let normal = problem.multipliers(RowKind::Inequality).unwrap()[0];
        assert!((row * normal - press).abs() < 1e-9 * press, "{case}: {normal}");
    }
}
