//! Plane models: blocks of quad4 elements, one on the other or under a wall.

use decks::{Block, Deck};

/// A block of width 1 and height `rows / across` with this modulus, its first node at height `from`.
fn block(across: usize, rows: usize, from: f64, young: f64) -> Block {
    let height = rows as f64 / across as f64;
    Block {
        dimension: 2,
        elements: [across, rows, 1],
        size: [1.0, height, 1.0],
        origin: [0.0, from, 0.0],
        young,
        ..Block::default()
    }
}

/// Gap at x: 0.02 (x - 1/2)^2, length.
fn gap(x: f64) -> f64 {
    0.02 * (x - 0.5).powi(2)
}

/// Pressure 0.01 (1 + x) on 0.1 < x < 0.6, the force on one node.
fn pressure(x: f64, across: usize) -> f64 {
    let inside = x > 0.1 + 1e-9 && x < 0.6 - 1e-9;
    if inside {
        0.01 * (1.0 + x) / across as f64
    } else {
        0.0
    }
}

/// A block held at its bottom and pushed up against a wall over its top: across + 1 rows u_y <= gap.
pub fn under_a_wall(across: usize, rows: usize) -> Deck {
    under_a_wall_of(Vec::new(), across, rows)
}

/// The same with the modulus of every element multiplied by its factor.
pub fn under_a_wall_of(factors: Vec<f64>, across: usize, rows: usize) -> Deck {
    let block = Block { factors, ..block(across, rows, 0.0, 1.0) };
    let mut part = block.part(|at| at[1] == 0);
    let mut contact = Vec::new();
    for at in block.grids().filter(|at| at[1] == rows) {
        let (dof, x) = (part.number[2 * block.node(at) + 1].unwrap(), block.position(at)[0]);
        part.body.load[dof] = 2.0 * pressure(x, across);
        contact.push((dof, gap(x) / 2.0));
    }
    let mut deck = Deck::new("under_a_wall", vec![part.body]);
    contact.iter().for_each(|&(dof, gap)| deck.contact.push(&[(dof, 1.0)], gap));
    deck
}

/// The same block in one piece, not held: what its bottom does is for the caller to say.
pub fn not_held(across: usize, rows: usize) -> Deck {
    let block = block(across, rows, 0.0, 1.0);
    let (held, mut body) = (under_a_wall(across, rows), block.floating().body);
    let first = 2 * (across + 1);
    body.load[first..].copy_from_slice(&held.bodies[0].load);
    let mut deck = Deck::new("not_held", vec![body]);
    for row in 0..held.contact.len() {
        let entries: Vec<_> = held.contact.matrix.row(row).map(|(dof, b)| (first + dof, b)).collect();
        deck.contact.push(&entries, held.contact.rhs[row]);
    }
    deck
}

/// A floating block pressed on a held one of half its modulus: across + 1 rows u_lower - u_upper <= travel + gap. One
/// equality row holds the slide of the upper block.
pub fn pressed(across: usize, rows: usize, travel: f64) -> Deck {
    let (lower, upper) =
        (block(across, rows, 0.0, 1.0), block(across, rows, rows as f64 / across as f64, 2.0));
    let (below, mut above) = (lower.part(|at| at[1] == 0), upper.floating());
    for at in upper.grids().filter(|at| at[1] == rows) {
        above.body.load[2 * upper.node(at) + 1] = -pressure(upper.position(at)[0], across);
    }
    let mut deck = Deck::new("pressed", vec![below.body, above.body]);
    let offset = deck.offset(1);
    for at in upper.grids().filter(|at| at[1] == 0) {
        let under = below.number[2 * lower.node([at[0], rows, 0]) + 1].unwrap();
        let over = offset + 2 * upper.node(at) + 1;
        deck.contact.push(&[(under, 1.0), (over, -1.0)], travel + gap(upper.position(at)[0]));
    }
    deck.equalities.push(&[(offset, 1.0)], 0.0);
    deck
}

/// The deck with stiffness and loads by these factors, and its gaps by load / stiffness.
pub fn scaled(mut deck: Deck, stiffness: f64, load: f64) -> Deck {
    for body in &mut deck.bodies {
        body.stiffness = body.stiffness.clone().scaled(stiffness);
        body.load.iter_mut().for_each(|f| *f *= load);
    }
    deck.contact.rhs.iter_mut().for_each(|c| *c *= load / stiffness);
    deck
}

/// The decks side by side: no row joins them.
pub fn side_by_side(decks: &[Deck]) -> Deck {
    let mut all = Deck::new("side_by_side", decks.iter().flat_map(|deck| deck.bodies.clone()).collect());
    let mut offset = 0;
    for deck in decks {
        for (from, to) in [(&deck.contact, &mut all.contact), (&deck.equalities, &mut all.equalities)] {
            for row in 0..from.len() {
                let entries: Vec<_> = from.matrix.row(row).map(|(dof, b)| (offset + dof, b)).collect();
                to.push(&entries, from.rhs[row]);
            }
        }
        offset += deck.dofs();
    }
    all
}
