//! The motion told with a load that nothing holds: rigid, resisted by no row, and the load does work on it.

use decks::dd::{dot, Dd};
use decks::hard::proof;
use decks::random::Random;
use decks::{Block, Csr, Deck};
use feti_contact::error::{Error, Kind, Proof};

use crate::support::hand_over;

/// |K v| against |K||v|, the worst unknown.
fn strained(k: &Csr, v: &[f64]) -> f64 {
    let worst = |i: usize| {
        let left: Dd = dot(k.row(i).map(|(j, k)| (k, v[j])));
        let size: f64 = k.row(i).map(|(j, k)| (k * v[j]).abs()).sum();
        if size > 0.0 {
            left.value().abs() / size
        } else {
            0.0
        }
    };
    (0..v.len()).map(worst).fold(0.0, f64::max)
}

/// A stack of free blocks in a corridor of slightly turned walls, `pull` upwards on the last.
fn stack(random: &mut Random) -> Deck {
    let bodies = 2 + random.below(3);
    let block = |p: usize| {
        let scale = 10f64.powf(random_power(p));
        let block = Block {
            dimension: 2,
            elements: [2, 2, 1],
            origin: [0.0, p as f64, 0.0],
            young: scale,
            ..Block::default()
        };
        block.floating().body
    };
    let mut all: Vec<_> = (0..bodies).map(block).collect();
    for body in &mut all {
        let size = body.stiffness.diagonal()[0];
        body.load = random.normals(body.dofs(), 1e-3 * size);
    }
    let mut deck = Deck::new("a stack", all);
    let (first, n) = (deck.offset(bodies - 1), deck.bodies[bodies - 1].dofs());
    for p in 0..bodies {
        for _ in 0..6 {
            let (i, angle) = (random.below(deck.bodies[p].dofs() / 2), random.normal() * 0.3);
            let at = deck.offset(p) + 2 * i;
            // every normal points down, but for little: upwards nothing holds
            deck.contact.push(&[(at, angle), (at + 1, -1.0)], 0.1 * random.uniform());
        }
    }
    for j in 0..n {
        if deck.bodies[bodies - 1].direction[j] == 2 {
            let diagonal = deck.bodies[bodies - 1].stiffness.diagonal()[j];
            deck.bodies[bodies - 1].load[j] += 0.1 * diagonal;
        }
    }
    assert!(first < deck.dofs());
    deck
}

/// Moduli 1, 1e4, 1e-3, ...
fn random_power(p: usize) -> f64 {
    [0.0, 4.0, -3.0, 2.0, -1.0][p % 5]
}

#[test]
fn the_motion_of_a_load_that_is_not_held_is_rigid_and_no_row_resists_it() {
    let (mut named, mut faults) = (0, Vec::new());
    for seed in 0..300 {
        let deck = stack(&mut Random::new(seed));
        let Err(error) = hand_over::problem(&deck).unwrap().solve() else { continue };
        let Error { kind: Kind::LoadNotHeld, proof: Some(proof), .. } = error else { continue };
        let Proof::Motion { v, .. } = &*proof else { panic!("{proof:?}") };
        named += 1;
        let motion = proof::motion(&deck, v);
        let (left, strain) = (
            if motion.work > 0.0 { motion.resisted / motion.work } else { f64::INFINITY },
            (0..deck.bodies.len())
                .map(|p| strained(&deck.bodies[p].stiffness, &v[deck.offset(p)..deck.offset(p + 1)]))
                .fold(0.0, f64::max),
        );
        if left > 1e-6 || strain > 1e-9 {
            faults.push(format!("seed {seed}: resisted by {left:.1e}, strain {strain:.1e}"));
        }
    }
    assert!(named > 100, "{named}");
    assert!(faults.is_empty(), "{} of {named}:\n{}", faults.len(), faults.join("\n"));
}
