//! Random problems with friction. Most are drawn with an answer: displacements, forces within their cones and slips along them come
//! first, then the loads, gaps and slips to begin with that make them one. Others have a load alone.

mod body;
mod loaded;
mod node;

use decks::random::Random;
use decks::{Deck, Friction, Rows};

pub use body::{elements, Element};

use body::Drawing;
use node::{Contact, State};

/// What is known of a problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// There is an answer; perhaps there are others.
    Answer,
    /// A rigid motion proves that there is none.
    NotHeld,
    /// Nothing.
    Nothing,
}

pub struct Drawn {
    pub class: &'static str,
    pub deck: Deck,
    pub known: Known,
    /// The elements of each body.
    pub elements: Vec<Vec<Element>>,
}

/// What of a class is other than in the first.
const CLASSES: [&str; 17] = [
    "plane",
    "space",
    "bounds alone",
    "bounds and mu",
    "mixed rows",
    "repeated nodes",
    "oblique",
    "contrast",
    "many bodies",
    "stiff supports",
    "joints",
    "far rows",
    "units",
    "degenerate",
    "sliding",
    "loads, held",
    "loads, floating",
];

/// How large problems are.
pub struct Sizes {
    pub nodes: usize,
    pub bodies: usize,
    pub many: usize,
}

pub const SIZES: Sizes = Sizes { nodes: 6, bodies: 3, many: 50 };
pub const OTHER_SIZES: Sizes = Sizes { nodes: 12, bodies: 6, many: 20 };

pub fn case(seed: u64, sizes: &Sizes) -> Drawn {
    let class = CLASSES[seed as usize % CLASSES.len()];
    let mut random = Random::new(seed ^ 0x6672_6963_7469_6f6e);
    match class {
        "sliding" => loaded::sliding(&mut random),
        "loads, held" | "loads, floating" => loaded::loaded(&mut random, class, sizes),
        _ => {
            let (deck, elements) = with_answer(&mut random, class, sizes);
            Drawn { class, deck, known: Known::Answer, elements }
        }
    }
}

/// A number of [0, 1], its ends included.
fn coefficient(random: &mut Random) -> f64 {
    match random.below(10) {
        0 => 0.0,
        1 => 1.0,
        _ => random.uniform(),
    }
}

fn with_answer(random: &mut Random, class: &'static str, sizes: &Sizes) -> (Deck, Vec<Vec<Element>>) {
    let dim = match class {
        "plane" => 2,
        "space" => 3,
        _ => 2 + usize::from(random.chance(0.3)),
    };
    let count = match class {
        "many bodies" => 4 + random.below(sizes.many - 3),
        _ => 1 + random.below(sizes.bodies),
    };
    let (length, young) = match class {
        "units" => (random.decades(-8.0, 8.0), random.decades(-12.0, 12.0)),
        _ => (1.0, 1.0),
    };
    let mut drawing = Drawing::new(dim, length, young);
    for _ in 0..count {
        let softer = if class == "contrast" { random.decades(-4.0, 0.0) } else { 1.0 };
        drawing.add(random, softer);
    }
    let most = if class == "many bodies" { 2 * count } else { sizes.nodes };
    let contacts = contacts(random, class, &drawing, most);
    if class == "stiff supports" {
        node::support(&mut drawing, random, &contacts);
    }
    let elements = drawing.elements.clone();
    (answered(random, class, drawing, &contacts), elements)
}

/// One to `most` contacts; every body has one where there is room.
fn contacts(random: &mut Random, class: &str, drawing: &Drawing, most: usize) -> Vec<Contact> {
    let count = (1 + random.below(most)).max(drawing.bodies.len().min(most));
    let mut all: Vec<Contact> = Vec::new();
    for k in 0..count {
        if class == "repeated nodes" && k > 0 && random.chance(0.4) {
            let again = all[random.below(k)].repeated(random);
            all.push(again);
        } else {
            all.push(Contact::new(random, class, drawing, k % drawing.bodies.len()));
        }
    }
    all
}

/// Loads, gaps and slips to begin with that make drawn displacements and forces an answer.
fn answered(random: &mut Random, class: &str, drawing: Drawing, contacts: &[Contact]) -> Deck {
    let moves = drawing.length * random.decades(-3.0, 0.0);
    let travel = if class == "far rows" { random.decades(0.0, 4.0) } else { 1.0 };
    let u = drawing.displacements(random, moves, travel);
    let dofs = u.len();
    let mut deck = Deck::new("friction with an answer", drawing.bodies.clone());
    deck.friction = Friction::none(drawing.dim - 1, dofs);
    let (mut lambda, mut along, mut mu) = (Vec::new(), Vec::new(), Vec::new());
    for contact in contacts {
        let force = moves * contact.stiffness * random.decades(-1.0, 1.0);
        let state = State::drawn(random, class, contact, force, moves);
        contact.push(&mut deck, &u, &state);
        lambda.extend(contact.is_normal().then_some(state.normal / contact.factor));
        if contact.rubs {
            along.extend(state.along.iter().map(|t| t / contact.factor));
        }
    }
    if class == "far rows" {
        for _ in 0..1 + random.below(3) {
            let body = random.below(drawing.bodies.len());
            let mut far = Contact::new(random, "plane", &drawing, body);
            far.gap = Some(if random.chance(0.5) { 1e6 * drawing.length } else { f64::INFINITY });
            far.push(&mut deck, &u, &State::open(drawing.dim - 1));
            lambda.extend(far.is_normal().then_some(0.0));
            along.extend(if far.rubs { vec![0.0; drawing.dim - 1] } else { Vec::new() });
        }
    }
    if class == "joints" {
        for _ in 0..1 + random.below(2) {
            let body = random.below(drawing.bodies.len());
            let joint = Contact::new(random, "plane", &drawing, body);
            let force = moves * joint.stiffness * random.normal();
            let compliance =
                if random.chance(0.3) { random.decades(-2.0, 1.0) / joint.stiffness } else { 0.0 };
            let row = joint.row(&joint.normal);
            let at: f64 = row.iter().map(|&(j, b)| b * u[j]).sum();
            let (force, compliance) = (force / joint.factor, compliance * joint.factor * joint.factor);
            deck.equalities.push_compliant(&row, at - compliance * force, compliance);
            mu.push(force);
        }
    }
    balance(&mut deck, &u, [&lambda, &along, &mu]);
    deck
}

/// f = K u + B'lambda + T'lambda_t + H'mu
fn balance(deck: &mut Deck, u: &[f64], [lambda, along, mu]: [&[f64]; 3]) {
    let by = |rows: &Rows, forces: &[f64]| rows.matrix.transpose_times(forces);
    let all = [by(&deck.contact, lambda), by(&deck.friction.rows, along), by(&deck.equalities, mu)];
    let mut first = 0;
    for body in &mut deck.bodies {
        let range = first..first + body.dofs();
        first = range.end;
        body.load = body.stiffness.times(&u[range.clone()]);
        for forces in &all {
            body.load.iter_mut().zip(&forces[range.clone()]).for_each(|(f, r)| *f += r);
        }
    }
}
