//! "There is no solution" only with a proof that holds on the data of the host: loads that are held but for rounding, rows
//! that repeat each other, forces far larger than the load; and small problems are never given up.
//!
//! | module | claims |
//! |---|---|
//! | [`resultants`] | loads whose resultant is rounding, or a small part of them |
//! | [`ties`] | equality rows that say what others say |
//! | [`levers`] | loads that need forces far larger than themselves |
//! | [`motions`] | the motion told of a load that nothing holds |
//! | [`noise`] | gaps and entries that are rounding |
//! | [`small`] | small problems on which the methods for large ones give up |
//! | [`unloading`] | loads that vanish |

mod levers;
mod motions;
mod noise;
mod resultants;
mod small;
mod ties;
mod unloading;

use decks::{Csr, Deck, Rows};

/// K of springs between unknowns and to the ground.
fn springs(n: usize, between: &[(usize, usize, f64)], ground: &[(usize, f64)]) -> Csr {
    let mut k = vec![0.0; n * n];
    for &(i, j, stiffness) in between {
        k[i * n + i] += stiffness;
        k[j * n + j] += stiffness;
        k[i * n + j] -= stiffness;
        k[j * n + i] -= stiffness;
    }
    ground.iter().for_each(|&(i, stiffness)| k[i * n + i] += stiffness);
    Csr::from_dense(n, &k)
}

/// A body of a stiffness, a load and the modes of its null space.
fn body(stiffness: Csr, modes: Vec<Vec<f64>>, load: Vec<f64>) -> decks::Body {
    let n = load.len();
    let null_space = (!modes.is_empty()).then_some(modes);
    let node = (1..=n as i32).collect();
    let coordinates = vec![[0.0; 3]; n];
    decks::Body { stiffness, null_space, load, coordinates, node, direction: vec![1; n] }
}

fn deck(
    bodies: Vec<decks::Body>,
    contact: &[(&[(usize, f64)], f64)],
    ties: &[(&[(usize, f64)], f64)],
) -> Deck {
    let mut deck = Deck::new("proofs", bodies);
    let push = |rows: &mut Rows, all: &[(&[(usize, f64)], f64)]| {
        all.iter().for_each(|(entries, rhs)| rows.push(entries, *rhs));
    };
    push(&mut deck.contact, contact);
    push(&mut deck.equalities, ties);
    deck
}
