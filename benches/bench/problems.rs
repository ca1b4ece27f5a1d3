//! The decks of the benchmark.

use decks::{Blocks, Cube, Deck};

/// A deck by its generator.
#[derive(Clone, Copy, PartialEq)]
pub enum Model {
    /// Two stacked blocks of so many elements along each edge: what the goals are set for.
    Blocks(usize),
    /// The upper of such blocks on a rigid obstacle in the place of the lower one.
    OneBody(usize),
    /// A cube cut into side^3 bodies of 8^3 elements, glued, on an obstacle.
    Cube(usize),
}

pub struct Case {
    pub name: &'static str,
    pub model: Model,
    /// Interleaved runs of which the median is taken.
    pub rounds: usize,
}

/// The deck that Clarabel and OSQP solve too; slow as they are, they are run once.
pub const PEERS: &str = "40k_peers";

/// Small decks first: a figure that short runs leave noisy gets more of them.
pub const CASES: [Case; 7] = [
    Case { name: "4k", model: Model::Blocks(8), rounds: 11 },
    Case { name: "13k", model: Model::Blocks(12), rounds: 7 },
    Case { name: "40k", model: Model::Blocks(18), rounds: 5 },
    Case { name: "144k", model: Model::Blocks(28), rounds: 3 },
    Case { name: "one_body", model: Model::OneBody(35), rounds: 1 },
    Case { name: "64_bodies", model: Model::Cube(4), rounds: 3 },
    Case { name: PEERS, model: Model::Blocks(18), rounds: 1 },
];

pub fn case(name: &str) -> Option<&'static Case> {
    CASES.iter().find(|case| case.name == name)
}

impl Model {
    pub fn build(self) -> Deck {
        match self {
            Model::Blocks(elements) => Blocks { elements, ..Blocks::default() }.build(),
            Model::OneBody(elements) => one_body(elements),
            Model::Cube(side) => Cube { subdomains: [side; 3], elements: 8, ..Cube::default() }.build(),
        }
    }
}

/// The upper of two blocks, -u <= gap instead of u_lower - u <= gap.
fn one_body(elements: usize) -> Deck {
    let mut pair = Blocks { elements, ..Blocks::default() }.build();
    let first = pair.offset(1);
    let mut deck = Deck::new(format!("one_body_{elements}"), vec![pair.bodies.remove(1)]);
    for (row, &gap) in pair.contact.rhs.iter().enumerate() {
        let upper = pair.contact.matrix.row(row).filter(|entry| entry.0 >= first);
        let entries: Vec<_> = upper.map(|(dof, value)| (dof - first, value)).collect();
        deck.contact.push(&entries, gap);
    }
    deck
}
