//! Load steps to and fro: the answer of the last step is a start no worse than none.

use decks::{Block, Deck, Friction};
use feti_contact::solver::{Outcome, Problem};

use crate::support::hand_over;

const BLOCKS: usize = 8;
const ELEMENTS: [usize; 3] = [16, 8, 1];
const STEPS: usize = 25;

/// Flat blocks on each other and on the ground, loose.
fn stack(mu: f64) -> Deck {
    let block = Block { dimension: 2, elements: ELEMENTS, size: [4.0, 1.0, 1.0], ..Block::default() };
    let mut deck = Deck::new("stack", (0..BLOCKS).map(|_| block.floating().body).collect());
    deck.friction = Friction::none(1, deck.dofs());
    let n = 2 * block.nodes();
    for p in 0..BLOCKS {
        for i in 0..=ELEMENTS[0] {
            let (own, under) = (p * n + 2 * block.node([i, 0, 0]), 2 * block.node([i, ELEMENTS[1], 0]));
            let row = |axis: usize, sense: f64| {
                let mut row = vec![(own + axis, sense)];
                row.extend((p > 0).then(|| ((p - 1) * n + under + axis, -sense)));
                row
            };
            deck.contact.push(&row(1, -1.0), 0.0);
            deck.friction.push(Some(deck.contact.len() - 1), &[&row(0, 1.0)], mu, 0.0);
        }
    }
    deck
}

/// Pressed, and pushed to and fro on top by up to a part of what friction holds.
fn load(problem: &mut Problem, deck: &Deck, mu: f64, step: usize) {
    let (nodes, press) = (ELEMENTS[0] + 1, 0.02);
    let turn = std::f64::consts::TAU * step as f64 / 20.0;
    for p in 0..BLOCKS {
        let mut f = vec![0.0; deck.bodies[p].dofs()];
        if p + 1 == BLOCKS {
            for i in 0..nodes {
                let top = 2 * (i + nodes * ELEMENTS[1]);
                (f[top], f[top + 1]) = (0.6 * mu * press * turn.sin(), -press);
            }
        }
        problem.set_load(p, &f).unwrap();
    }
}

#[test]
fn the_last_step_is_a_better_start_than_none() {
    let (mu, deck) = (0.3, stack(0.3));
    let run = |start: &str| {
        let mut problem = hand_over::problem(&deck).unwrap();
        problem.set_str("start", start).unwrap();
        let (mut products, mut slips) = (0, Vec::new());
        for step in 1..=STEPS {
            load(&mut problem, &deck, mu, step);
            let report = problem.solve().unwrap();
            assert_eq!(report.outcome, Outcome::Solved, "{start} {step}");
            products += report.counts.products;
            slips = problem.slips().unwrap().to_vec();
            problem.commit_friction().unwrap();
        }
        (products, slips)
    };
    let [(cold, slips), (previous, same)] = ["cold", "previous"].map(run);
    assert!(10 * previous <= 9 * cold, "{previous} products, {cold} from nothing");
    let size = slips.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
    assert!(slips.iter().zip(&same).all(|(a, b)| (a - b).abs() <= 1e-6 * size));
}
