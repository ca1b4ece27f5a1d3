//! The decks of the benchmark.

use decks::{rubbing, Block, Blocks, ByElements, Cube, Deck};

use crate::programs::Program;

/// A deck by its generator.
#[derive(Clone, Copy, PartialEq)]
pub enum Model {
    /// Two stacked blocks of so many elements along each edge: what the goals are set for.
    Blocks(usize),
    /// The same with friction, the upper one pushed along: about a third of the closed nodes slip.
    Rubbing(usize),
    /// Two flat ones: elements along x and y, layers of each block.
    Flat(usize, usize),
    /// The upper of such blocks on a rigid obstacle in the place of the lower one.
    OneBody(usize),
    /// Blocks whose modulus differs from element to element, by matrices or by elements.
    Varied(usize),
    /// The upper of them on the obstacle.
    VariedBody(usize),
    /// A cube cut into side^3 bodies of 8^3 elements, glued, on an obstacle.
    Cube(usize),
    /// One cube of `CUT`^3 elements, cut into side^3 bodies: the same solution whatever the side, lengths and all
    /// displacements times the side.
    Cut(usize),
    /// One body of so many cubic elements along each edge, clamped at x = 0, for a factorisation alone.
    Clamped([usize; 3]),
}

/// How far the modulus of an element is from that of its body: enough for no two pieces to be alike.
const VARIATION: f64 = 1e-3;
const SEED: u64 = 1;

/// Coefficient of friction, and the push as a part of the load that makes the upper block slide.
const COEFFICIENT: f64 = 0.3;
const PUSH: f64 = 0.5;

/// Elements along the edge of a cube that is cut: so many that 1, 2, 3 and 4 divide them.
const CUT: usize = 24;

pub struct Case {
    pub name: &'static str,
    pub model: Model,
    /// Interleaved runs of which the median is taken.
    pub rounds: usize,
}

/// The deck that a host's own loop, Clarabel and OSQP solve too; slow as they are, they are run once.
pub const PEERS: &str = "40k_peers";

/// Small decks first: a figure that short runs leave noisy gets more of them.
pub const CASES: [Case; 18] = [
    Case { name: "4k", model: Model::Blocks(8), rounds: 11 },
    Case { name: "13k", model: Model::Blocks(12), rounds: 7 },
    Case { name: "40k", model: Model::Blocks(18), rounds: 5 },
    Case { name: "144k", model: Model::Blocks(28), rounds: 3 },
    Case { name: "40k_friction", model: Model::Rubbing(18), rounds: 5 },
    Case { name: "144k_friction", model: Model::Rubbing(28), rounds: 3 },
    Case { name: "one_body", model: Model::OneBody(35), rounds: 1 },
    Case { name: "144k_cut", model: Model::Varied(28), rounds: 3 },
    Case { name: "140k_cut", model: Model::VariedBody(35), rounds: 1 },
    Case { name: "64_bodies", model: Model::Cube(4), rounds: 3 },
    Case { name: PEERS, model: Model::Blocks(18), rounds: 1 },
    Case { name: "cube_4k", model: Model::Clamped([10; 3]), rounds: 15 },
    Case { name: "cube_14k", model: Model::Clamped([16; 3]), rounds: 9 },
    Case { name: "cube_40k", model: Model::Clamped([23; 3]), rounds: 5 },
    Case { name: "plate_40k", model: Model::Clamped([66, 66, 2]), rounds: 7 },
    Case { name: "bar_41k", model: Model::Clamped([80, 12, 12]), rounds: 7 },
    Case { name: "300k_cut", model: Model::Varied(36), rounds: 1 },
    Case { name: "578k_cut", model: Model::Varied(45), rounds: 1 },
];

/// Decks of the scaling, beside those above. The flat ones have about as many unknowns as 40k.
pub const POINTS: [Case; 12] = [
    point("2k", Model::Blocks(6)),
    point("92k", Model::Blocks(24)),
    point("729_rows", Model::Flat(26, 9)),
    point("1296_rows", Model::Flat(35, 5)),
    point("1936_rows", Model::Flat(43, 3)),
    point("2704_rows", Model::Flat(51, 2)),
    point("4489_rows", Model::Flat(66, 1)),
    point("cut_1", Model::Cut(1)),
    point("cut_8", Model::Cut(2)),
    point("cut_27", Model::Cut(3)),
    point("cut_64", Model::Cut(4)),
    point("989k_cut", Model::Varied(54)),
];

const fn point(name: &'static str, model: Model) -> Case {
    Case { name, model, rounds: 3 }
}

pub fn case(name: &str) -> Option<&'static Case> {
    CASES.iter().chain(&POINTS).find(|case| case.name == name)
}

impl Case {
    /// What is run, in the order in which the programs take turns.
    pub fn programs(&self) -> Vec<Program> {
        use Program::{
            Cholmod, Clarabel, Cut, Factor, Faer, Few, Frictionless, HostLoop, Later, Osqp, Ours, Parts,
            Pieces,
        };
        match self.model {
            Model::Blocks(_) if self.name == PEERS => vec![Ours(1), HostLoop(6), HostLoop(9), Clarabel, Osqp],
            Model::Blocks(18 | 28) => vec![Ours(1), Cholmod(1), Few(1), Ours(2), Cholmod(2), Parts],
            Model::Blocks(_) => vec![Ours(1), Cholmod(1), Ours(2), Cholmod(2), Parts],
            Model::Rubbing(_) => vec![Ours(1), Few(1), Frictionless, Ours(2)],
            Model::OneBody(_) => vec![Ours(1), Ours(2)],
            Model::Varied(28) => vec![Cut(1), Cholmod(1), Cut(2), Ours(1), Later],
            Model::Varied(36) => vec![Cut(2), Cholmod(2), Ours(2), Cut(1), Pieces(216), Pieces(729)],
            Model::Varied(_) => vec![Cut(2), Cholmod(2), Ours(2), Cut(1)],
            Model::VariedBody(_) => vec![Cut(1), Ours(1), Cut(2), Later],
            Model::Clamped(_) => vec![Factor(1), Faer(1), Factor(2), Faer(2)],
            Model::Flat(..) | Model::Cube(_) | Model::Cut(_) => vec![Ours(1)],
        }
    }
}

impl Model {
    pub fn build(self) -> Deck {
        match self {
            Model::Blocks(elements) => blocks(elements).build(),
            Model::Rubbing(elements) => rubbing::blocks(&blocks(elements), COEFFICIENT, PUSH),
            Model::Flat(across, layers) => blocks(across).layered(layers),
            Model::OneBody(elements) => one_body(blocks(elements).build()),
            Model::Varied(elements) => blocks(elements).varied(VARIATION, SEED),
            Model::VariedBody(elements) => one_body(blocks(elements).varied(VARIATION, SEED)),
            Model::Cube(side) => Cube { subdomains: [side; 3], elements: 8, ..Cube::default() }.build(),
            Model::Cut(side) => {
                let gap = side as f64 * Cube::default().gap;
                Cube { subdomains: [side; 3], elements: CUT / side, gap, ..Cube::default() }.build()
            }
            Model::Clamped(elements) => clamped(elements),
        }
    }

    /// Without friction, and without the push, which nothing else holds.
    pub fn frictionless(self) -> Deck {
        match self {
            Model::Rubbing(elements) => Model::Blocks(elements).build(),
            other => other.build(),
        }
    }

    /// The same problem as that of [`Model::build`], of those that differ from element to element.
    pub fn by_elements(self) -> Option<ByElements> {
        match self {
            Model::Varied(elements) => Some(blocks(elements).varied_by_elements(VARIATION, SEED)),
            Model::VariedBody(elements) => {
                let mut pair = blocks(elements).varied_by_elements(VARIATION, SEED);
                Some(ByElements { deck: one_body(pair.deck), bodies: vec![pair.bodies.remove(1)] })
            }
            _ => None,
        }
    }

    /// Unknowns of all bodies, without building them.
    pub fn unknowns(self) -> usize {
        let stacked = |across: usize, layers: usize| 3 * (across + 1).pow(2) * (2 * layers + 1);
        let cubes = |side: usize, elements: usize| 3 * side.pow(3) * (elements + 1).pow(3);
        match self {
            Model::Blocks(elements) | Model::Rubbing(elements) | Model::Varied(elements) => {
                stacked(elements, elements)
            }
            Model::Flat(across, layers) => stacked(across, layers),
            Model::OneBody(elements) | Model::VariedBody(elements) => cubes(1, elements),
            Model::Cube(side) => cubes(side, 8),
            Model::Cut(side) => cubes(side, CUT / side),
            Model::Clamped([x, y, z]) => 3 * x * (y + 1) * (z + 1),
        }
    }
}

fn blocks(elements: usize) -> Blocks {
    Blocks { elements, ..Blocks::default() }
}

/// The upper of two blocks, -u <= gap instead of u_lower - u <= gap.
fn one_body(mut pair: Deck) -> Deck {
    let first = pair.offset(1);
    let mut deck = Deck::new("one_body", vec![pair.bodies.remove(1)]);
    for (row, &gap) in pair.contact.rhs.iter().enumerate() {
        let upper = pair.contact.matrix.row(row).filter(|entry| entry.0 >= first);
        let entries: Vec<_> = upper.map(|(dof, value)| (dof - first, value)).collect();
        deck.contact.push(&entries, gap);
    }
    deck
}

fn clamped(elements: [usize; 3]) -> Deck {
    let size = elements.map(|count| count as f64);
    let block = Block { elements, size, ..Block::default() };
    Deck::new("clamped", vec![block.part(|at| at[0] == 0).body])
}
